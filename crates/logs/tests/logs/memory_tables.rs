//! Tables in memory mean the same as CSV files with the same cells, and are refused for the same reasons.

use proptest::prelude::*;
use sextant_logs::{
    FieldNames, FormOptions, MemoryColumn, MemoryLog, MemoryTable, PacketDelay, ReadOptions, RepairOptions, RobotLog,
    RobotLogError, read, read_tables, read_truth, read_truth_table,
};

/// A column of a test, which can be written to a file and taken from memory.
#[derive(Clone, Debug)]
enum Cells {
    Floats(Vec<f64>),
    Whole(Vec<Option<i64>>),
    Texts(Vec<Option<String>>),
    /// Nanoseconds since 1970, and the same as a date.
    Dates(Vec<(i64, &'static str)>),
}

type Columns = Vec<(&'static str, Cells)>;

fn floats(cells: &[f64]) -> Cells {
    Cells::Floats(cells.to_vec())
}

fn whole(cells: &[i64]) -> Cells {
    Cells::Whole(cells.iter().copied().map(Some).collect())
}

/// Texts with spaces between them; `-` is an empty cell.
fn texts(cells: &str) -> Cells {
    Cells::Texts(cells.split(' ').map(|cell| (cell != "-").then(|| cell.to_owned())).collect())
}

impl Cells {
    fn len(&self) -> usize {
        match self {
            Self::Floats(cells) => cells.len(),
            Self::Whole(cells) => cells.len(),
            Self::Texts(cells) => cells.len(),
            Self::Dates(cells) => cells.len(),
        }
    }

    fn text(&self, row: usize) -> String {
        match self {
            Self::Floats(cells) if cells[row].is_nan() => String::new(),
            Self::Floats(cells) => cells[row].to_string(),
            Self::Whole(cells) => cells[row].map_or_else(String::new, |cell| cell.to_string()),
            Self::Texts(cells) => cells[row].clone().unwrap_or_default(),
            Self::Dates(cells) => cells[row].1.to_owned(),
        }
    }

    fn column(&self) -> MemoryColumn<'_> {
        match self {
            Self::Floats(cells) => MemoryColumn::floats(cells.as_slice()),
            Self::Whole(cells) => MemoryColumn::Whole {
                // What an empty cell holds beside the mask has no meaning.
                values: cells.iter().map(|cell| cell.unwrap_or(-77)).collect::<Vec<_>>().into(),
                empty: cells.contains(&None).then(|| cells.iter().map(Option::is_none).collect()),
            },
            Self::Texts(cells) => MemoryColumn::texts(cells.iter().map(Option::as_deref)),
            Self::Dates(cells) => MemoryColumn::instants(cells.iter().map(|cell| cell.0).collect::<Vec<_>>()),
        }
    }
}

fn csv(columns: &Columns) -> String {
    let quoted = |text: String| format!("\"{text}\"");
    let line = |cells: Vec<String>| cells.into_iter().map(quoted).collect::<Vec<_>>().join(",") + "\n";
    let rows = columns.first().map_or(0, |(_, cells)| cells.len());
    let header = line(columns.iter().map(|(name, _)| (*name).to_owned()).collect());
    (0..rows).fold(header, |text, row| text + &line(columns.iter().map(|(_, cells)| cells.text(row)).collect()))
}

fn table<'a>(name: &str, columns: &'a Columns) -> MemoryTable<'a> {
    let columns = columns.iter().map(|(name, cells)| ((*name).to_owned(), cells.column())).collect();
    MemoryTable::new(name, columns).unwrap()
}

