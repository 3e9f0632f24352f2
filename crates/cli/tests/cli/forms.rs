//! The forms of logs that people have: tables with a column a node, turned roles, receivers that always report a power, LoRa,
//! and columns with other names.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::collections::BTreeMap;
use std::path::Path;

use sextant_channel::Position;
use sextant_kernel::NodeId;
use sextant_logs::{self as robot_log, FieldNames, FormOptions, Names, ReadOptions, RobotLog, StopRule};

use super::drive::map;
use super::program::{Said, folder};

/// Reads a folder with these files; stops are 5 m long, and nodes send every second.
pub(super) fn read(files: &[(&str, &str)], form: FormOptions) -> Result<RobotLog, String> {
    let is_drive = files.iter().any(|(name, _)| *name == "packets.csv");
    let options = ReadOptions {
        stop_every: if is_drive { StopRule::Distance(5.0) } else { StopRule::Automatic },
        packet_interval_s: is_drive.then_some(1.0),
        form,
        ..ReadOptions::default()
    };
    let folder = folder(files);
    let read = robot_log::read(folder.path(), &options);
    read.map_err(|error| error.to_string().replace(&format!("{}/", folder.path().display()), ""))
}

/// Stop, packets received and sent, and strength of each reception of a node.
pub(super) type Row = (u32, u32, u32, Option<f64>);

pub(super) fn rows(log: &RobotLog, node: u32) -> Vec<Row> {
    log.log.of(NodeId(node)).iter().map(|at| (at.stop, at.received, at.sent, at.rssi_dbm)).collect()
}

fn missing(values: &[&str]) -> FormOptions {
    FormOptions { missing: values.iter().map(|value| value.parse().unwrap()).collect(), ..FormOptions::default() }
}

fn floor(text: &str) -> FormOptions {
    FormOptions { noise_floor: Some(text.parse().unwrap()), ..FormOptions::default() }
}

const WIDE: &str = "x_m,y_m,a,b,c\n0,0,-50,100,-70\n0,0,-52,100,100\n4,0,100,-60,\n";

#[test]
fn rows_of_a_wide_table_at_one_place_are_scans_of_a_stop() {
    let log = read(&[("wide.csv", WIDE), ("nodes.csv", "node,x_m,y_m\na,0,0\n")], missing(&["100"])).unwrap();
    assert_eq!(log.log.names(), ["a", "b", "c"]);
    let places: Vec<_> = log.log.stops().iter().map(|stop| stop.position).collect();
    assert_eq!(places, [Position::ORIGIN, Position::new(4.0, 0.0, 0.0)]);
    // 0 of 1 is an absent pair; the empty cell is no evidence.
    assert_eq!(rows(&log, 0), [(0, 2, 2, Some(-51.0))]);
    assert_eq!(rows(&log, 1), [(0, 0, 2, None), (1, 1, 1, Some(-60.0))]);
    assert_eq!(rows(&log, 2), [(0, 1, 2, Some(-70.0)), (1, 0, 0, None)]);
    assert_eq!(
        log.notes,
        [
            "wide.csv: 3 columns with the strengths of nodes: `a`, `b`, `c` (option `node_columns` chooses them)",
            "wide.csv: 3 rows are scans at 2 places; those at one place are one stop",
            "wide.csv: 4 of 9 cells say that a node was not heard, and 1 empty ones say nothing (option `missing` sets what they \
             hold)",
            "no times (t_s) in wide.csv: the duration of the survey is unknown"
        ]
    );
}

#[test]
fn empty_cells_are_silence_unless_another_value_is() {
    let log = read(&[("wide.csv", "x_m;y_m;a;b\n0,5;0;-50,5;\n2;0;NaN;-60\n")], FormOptions::default()).unwrap();
    assert_eq!(log.log.stops()[0].position, Position::new(0.5, 0.0, 0.0));
    assert_eq!((rows(&log, 0), rows(&log, 1)), (vec![(0, 1, 1, Some(-50.5))], vec![(1, 1, 1, Some(-60.0))]));
    let text = "x_m,y_m,a\n0,0,-50\n0,0,\n0,0,-200\n0,0,-300.0\n";
    let log = read(&[("wide.csv", text)], missing(&["-200", "-300", "empty"])).unwrap();
    assert_eq!(rows(&log, 0), [(0, 1, 4, Some(-50.0))]);
}

#[test]
fn columns_of_a_wide_table_have_the_names_of_its_program() {
    let form = FormOptions {
        path_fields: Some(FieldNames::parse_places("lat=LATITUDE,lon=LONGITUDE,t_ms=TIMESTAMP").unwrap()),
        node_columns: vec!["WAP*".parse().unwrap()],
        ..missing(&["100"])
    };
    let text = "LONGITUDE,LATITUDE,FLOOR,TIMESTAMP,WAP1,WAP2\n7.75,48.58,2,1700000000500,-60,100\n";
    let log = read(&[("train.csv", text)], form.clone()).unwrap();
    assert_eq!(log.log.names(), ["WAP1", "WAP2"]);
    assert!(log.plane.is_some() && log.notes.contains(&"train.csv: ignored columns: `FLOOR`".to_owned()), "{log:?}");
    assert_eq!(log.log.stops()[0].time.as_nanos(), 1_700_000_000_500_000_000);
    // A column that a flag names is none that is misspelt.
    let near = FormOptions { node_columns: vec!["x".parse().unwrap()], ..FormOptions::default() };
    let log = read(&[("wide.csv", "x_m,y_m,x,z\n0,0,-50,-60\n")], near).unwrap();
    assert_eq!(log.log.names(), ["x"]);
    let form = FormOptions { node_columns: vec!["AP*".parse().unwrap()], ..form };
    let problem = read(&[("train.csv", text)], form).unwrap_err();
    assert!(
        problem.contains("option `node_columns` has `AP*`, but there is no such column; the columns are: FLOOR"),
        "{problem}"
    );
}

#[test]
fn a_table_that_is_no_wide_one_is_an_error_that_says_what_to_do() {
    for (files, expected) in [
        (
            &[("wide.csv", "x_m,y_m,a\n0,0,100\n")][..],
            "wide.csv, line 2, column `a`: found `100`; allowed: a strength from -200 to 30 dBm; if it means that the node was \
             not heard, give `missing=100`; if the column is no node, name those that are with option `node_columns`",
        ),
        (
            &[("wide.csv", "x,y,a\n0,0,-50\n")],
            "unknown column `x`; did you mean `x_m`? Otherwise rename or remove it, or give `path_fields=x_m=x`",
        ),
        (
            &[("wide.csv", "x_m,y_m,Time,a\n0,0,1,-50\n")],
            "unknown column `Time`; did you mean `t_s`? Otherwise rename or remove it, or give `path_fields=t_s=Time`, or name \
             the columns of nodes with option `node_columns`",
        ),
        (&[("wide.csv", "x_m,y_m\n0,0\n")], "no column is a node"),
        (&[("wide.csv", "x_m,y_m,a,a\n0,0,1,1\n")], "column `a` appears twice"),
        (&[("wide.csv", "x_m,y_m,a\n")], "the log has no stops"),
        (
            &[("one.csv", WIDE), ("two.csv", WIDE)],
            "has several tables: one.csv, two.csv; give the one that is the log",
        ),
    ] {
        let problem = read(files, FormOptions::default()).unwrap_err();
        assert!(problem.contains(expected), "{problem}");
    }
}

const PATH: &str = "t_s,x_m,y_m\n0,0,0\n5,5,0\n10,10,0\n";

fn turned() -> FormOptions {
    FormOptions { reciprocal: true, ..FormOptions::default() }
}