/// A log: its tables by name, and how it is read.
#[derive(Clone, Debug, Default)]
struct Case {
    tables: Vec<(&'static str, Columns)>,
    options: ReadOptions,
}

impl Case {
    fn new(tables: &[(&'static str, Columns)]) -> Self {
        Self { tables: tables.to_vec(), options: ReadOptions::default() }
    }

    fn of(&self, names: &[&str]) -> Option<MemoryTable<'_>> {
        self.tables.iter().find(|(name, _)| names.contains(name)).map(|(name, columns)| table(name, columns))
    }

    fn in_memory(&self) -> Result<RobotLog, RobotLogError> {
        let log = MemoryLog {
            contacts: self.of(&["contacts"]),
            sectors: self.of(&["sectors"]),
            sector_snrs: self.of(&["sector_snrs"]),
            ..MemoryLog::new(self.of(&["stops", "path"]).unwrap(), self.of(&["receptions", "packets"]).unwrap())
        };
        read_tables(&log, &self.options)
    }

    fn in_files(&self) -> Result<RobotLog, RobotLogError> {
        let folder = tempfile::tempdir().unwrap();
        for (name, columns) in &self.tables {
            std::fs::write(folder.path().join(format!("{name}.csv")), csv(columns)).unwrap();
        }
        read(folder.path(), &self.options)
    }

    /// Compares the log from files with that from memory, and returns it.
    fn check(&self) -> RobotLog {
        let (files, memory) = (self.in_files().unwrap(), self.in_memory().unwrap());
        assert_eq!(memory.log, files.log);
        assert_eq!(memory.plane, files.plane);
        assert_eq!(memory.findings, files.findings);
        assert_eq!(memory.clock, files.clock);
        let notes: Vec<String> = files.notes.iter().map(|note| note.replace(".csv", "")).collect();
        assert_eq!(memory.notes, notes);
        memory
    }

    fn refusal(&self) -> String {
        assert!(self.in_files().is_err(), "the files are refused too");
        self.in_memory().unwrap_err().to_string()
    }
}

const NAN: f64 = f64::NAN;

fn stops() -> Columns {
    vec![
        ("stop", texts("A B C D")),
        ("x_m", floats(&[0.0, 1.5, 0.1 + 0.2, -7.25])),
        ("y_m", floats(&[-0.0, 1e-3, 2.0, 4.0])),
    ]
}

fn receptions() -> Columns {
    vec![("node", texts("lamp door lamp lamp")), ("stop", texts("A B B A")), ("received", whole(&[1, 0, 3, 2]))]
}

#[test]
fn stops_and_receptions_with_every_column_mean_the_same() {
    let mut case = Case::new(&[
        (
            "stops",
            [
                stops(),
                vec![
                    ("t_s", floats(&[1_764_000_000.123_456_7, 1_764_000_001.0, 1_764_000_002.5, 1_764_000_009.75])),
                    ("z_m", whole(&[0, 1, 2, 0])),
                    ("robot", texts("r2 r1 r1 r2")),
                    ("heading_deg", floats(&[0.0, 90.0, -12.3, 359.0])),
                    ("sent", floats(&[10.0, NAN, 12.0, 8.0])),
                    ("comment", texts("a b - d")),
                ],
            ]
            .concat(),
        ),
        (
            "receptions",
            vec![
                ("node", texts("lamp door lamp =sum door")),
                ("stop", texts("A B B D A")),
                ("received", floats(&[3.0, 0.0, 1.0, 8.0, 5.0])),
                ("sent", Cells::Whole(vec![Some(10), None, Some(4), Some(8), None])),
                ("sector", floats(&[0.0, NAN, 3.0, 1.0, 0.0])),
                ("rssi_dbm", floats(&[-70.25, NAN, -81.0, -60.5, -66.125])),
                ("snr_db", floats(&[12.0, NAN, NAN, 3.5, -1.0])),
            ],
        ),
        (
            "contacts",
            vec![
                ("t_s", floats(&[1_764_000_003.0])),
                ("x_m", floats(&[0.5])),
                ("y_m", floats(&[0.5])),
                ("z_m", floats(&[0.0])),
                ("robot", texts("r3")),
            ],
        ),
        (
            "sectors",
            vec![
                ("sector", whole(&[0, 1, 3])),
                ("azimuth_from_deg", floats(&[0.0, 90.0, 180.0])),
                ("azimuth_to_deg", floats(&[90.0, 180.0, 360.0])),
            ],
        ),
        (
            "sector_snrs",
            vec![
                ("node", texts("lamp lamp")),
                ("stop", texts("A A")),
                ("sector", whole(&[0, 3])),
                ("snr_db", floats(&[12.5, 3.25])),
            ],
        ),
    ]);
    let log = case.check().log;
    assert_eq!(log.names(), ["lamp", "door", "=sum"]);
    assert_eq!(log.robots(), ["r2", "r1", "r3"]);
    assert!(log.sectors().is_some() && log.has_headings() && log.contacts().len() == 1);
    case.options.repair.rssi_missing = vec![-81.0];
    case.check();
    case.options.form.lora = true;
    case.check();
}

#[test]
fn receptions_in_other_forms_mean_the_same() {
    let nodes = || ("node", whole(&[4101, 7, 4101, 7, 4101, 9]));
    let at = || ("stop", floats(&[0.0, 1.0, 1.0, 2.0, 0.0, 2.0]));
    let stops = || {
        let places = stops().into_iter().skip(1);
        ("stops", places.chain([("stop", whole(&[0, 1, 2, 3]))]).collect::<Columns>())
    };
    let strengths = || ("rssi_dbm", floats(&[-70.0, -71.5, -80.0, NAN, -72.0, -90.25]));
    for receptions in [
        vec![nodes(), at(), strengths()],
        vec![nodes(), at(), ("received", whole(&[1, 2, 1, 0, 3, 1]))],
        vec![nodes(), at(), ("received", whole(&[1, 1, 1, 0, 1, 1])), strengths()],
        vec![
            nodes(),
            at(),
            ("received", whole(&[1, 1, 1, 0, 1, 1])),
            ("sent", floats(&[2.0, NAN, 3.0, 0.0, 1.0, 5.0])),
        ],
        vec![nodes(), at(), ("received", texts("1 2 1 0 3 1")), ("sent", texts("5 - 5 5 5 5"))],
        vec![
            nodes(),
            at(),
            ("received", whole(&[1, 2, 1, 0, 3, 1])),
            ("sector_snr_db", texts("0:1.5 3:2 - - 1:7 -")),
        ],
    ] {
        let mut case = Case::new(&[stops(), ("receptions", receptions)]);
        assert_eq!(case.check().log.names(), ["4101", "7", "9"]);
        if case.tables[1].1.iter().any(|(name, _)| *name == "rssi_dbm") {
            case.options.form.noise_floor = Some("-85".parse().unwrap());
            case.check();
        }
    }
}

#[test]
fn places_on_the_earth_and_rows_without_a_fix_mean_the_same() {
    let mut case = Case::new(&[
        (
            "stops",
            vec![
                ("stop", texts("A B C D E")),
                ("lat", floats(&[46.5, NAN, 0.0, 46.5003, 46.5012])),
                ("lon", floats(&[6.6, NAN, 0.0, 6.6001, 6.6])),
                ("alt_m", floats(&[400.0, NAN, 0.0, 401.5, 402.0])),
            ],
        ),
        ("receptions", receptions()),
    ]);
    case.options.repair.skip_no_fix = true;
    let read = case.check();
    assert!(read.plane.is_some() && read.log.stops().len() == 3);
    let note = "stops: 2 rows without a fix are left out, with 2 rows of receptions (option `skip_no_fix`)";
    assert!(read.notes.iter().any(|found| found == note), "{:?}", read.notes);
    let truth =
        vec![("node", texts("lamp door")), ("lat", floats(&[46.5, 46.5001])), ("lon", floats(&[6.6, 6.6002]))];
    let file = tempfile::tempdir().unwrap().path().with_extension("csv");
    std::fs::write(&file, csv(&truth)).unwrap();
    let (mut of_file, mut of_table) = (Vec::new(), Vec::new());
    let expected = read_truth(&file, None, read.plane.as_ref(), &mut of_file).unwrap();
    assert_eq!(read_truth_table(&table("truth", &truth), None, read.plane.as_ref(), &mut of_table), Ok(expected));
    std::fs::remove_file(file).unwrap();
    let metres = vec![("node", texts("lamp")), ("x_m", floats(&[1.0])), ("y_m", floats(&[1.0]))];
    let refused = read_truth_table(&table("truth", &metres), None, read.plane.as_ref(), &mut of_table).unwrap_err();
    assert!(refused.to_string().starts_with("truth: column `lat` is missing"), "{refused}");
}

#[test]
fn times_in_any_unit_mean_the_same() {
    let dates = Cells::Dates(vec![
        (1_732_406_400_000_000_000, "2024-11-24T00:00:00Z"),
        (1_732_406_400_250_000_000, "2024-11-24 00:00:00.25+00:00"),
        (1_732_406_401_000_000_001, "2024-11-24T00:00:01.000000001Z"),
        (1_732_492_799_000_000_000, "2024-11-24T23:59:59Z"),
    ]);
    let seconds = [0.1 + 0.2, 1e9, 1.7e9 + 1.0 / 3.0, 1.8e9];
    for (name, cells) in [
        ("t_s", dates),
        ("t_s", floats(&seconds)),
        ("t_s", floats(&[1e-7, 2.5e-10, 1e3, 18_446_744_072.0])),
        ("t_s", whole(&[0, 1, 1_700_000_000, 18_446_744_072])),
        ("t_ms", floats(&seconds.map(|time| 1e3 * time))),
        ("t_ms", whole(&[0, 1, 1_700_000_000_123, 1_700_000_000_124])),
        ("t_us", whole(&[0, 1, 1_700_000_000_123_456, 1_700_000_000_123_457])),
        ("t_ns", whole(&[0, 1, 1_700_000_000_123_456_789, i64::MAX])),
        ("t_s", texts("1764000000.123456789 1764000001 2026-11-22T15:04:05Z 1e10")),
    ] {
        let stops = [stops(), vec![(name, cells)]].concat();
        Case::new(&[("stops", stops), ("receptions", receptions())]).check();
    }
}

/// A path and packets of two nodes that are heard each second, 2.5 s late by the clock of the path.
fn drive() -> Case {
    let seconds = || (0..200).map(f64::from);
    let path = vec![
        ("t_s", Cells::Floats(seconds().map(|t_s| 1000.0 + t_s).collect())),
        ("x_m", Cells::Floats(seconds().map(|t_s| 20.0 * libm::sin(0.11 * t_s)).collect())),
        ("y_m", Cells::Floats(seconds().map(|t_s| 20.0 * libm::cos(0.23 * t_s)).collect())),
    ];
    let heard: Vec<(f64, usize)> =
        seconds().filter(|t_s| t_s % 7.0 > 0.5).flat_map(|t_s| [(t_s, 0), (t_s, 1)]).collect();
    let strength = |&(t_s, node): &(f64, usize)| {
        let (x_m, y_m) =
            (20.0 * libm::sin(0.11 * t_s) - [5.0, -9.0][node], 20.0 * libm::cos(0.23 * t_s) - [3.0, 4.0][node]);
        -40.0 - 12.0 * libm::log10(x_m * x_m + y_m * y_m + 1.0)
    };
    let packets = vec![
        (
            "t_ms",
            Cells::Floats(heard.iter().map(|(t_s, node)| 1e3 * (1002.5 + t_s) + 100.0 * *node as f64).collect()),
        ),
        ("node", Cells::Texts(heard.iter().map(|(_, node)| Some(["lamp", "door"][*node].to_owned())).collect())),
        ("rssi_dbm", Cells::Floats(heard.iter().map(strength).collect())),
    ];
    Case::new(&[("path", path), ("packets", packets)])
}

#[test]
fn a_path_and_packets_mean_the_same() {
    let mut case = drive();
    let known = case.check();
    assert!(!known.log.receptions().is_empty());
    case.options.repair.packet_delay = PacketDelay::Estimated;
    let read = case.check();
    assert!(read.clock.is_some() && read.notes.iter().any(|note| note.contains("`packet_delay=auto`")));
    let mut case = drive();
    case.options.stop_every = "5s".parse().unwrap();
    case.options.packet_interval_s = Some(1.0);
    case.tables
        .push(("contacts", vec![("t_s", floats(&[1003.0])), ("x_m", floats(&[2.0])), ("y_m", floats(&[1.0]))]));
    assert_eq!(case.check().log.contacts().len(), 1);
}

#[test]
fn robots_and_transmitters_mean_the_same() {
    let path = vec![
        ("t_s", whole(&[0, 0, 5, 5, 9, 9])),
        ("x_m", floats(&[0.0, 9.0, 5.0, 4.0, 9.0, 0.0])),
        ("y_m", floats(&[0.0, 1.0, 0.5, 2.0, 3.0, 1.0])),
        ("robot", whole(&[1, 2, 1, 2, 1, 2])),
    ];
    let packets = |mover: &'static str, node: &'static str| {
        vec![
            ("t_s", floats(&[0.5, 1.5, 4.0, 8.0])),
            (node, texts("lamp lamp door lamp")),
            (mover, floats(&[1.0, 2.0, 2.0, 1.0])),
            ("sector", whole(&[1, 2, 1, 1])),
        ]
    };
    let usual = Case::new(&[("path", path.clone()), ("packets", packets("robot", "node"))]);
    assert_eq!(usual.check().log.robots(), ["1", "2"]);
    let mut turned = Case::new(&[("path", path.clone()), ("packets", packets("node", "receiver"))]);
    turned.options.form.reciprocal = true;
    turned.check();
    let later = ("t_s", whole(&[0, 1, 5, 6, 9, 10]));
    let one =
        Case::new(&[("path", vec![later, path[1].clone(), path[2].clone()]), ("packets", packets("robot", "node"))]);
    let problem =
        "packets: column `robot` names the robots, but path has no such column: give it one, or remove this one";
    assert_eq!(one.refusal(), problem);
}

#[test]
fn names_of_the_user_for_columns_are_kept() {
    let mut case = Case::new(&[
        ("stops", vec![("scan", whole(&[1, 2])), ("east", floats(&[0.0, 1.0])), ("north", floats(&[0.0, 1.0]))]),
        ("receptions", vec![("src", texts("a b")), ("stop", whole(&[1, 2])), ("dbm", floats(&[-60.0, -70.0]))]),
    ]);
    case.options.form = FormOptions {
        path_fields: FieldNames::parse_places("stop=scan,x_m=east,y_m=north").ok(),
        packet_fields: FieldNames::parse_packets("node=src,rssi_dbm=dbm").ok(),
        ..FormOptions::default()
    };
    assert_eq!(case.check().log.names(), ["a", "b"]);
    case.tables[1].1[2] = ("dbm", floats(&[-60.0, f64::INFINITY]));
    assert_eq!(case.refusal(), "receptions, row 1, column `dbm`: found `inf`; allowed: a finite number");
    case.options.form.packet_fields = FieldNames::parse_packets("node=src,t_s=dbm").ok();
    assert!(
        case.refusal().starts_with("receptions: option `packet_fields` has `t_s=dbm`, but this table has no `t_s`")
    );
}

/// Replaces a column of the table `of`.
fn with(of: &'static str, name: &'static str, cells: Cells) -> Case {
    let mut case = Case::new(&[("stops", stops()), ("receptions", receptions())]);
    let columns = &mut case.tables.iter_mut().find(|(name, _)| *name == of).unwrap().1;
    columns.retain(|(other, _)| *other != name);
    columns.push((name, cells));
    case
}

#[test]
fn each_kind_of_bad_cell_names_table_row_column_and_what_is_allowed() {
    let most = u32::MAX - 1;
    let count = format!("a whole number from 0 to {most}");
    let metres = "a number of metres from -1e9 to 1e9";
    let time = "seconds as a decimal number, at least 0 and below 18446744073, or a time as 2026-11-22T15:04:05Z";
    let known = "one of the 4 stops in stops, from `A` to `D`";
    for (case, row, column, found, allowed) in [
        (
            with("stops", "x_m", floats(&[0.0, 1.0, 2.0, f64::INFINITY])),
            "stops, row 3",
            "x_m",
            "inf",
            "a finite number",
        ),
        (with("stops", "x_m", floats(&[0.0, NAN, 2.0, 3.0])), "stops, row 1", "x_m", "", metres),
        (with("stops", "y_m", floats(&[0.0, 2e9, 2.0, 3.0])), "stops, row 1", "y_m", "2000000000", metres),
        (with("stops", "y_m", texts("1 2 x 4")), "stops, row 2", "y_m", "x", "a finite number"),
        (
            with("stops", "stop", texts("A B C B")),
            "stops, row 3",
            "stop",
            "B",
            "each stop once; this stop is already given above",
        ),
        (
            with("stops", "stop", texts("A B - D")),
            "stops, row 2",
            "stop",
            "",
            "a number or a name that is not used above",
        ),
        (with("stops", "t_s", floats(&[0.0, -1.5, 2.0, 3.0])), "stops, row 1", "t_s", "-1.5", time),
        (with("stops", "t_s", whole(&[-1, 0, 2, 3])), "stops, row 0", "t_s", "-1", time),
        (with("stops", "robot", texts("a b c -")), "stops, row 3", "robot", "", "the name of a robot"),
        (with("stops", "sent", floats(&[1.0, 2.0, 3.5, 4.0])), "stops, row 2", "sent", "3.5", &count),
        (with("receptions", "received", whole(&[0, 1, -2, 3])), "receptions, row 2", "received", "-2", &count),
        (
            with("receptions", "received", floats(&[0.0, 1.0, NAN, 3.0])),
            "receptions, row 2",
            "received",
            "",
            "a whole number, 0 or above",
        ),
        (
            with("receptions", "sent", whole(&[9, 9, 2, 9])),
            "receptions, row 2",
            "received",
            "3",
            "at most 2, the packets sent",
        ),
        (
            with("receptions", "sector", whole(&[0, 256, 2, 9])),
            "receptions, row 1",
            "sector",
            "256",
            "a whole number from 0 to 255",
        ),
        (with("receptions", "stop", texts("A B X A")), "receptions, row 2", "stop", "X", known),
        (with("receptions", "stop", floats(&[0.0, 1.0, 7.0, 8.0])), "receptions, row 0", "stop", "0", known),
        (with("receptions", "node", texts("a - c d")), "receptions, row 1", "node", "", "the name of a node"),
        (
            with("receptions", "rssi_dbm", texts("-60 -70 loud -80")),
            "receptions, row 2",
            "rssi_dbm",
            "loud",
            "a finite number",
        ),
    ] {
        assert_eq!(case.refusal(), format!("{row}, column `{column}`: found `{found}`; allowed: {allowed}"));
        let why = case.in_memory().unwrap_err();
        let at = why.row_address().unwrap();
        assert_eq!(format!("{}, row {}", at.table().unwrap(), at.row().unwrap()), row);
        assert_eq!((at.file(), at.line()), (None, None));
        let why = case.in_files().unwrap_err();
        let at = why.row_address().unwrap();
        assert_eq!((at.table(), at.row(), at.line()), (None, None, why_line(row)), "{why}");
        assert!(at.file().unwrap().ends_with(format!("{}.csv", row.split(',').next().unwrap())));
    }
}

/// The line of a file that is this row of a table, below the header.
fn why_line(row: &str) -> Option<usize> {
    Some(row.rsplit(' ').next()?.parse::<usize>().ok()? + 2)
}

#[test]
fn instants_are_times_and_nothing_else() {
    let instants = || Cells::Dates(vec![(-1, "1969-12-31T23:59:59.999999999Z"); 4]);
    let refused = with("stops", "t_s", instants()).refusal();
    assert!(refused.starts_with("stops, row 0, column `t_s`: found `1969-12-31T23:59:59.999999999Z`"), "{refused}");
    let refused = with("stops", "x_m", instants()).refusal();
    assert!(refused.starts_with("stops, row 0, column `x_m`: found `1969-12-31T23:59:59.999999999Z`"), "{refused}");
    let refused = with("stops", "t_ms", instants()).refusal();
    assert!(refused.contains("milliseconds as a decimal number"), "{refused}");
}

#[test]
fn wrong_tables_are_refused_by_their_names() {
    let without = |of: &str, name: &str| {
        let mut case = Case::new(&[("stops", stops()), ("receptions", receptions())]);
        case.tables.iter_mut().find(|(name, _)| *name == of).unwrap().1.retain(|(other, _)| *other != name);
        case.refusal()
    };
    assert!(
        without("stops", "y_m").starts_with("stops: column `y_m` is missing; places need the columns x_m,y_m[,z_m]")
    );
    let refused = without("receptions", "node");
    assert!(refused.starts_with("receptions: column `node` is missing; the table must have the columns: node,stop"));
    let refused = without("receptions", "received");
    assert!(refused.starts_with("receptions: column `received` is missing; the table must have the columns: "));
    let misspelt = with("receptions", "snt", whole(&[9; 4])).refusal();
    assert!(misspelt.starts_with("receptions: unknown column `snt`; did you mean `sent`?"), "{misspelt}");
    let none = |cells: &Columns| cells.iter().map(|(name, _)| (*name, floats(&[]))).collect::<Columns>();
    let empty = Case::new(&[("stops", none(&stops())), ("receptions", none(&receptions()))]);
    assert_eq!(empty.refusal(), "`stops`: the log has no stops; at least one is required");
    let mut case = Case::new(&[("stops", stops()), ("receptions", receptions())]);
    case.options.packet_interval_s = Some(1.0);
    let problem =
        "option `packet_interval` is for logs of packets and a path, but `stops` is a table of stops in memory";
    assert_eq!(case.refusal(), problem);
    case.options = ReadOptions::default();
    case.options.form.packets = Some("packets.csv".into());
    assert!(case.in_memory().unwrap_err().to_string().starts_with("option `packets` names files"));
    let short = vec![
        ("stop".to_owned(), MemoryColumn::whole(vec![1, 2])),
        ("x_m".to_owned(), MemoryColumn::floats(vec![1.0])),
    ];
    let refused = MemoryTable::new("stops", short).unwrap_err();
    assert_eq!(refused.to_string(), "stops: column `x_m` has 1 cells, but `stop` has 2");
    let masked = MemoryColumn::Whole { values: vec![1, 2].into(), empty: Some(vec![true]) };
    let refused = MemoryTable::new("stops", vec![("stop".to_owned(), masked)]).unwrap_err();
    assert_eq!(refused.to_string(), "stops: column `stop` has 2 cells, but says of 1 whether they are empty");
    let codes = vec![0, MemoryColumn::NO_NAME, 2];
    let names = MemoryColumn::Names { codes: codes.into(), names: vec!["a".to_owned(), "b".to_owned()] };
    let refused = MemoryTable::new("stops", vec![("stop".to_owned(), names)]).unwrap_err();
    assert_eq!(
        refused.to_string(),
        "stops, row 2, column `stop`: found `place 2`; allowed: the place of one of 2 texts, from 0"
    );
}

#[test]
fn whole_numbers_of_any_size_are_names() {
    let large = [0, 1 << 20, (1 << 20) - 1, 1 << 40, i64::MAX, 0, 1 << 40];
    let stops =
        vec![("stop", whole(&large[..5])), ("x_m", floats(&[0.0, 1.0, 2.0, 3.0, 4.0])), ("y_m", floats(&[0.0; 5]))];
    let receptions = vec![
        ("node", Cells::Whole(large.iter().map(|&number| Some(number.wrapping_neg())).collect())),
        ("stop", whole(&large)),
        ("received", whole(&[1; 7])),
    ];
    let log = Case::new(&[("stops", stops), ("receptions", receptions)]).check().log;
    assert_eq!(log.names()[4], "-9223372036854775807");
}

/// Cells of small whole numbers in any of the kinds of columns that can hold them, some of them empty.
fn numbers(rows: usize, below: i64, has_gaps: bool) -> impl Strategy<Value = Cells> {
    let cell = (0..below, 0..5_u8).prop_map(move |(number, draw)| Some(number).filter(|_| !has_gaps || draw > 0));
    (proptest::collection::vec(cell, rows), 0..3_u8).prop_map(|(cells, kind)| match kind {
        0 => Cells::Whole(cells),
        1 => Cells::Floats(cells.into_iter().map(|cell| cell.map_or(NAN, |cell| cell as f64)).collect()),
        _ => Cells::Texts(cells.into_iter().map(|cell| cell.map(|cell| cell.to_string())).collect()),
    })
}

fn levels(rows: usize) -> impl Strategy<Value = Cells> {
    let level = prop_oneof![4 => -120.0..20.0_f64, 1 => Just(NAN), 1 => (-90..-30_i32).prop_map(f64::from)];
    proptest::collection::vec(level, rows).prop_map(Cells::Floats)
}

/// Stops and receptions with some of the columns that these may have.
fn any_log() -> impl Strategy<Value = Case> {
    (1..7_usize, 0..40_usize).prop_flat_map(|(stops, rows)| {
        let at = i64::try_from(stops).expect("a few");
        let stop_columns = (
            proptest::collection::vec(-100.0..100.0_f64, 2 * stops),
            proptest::option::of(numbers(stops, 30, true)),
            proptest::option::of(proptest::collection::vec(0.0..2e9_f64, stops)),
        );
        let columns = (
            numbers(rows, 5, false),
            numbers(rows, at, false),
            numbers(rows, 4, false),
            proptest::option::of(numbers(rows, 9, true)),
            proptest::option::of(numbers(rows, 256, true)),
            proptest::option::of(levels(rows)),
            proptest::option::of(levels(rows)),
        );
        (stop_columns, columns).prop_map(
            move |((places, sent_at, times), (node, stop, received, sent, sector, rssi, snr))| {
                let (x_m, y_m) = places.split_at(stops);
                let mut first =
                    vec![("stop", whole(&(0..at).collect::<Vec<_>>())), ("x_m", floats(x_m)), ("y_m", floats(y_m))];
                first.extend(sent_at.map(|cells| ("sent", cells)));
                first.extend(times.map(|cells| ("t_s", Cells::Floats(cells))));
                let mut heard = vec![("node", node), ("stop", stop), ("received", received)];
                heard.extend(sent.map(|cells| ("sent", cells)));
                heard.extend(sector.map(|cells| ("sector", cells)));
                heard.extend(rssi.map(|cells| ("rssi_dbm", cells)));
                heard.extend(snr.map(|cells| ("snr_db", cells)));
                Case::new(&[("stops", first), ("receptions", heard)])
            },
        )
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    #[test]
    fn any_tables_mean_the_same_as_files_or_are_refused_for_the_same_reason(mut case in any_log(), missing in any::<bool>()) {
        if missing {
            case.options.repair = RepairOptions { rssi_missing: vec![-60.0], ..RepairOptions::default() };
        }
        match case.in_memory() {
            Ok(_) => {
                case.check();
            }
            Err(memory) => {
                let reason = |why: &RobotLogError| {
                    let text = why.to_string();
                    text.split_once(": ").map_or(text.as_str(), |(_, reason)| reason).replace(".csv", "")
                };
                let files = case.in_files().expect_err("the files are refused too");
                prop_assert_eq!(reason(&memory), reason(&files));
                let line = files.row_address().and_then(|at| at.line());
                prop_assert_eq!(memory.row_address().and_then(|at| at.row()).map(|row| row + 2), line);
            }
        }
    }
}

#[test]
fn a_column_of_a_type_that_means_nothing_is_an_error_only_where_it_is_needed() {
    let stops = vec![
        ("stop".to_owned(), MemoryColumn::whole(vec![0])),
        ("x_m".to_owned(), MemoryColumn::floats(vec![0.0])),
        ("y_m".to_owned(), MemoryColumn::floats(vec![0.0])),
    ];
    let stops = MemoryTable::new("stops", stops).unwrap();
    let other = |empty: bool| MemoryColumn::Other { kind: "List(Int64)".to_owned(), empty: vec![empty] };
    let read_with = |name: &str, empty: bool| {
        let columns = [
            ("node", MemoryColumn::texts([Some("lamp")])),
            ("stop", MemoryColumn::whole(vec![0])),
            ("received", MemoryColumn::whole(vec![1])),
        ];
        let mut columns: Vec<_> = columns.into_iter().map(|(name, column)| (name.to_owned(), column)).collect();
        match columns.iter_mut().find(|(known, _)| known == name) {
            Some((_, column)) => *column = other(empty),
            None => columns.push((name.to_owned(), other(empty))),
        }
        let heard = MemoryTable::new("receptions", columns).unwrap();
        read_tables(&MemoryLog::new(stops.clone(), heard), &ReadOptions::default())
    };
    for needed in ["node", "stop", "received", "rssi_dbm", "sector"] {
        let Err(RobotLogError::Cell { column, found, .. }) = read_with(needed, false) else { panic!("{needed}") };
        assert_eq!((column.as_str(), found.as_str()), (needed, "List(Int64)"));
    }
    assert_eq!(read_with("remark", false).unwrap().log.node_count(), 1);
    assert_eq!(read_with("rssi_dbm", true).unwrap().log.receptions().get(0).unwrap().rssi_dbm, None);
    assert!(read_with("node", true).is_err());
}