#[test]
fn receivers_are_mapped_from_the_path_of_a_transmitter() {
    let packets = "t_s,receiver,node,rssi_dbm\n1.5,north,tag,-70\n2.5,south,tag,-80\n6.5,south,tag,-60\n";
    let log = read(&[("path.csv", PATH), ("packets.csv", packets)], turned()).unwrap();
    assert_eq!(log.log.names(), ["north", "south"]);
    assert_eq!(rows(&log, 1), [(0, 1, 5, Some(-80.0)), (1, 1, 5, Some(-60.0))]);
    assert!(
        log.notes[0].starts_with("roles are turned (option `reciprocal`): the nodes of the map are the receivers")
    );

    let others = format!("{packets}7,south,car,-10\n");
    let problem = read(&[("path.csv", PATH), ("packets.csv", &others)], turned()).unwrap_err();
    assert!(
        problem.contains("packets.csv, line 5: packets of the transmitters `tag` and `car`, but there is one path"),
        "{problem}"
    );
    let tag = |name: &str| FormOptions { transmitter: Some(name.to_owned()), ..turned() };
    let log = read(&[("path.csv", PATH), ("packets.csv", &others)], tag("tag")).unwrap();
    assert_eq!(rows(&log, 1)[1], (1, 1, 5, Some(-60.0)));
    assert!(
        log.notes.contains(&"1 packets of other transmitters than `tag` are not used".to_owned()),
        "{:?}",
        log.notes
    );
    let problem = read(&[("path.csv", PATH), ("packets.csv", &others)], tag("bus")).unwrap_err();
    assert_eq!(problem, "option `transmitter` is `bus`, but all 4 packets are of others");

    // Two transmitters with a path each.
    let path = "t_s,x_m,y_m,robot\n0,0,0,tag\n4,4,0,tag\n0,50,0,car\n4,54,0,car\n";
    let log =
        read(&[("path.csv", path), ("packets.csv", "t_s,receiver,node\n1,a,car\n2,a,tag\n")], turned()).unwrap();
    assert_eq!(rows(&log, 0).iter().map(|row| row.1).collect::<Vec<_>>(), [1, 1]);
    assert_eq!(log.log.robots(), ["tag", "car"]);
}

#[test]
fn receivers_are_mapped_from_the_stops_of_a_transmitter() {
    let stops = "stop,x_m,y_m\np,0,0\nq,5,0\n";
    for receptions in [
        "receiver,stop,received,sent\ngateway,p,5,10\ngateway,q,2,10\n",
        "node,stop,received,sent\np,gateway,5,10\nq,gateway,2,10\n",
    ] {
        let log = read(&[("stops.csv", stops), ("receptions.csv", receptions)], turned()).unwrap();
        assert_eq!(log.log.names(), ["gateway"]);
        assert_eq!(rows(&log, 0), [(0, 5, 10, None), (1, 2, 10, None)]);
    }
    let problem = read(&[("stops.csv", stops), ("receptions.csv", "stop,received\np,5\n")], turned()).unwrap_err();
    assert!(problem.contains("column `receiver` is missing"), "{problem}");
    let log = read(&[("wide.csv", "x_m,y_m,gateway\n0,0,-50\n")], turned()).unwrap();
    assert!(log.notes[0].contains("A channel is reciprocal"), "{:?}", log.notes);
}

#[test]
fn powers_of_noise_are_packets_that_were_not_heard() {
    let packet = |second: u32| format!("{second}.5,lamp,{}\n", if second < 5 { -70 } else { -98 });
    let packets = format!("t_s,node,rssi_dbm\n{}", (0..10).map(packet).collect::<String>());
    let log = read(&[("path.csv", PATH), ("packets.csv", &packets)], floor("-100+3")).unwrap();
    assert_eq!(rows(&log, 0), [(0, 5, 5, Some(-70.0)), (1, 0, 5, None)]);
    let note = "5 of 10 signal strengths are at or below -97 dBm (option `noise_floor`) and count as not heard";
    assert!(log.notes.iter().any(|found| found == note), "{:?}", log.notes);

    let stops = ("stops.csv", "stop,x_m,y_m\nA,0,0\nB,5,0\n");
    let reports = "node,stop,rssi_dbm\nlamp,A,-60\nlamp,A,-99\ndoor,A,-98\ndoor,A,-70\nlamp,B,-99\nlamp,B,-99\n";
    let log = read(&[stops, ("receptions.csv", reports)], floor("-95")).unwrap();
    assert_eq!(rows(&log, 0), [(0, 1, 2, Some(-60.0)), (1, 0, 2, None)]);
    assert_eq!(rows(&log, 1), [(0, 1, 2, Some(-70.0)), (1, 0, 2, None)]);
    let counted = "node,stop,received,sent,rssi_dbm\nlamp,A,8,9,-96\nlamp,B,7,9,-80\n";
    let log = read(&[stops, ("receptions.csv", counted)], floor("-95")).unwrap();
    assert_eq!(rows(&log, 0), [(0, 0, 9, None), (1, 7, 9, Some(-80.0))]);
    let log = read(&[("wide.csv", "x_m,y_m,a\n0,0,-96\n1,0,-90\n")], floor("-95")).unwrap();
    assert_eq!(rows(&log, 0), [(1, 1, 1, Some(-90.0))]);
    let problem = read(&[stops, ("receptions.csv", "node,stop,received\nlamp,A,1\n")], floor("-95")).unwrap_err();
    assert_eq!(problem, "option `noise_floor` is for signal strengths, but the log has none");
}

#[test]
fn the_strength_of_lora_is_that_of_its_signal() {
    let lora = || FormOptions { lora: true, ..FormOptions::default() };
    let packets = "t_s,node,rssi_dbm,snr_db\n1,lamp,-110,0\n2,lamp,-110,\n";
    let log = read(&[("path.csv", PATH), ("packets.csv", packets)], lora()).unwrap();
    let level = rows(&log, 0)[0].3.unwrap();
    assert!((level + 113.0103).abs() < 1e-4, "{level}");
    assert!(log.notes.iter().any(|note| note.contains("; 1 without SNR are not used")), "{:?}", log.notes);
    let stops = ("stops.csv", "stop,x_m,y_m\nA,0,0\n");
    let receptions = "node,stop,rssi_dbm,snr_db\nlamp,A,-100,-20\n";
    let log = read(&[stops, ("receptions.csv", receptions)], lora()).unwrap();
    let level = rows(&log, 0)[0].3.unwrap();
    assert!((level + 120.0432).abs() < 1e-4, "{level}");
    let problem = read(&[stops, ("receptions.csv", "node,stop,rssi_dbm\nlamp,A,-100\n")], lora()).unwrap_err();
    assert!(problem.contains("nothing in the log has both"), "{problem}");
}

#[test]
fn columns_and_units_are_named_by_flags() {
    let form = FormOptions {
        packet_fields: Some(FieldNames::parse_packets("t_us=time,node=src,rssi_dbm=level [dBm]").unwrap()),
        path_fields: Some(FieldNames::parse_places("x_m=px,y_m=py").unwrap()),
        ..FormOptions::default()
    };
    // RFC 3339 in UTC, and with an offset.
    let path = "t_s,px,py\n2023-11-14T22:13:20Z,0,0\n2023-11-14T23:13:30+01:00,10,0\n";
    let packets = "time,src,level [dBm],node\n1700000001500000,lamp,-70,x\n1700000006500000,lamp,-80,y\n";
    let log = read(&[("path.csv", path), ("packets.csv", packets)], form.clone()).unwrap();
    assert_eq!(
        (log.log.names(), rows(&log, 0)),
        (["lamp".to_owned()].as_slice(), vec![(0, 1, 5, Some(-70.0)), (1, 1, 5, Some(-80.0))])
    );
    assert!(log.notes.contains(&"packets.csv: ignored columns: `node`".to_owned()), "{:?}", log.notes);
    let problem = read(&[("path.csv", PATH), ("packets.csv", packets)], form.clone()).unwrap_err();
    assert!(
        problem.contains(
            "option `path_fields` has `x_m=px`, but there is no column `px`; the columns are: t_s, x_m, y_m"
        ),
        "{problem}"
    );
    let soon = packets.replace("1700000006500000", "soon");
    let problem = read(&[("path.csv", path), ("packets.csv", &soon)], form).unwrap_err();
    assert!(problem.contains("packets.csv, line 3, column `time`: found `soon`; allowed: microseconds"), "{problem}");
}

#[test]
fn a_node_has_one_name_in_all_files() {
    let at = |name: &str| (name.to_owned(), Position::ORIGIN);
    let files =
        [("stops.csv", "stop,x_m,y_m\nA,0,0\n"), ("receptions.csv", "node,stop,received\n4101,A,1\nlamp,A,1\n")];
    let named = |names: &str, truth: &[&str]| {
        let folder = folder(&[("names.csv", names)]);
        let log = read(&files, FormOptions::default()).unwrap().log;
        let truth: BTreeMap<_, _> = truth.iter().map(|name| at(name)).collect();
        let names = Names::read(&folder.path().join("names.csv"), &mut Vec::new());
        let applied = names.and_then(|names| names.apply(log, Some(truth)));
        applied.map_err(|error| error.to_string())
    };
    let (log, truth) = named("name,alias\n0x1005,4101\nbig lamp,lamp\nbig lamp,L\n", &["0x1005", "L"]).unwrap();
    assert_eq!(log.names(), ["0x1005", "big lamp"]);
    assert_eq!(truth.unwrap().into_keys().collect::<Vec<_>>(), ["0x1005", "big lamp"]);
    for (names, expected) in [
        (
            "name,alias\na,4101\nb,4101\n",
            "line 3, column `alias`: found `4101`; allowed: each alias once; this one is already that of `a`",
        ),
        ("name,alias\na,4101\nb,a\n", "`a` is both a name and an alias of `b`"),
        ("name,alias\na,4102\n", "no node of the log or of the true positions is called 4102"),
        ("name,alias\na,4101\na,lamp\n", "the nodes `4101` and `lamp` of the log are both `a`"),
        ("name,alias\n0x1005,L\n", "the nodes `0x1005` and `L` of the file of true positions are both `0x1005`"),
    ] {
        let problem = named(names, &["0x1005", "L"]).unwrap_err();
        assert!(problem.contains(expected), "{problem}");
    }
}

#[test]
fn the_program_maps_a_wide_table_by_other_names() {
    let table = "x_m,y_m,4101\n0,0,-60\n3,0,-50\n6,0,-58\n0,3,100\n3,3,-55\n6,3,100\n";
    let folder = folder(&[
        ("wide.csv", table),
        ("names.csv", "name,alias\n0x1005,4101\n"),
        ("truth.csv", "node,x_m,y_m\n0x1005,3,1\n"),
    ]);
    let file = |name: &str| folder.path().join(name).display().to_string();
    let (truth, names, out) = (file("truth.csv"), file("names.csv"), file("map.csv"));
    let words =
        ["--missing", "100", "--truth", &truth, "--names", &names, "--out", &out, "--algorithm", "packet-centroid"];
    map(Path::new(&file("wide.csv")), &words).printed();
    let written = std::fs::read_to_string(&out).unwrap();
    assert!(written.lines().nth(1).unwrap().starts_with("0x1005,3,"), "{written}");
    let stderr = map(Path::new(&file("wide.csv")), &["--missing", "100", "--pan", "0xabcd"]).refusal();
    assert!(stderr.contains("`--pan` is for captures of sniffers, but"), "{stderr}");
}

#[test]
fn more_packets_of_a_node_at_a_stop_than_can_be_counted_are_refused() {
    let folder = folder(&[
        ("path.csv", "t_s,x_m,y_m\n0,0,0\n5000,2,0\n"),
        ("packets.csv", "t_s,node,rssi_dbm\n1,a,-50\n4999,a,-50\n"),
    ]);
    let read = |interval_s| {
        let options = ReadOptions {
            stop_every: StopRule::Distance(5.0),
            packet_interval_s: Some(interval_s),
            ..ReadOptions::default()
        };
        robot_log::read(folder.path(), &options)
    };
    let sent = |log: &RobotLog| rows(log, 0).iter().map(|&(_, _, sent, _)| sent).collect::<Vec<_>>();
    // At 0 s and at 5000 s too.
    assert_eq!(sent(&read(1.0).unwrap()), [5001]);
    let problem = read(1e-6).unwrap_err().to_string();
    assert!(
        problem.starts_with(
            "node `a` would have sent 5000000001 packets at stop 0 (5000 s), one every 0.000001 s; allowed: up to 4294967294"
        ),
        "{problem}"
    );
}
