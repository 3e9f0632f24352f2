//! A path of one file and packets of another: bags, captures, CSV, TUM, GPX and NMEA in any combination.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use sextant_channel::Position;
#[cfg(feature = "sqlite-bags")]
use sextant_kernel::{Purpose, Seed};
use sextant_logs::{self as robot_log, FormOptions, LocalPlane, ReadOptions, RobotLog, StopRule};

use super::drive::{assert_holds, kept, map, options, path_csv};
use super::program::{Said, folder};

/// Of the first time of the paths of the captures and of the bags (ns).
const CAPTURES_NS: u32 = 123_456_000;
const BAGS_NS: u32 = 123_456_789;

const CAPTURED: [&str; 3] = ["0x0001", "00:12:4b:00:01:02:03:04", "0x0003"];
const IN_BAG: [&str; 3] = ["17", "291", "4660"];

/// Reads `log` with a path or packets of other files.
fn read(log: &Path, path: Option<PathBuf>, packets: Option<PathBuf>) -> Result<RobotLog, String> {
    let options = ReadOptions { form: FormOptions { path, packets, ..FormOptions::default() }, ..options() };
    robot_log::read(log, &options).map_err(|error| error.to_string())
}

/// The packets of the drive as CSV, with the names of the bags.
fn packets_csv() -> String {
    let mut text = "t_s,node,rssi_dbm\n".to_owned();
    for (node, seconds) in [0..6, 1..5, 2..3].into_iter().enumerate() {
        for second in seconds {
            for quarter in ["373456789", "873456789"] {
                let level = -50 - 5 * i32::try_from(node).unwrap() - second;
                writeln!(text, "{}.{quarter},{},{level}", 1_700_000_000 + second, IN_BAG[node]).unwrap();
            }
        }
    }
    text
}

/// The path of the captures in another format: the time (s) and the place in metres of each pose.
fn poses() -> Vec<(String, f64)> {
    let csv = path_csv(CAPTURES_NS);
    let pose = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        (cells[0].to_owned(), cells[1].parse().unwrap())
    };
    csv.lines().skip(1).map(pose).collect()
}

#[test]
fn a_path_in_tum_belongs_to_a_capture() {
    let row = |(time, x_m): &(String, f64)| format!("{time} {x_m} 2.0 0 0 0 0 1\n");
    let text = format!("# time x y z qx qy qz qw\n{}", poses().iter().map(row).collect::<String>());
    let folder = folder(&[("walk.tum", &text), ("trajectory.txt", &text)]);
    for name in ["walk.tum", "trajectory.txt"] {
        let log = read(&kept("captures/tap.pcap"), Some(folder.path().join(name)), None).unwrap();
        assert_holds(&log, CAPTURED, [true; 3]);
    }
    // In one folder, and from the side of the path.
    let capture = kept("captures/tap.pcap");
    assert_holds(&read(&folder.path().join("walk.tum"), None, Some(capture.clone())).unwrap(), CAPTURED, [true; 3]);
    std::fs::copy(&capture, folder.path().join("sniff.pcap")).unwrap();
    assert_holds(&read(folder.path(), None, None).unwrap(), CAPTURED, [true; 3]);
    let problem = read(&capture, Some(folder.path().join("bad.tum")), None).unwrap_err();
    assert!(problem.starts_with("cannot read") && problem.contains("bad.tum"), "{problem}");
    std::fs::write(folder.path().join("bad.tum"), format!("{text}1700000027 3 2\n")).unwrap();
    let problem = read(&capture, Some(folder.path().join("bad.tum")), None).unwrap_err();
    assert!(problem.contains("bad.tum, line 15: found `1700000027 3 2`; allowed: time x y z"), "{problem}");
}

/// The drive east from a place on the earth: time, latitude, longitude, height.
fn fixes() -> Vec<(String, f64, f64, f64)> {
    let plane = LocalPlane::new(48.58, 7.75, 150.0);
    let fix = |(time, x_m): (String, f64)| {
        let place = plane.to_geodetic(Position::new(x_m, 0.0, 0.0));
        (time, place.lat_deg, place.lon_deg, place.height_m)
    };
    poses().into_iter().map(fix).collect()
}

/// Checks the places of the six stops of the drive in the plane around its first place, to so many metres.
fn assert_in_plane(log: &RobotLog, within_m: f64) {
    assert_eq!(log.log.names(), CAPTURED);
    assert_eq!(log.log.stops().len(), 6);
    assert!(log.plane.is_some());
    for (second, stop) in (0..).zip(log.log.stops()) {
        let expected = Position::new(0.5 * f64::from(second) + 0.25, 0.0, 0.0);
        assert!(stop.position.distance_m(expected) < within_m, "stop {second} is at {}", stop.position);
    }
}

#[test]
fn a_path_in_gpx_belongs_to_a_capture() {
    let point = |(time, lat, lon, ele): &(String, f64, f64, f64)| {
        let (second, fraction) = time.split_once('.').unwrap();
        let second = second.parse::<u32>().unwrap() - 1_700_000_000;
        let time = format!("2023-11-14T22:13:{}.{fraction}Z", 20 + second);
        format!("<trkpt lat=\"{lat}\" lon=\"{lon}\"><ele>{ele}</ele><time>{time}</time></trkpt>\n")
    };
    let points: String = fixes().iter().map(point).collect();
    let gpx = |points: &str| {
        format!(
            "<?xml version=\"1.0\"?>\n<gpx version=\"1.1\" xmlns=\"http://www.topografix.com/GPX/1/1\"><trk><trkseg>\n\
             {points}<trkpt lat=\"1\" lon=\"1\"/></trkseg></trk></gpx>\n"
        )
    };
    let folder = folder(&[("walk.gpx", &gpx(&points))]);
    let path = folder.path().join("walk.gpx");
    let log = read(&kept("captures/tap.pcap"), Some(path.clone()), None).unwrap();
    assert_in_plane(&log, 1e-6);
    assert_eq!(log.notes[0], "walk.gpx: 1 points without a time are skipped");
    // One bad point is skipped, and the note says what is wrong with it.
    for (from, to, expected) in [
        ("lat=\"48.5", "lat=\"north", "walk.gpx: 1 of 13 points are skipped; the first one, line 3: `lat` is `north"),
        ("22:13:20.1", "22:13:99.1", "the first one, line 3: `time` is `2023-11-14T22:13:99"),
    ] {
        std::fs::write(&path, gpx(&points.replacen(from, to, 1))).unwrap();
        let log = read(&kept("captures/tap.pcap"), Some(path.clone()), None).unwrap();
        assert!(log.notes.iter().any(|note| note.contains(expected)), "{:?}", log.notes);
    }
    for (from, to, expected) in
        [("lon=\"7.7", "lon=\"9.7", "line 4: found latitude 48.5"), ("<time>", "<date>", "opening and ending tag")]
    {
        std::fs::write(&path, gpx(&points.replacen(from, to, 1))).unwrap();
        let problem = read(&kept("captures/tap.pcap"), Some(path.clone()), None).unwrap_err();
        assert!(problem.contains(expected) || problem.contains("expected '"), "{problem}");
    }
    std::fs::write(&path, gpx("")).unwrap();
    let problem = read(&kept("captures/tap.pcap"), Some(path), None).unwrap_err();
    assert!(problem.contains("no point of its tracks has a time"), "{problem}");
}

/// A sentence of NMEA 0183 with its checksum.
fn sentence(body: &str) -> String {
    let checksum = body.bytes().fold(0, |sum, octet| sum ^ octet);
    format!("${body}*{checksum:02X}\r\n")
}

/// Degrees as `ddmm.mmmmmmmm`.
fn angle(degrees: f64, digits: usize) -> String {
    let whole = degrees.floor();
    format!("{whole:0digits$}{:011.8}", (degrees - whole) * 60.0)
}

#[test]
fn a_path_in_nmea_belongs_to_a_capture() {
    let mut text = sentence("GPGGA,221319.00,,,,,0,00,,,M,,M,,");
    for (time, lat, lon, height) in fixes() {
        let second = time[8..10].parse::<u32>().unwrap() + 20;
        let of_day = format!("2213{second:02}{}", &time[10..16]);
        let place = format!("{},N,{},E", angle(lat, 2), angle(lon, 3));
        text += &sentence(&format!("GNGGA,{of_day},{place},1,12,0.5,{height},M,47.0,M,,"));
        text += &sentence(&format!("GNRMC,{of_day},A,{place},1.0,90.0,141123,,,A"));
    }
    let folder = folder(&[("walk.nmea", &text)]);
    let path = folder.path().join("walk.nmea");
    let read = || read(&kept("captures/tap.pcap"), Some(path.clone()), None);
    let log = read().unwrap();
    assert_in_plane(&log, 2e-3);
    assert_eq!(log.notes[0], "walk.nmea: 1 sentences without a fix are skipped");
    // A damaged sentence is left out, and without heights the path is level.
    let damaged = text.replacen("GNRMC,221320", "GNRMC,221321", 1);
    std::fs::write(&path, damaged.replace("GNGGA", "GNGSA").replace("GPGGA", "GPGSA")).unwrap();
    let log = read().unwrap();
    assert!(log.notes[0].ends_with("sentences with a wrong checksum are skipped"), "{:?}", log.notes);
    let dateless: String =
        text.lines().filter(|line| !line.contains("RMC")).map(|line| format!("{line}\n")).collect();
    std::fs::write(&path, dateless).unwrap();
    assert!(read().unwrap_err().contains("no sentence has a date (RMC or ZDA)"));
}

#[test]
fn a_bag_gives_the_path_or_the_packets() {
    let folder = folder(&[("heard.csv", &packets_csv()), ("path.csv", &path_csv(BAGS_NS))]);
    let [heard, path] = ["heard.csv", "path.csv"].map(|name| folder.path().join(name));
    let log = read(&kept("bags/odometry"), None, Some(heard.clone())).unwrap();
    assert_holds(&log, IN_BAG, [true; 3]);
    assert_eq!(
        log.notes[0],
        "the path is that of `/odom` (nav_msgs/Odometry), the packets are those of heard.csv, the times of the bag are the \
         stamps of the messages"
    );
    let log = read(&kept("bags/odometry"), Some(path.clone()), None).unwrap();
    assert_holds(&log, IN_BAG, [true; 3]);
    assert!(
        log.notes[0].starts_with("the path is that of path.csv, the packets are those of `/radio`"),
        "{:?}",
        log.notes
    );
    // Two bags, and files alone.
    assert_holds(&read(&kept("bags/odometry"), Some(kept("bags/split")), None).unwrap(), IN_BAG, [true; 3]);
    assert_holds(&read(&heard, Some(path.clone()), None).unwrap(), IN_BAG, [true; 3]);
    assert_holds(&read(&path, None, Some(heard)).unwrap(), IN_BAG, [true; 3]);
}

#[test]
fn fixed_sniffers_are_mapped_from_the_path_of_a_transmitter() {
    let folder = folder(&[("path.csv", &path_csv(CAPTURES_NS))]);
    std::fs::copy(kept("captures/tap.pcap"), folder.path().join("roof.pcap")).unwrap();
    std::fs::copy(kept("captures/fcs.pcap"), folder.path().join("yard.pcap")).unwrap();
    let form = |transmitter: Option<&str>| FormOptions {
        reciprocal: true,
        transmitter: transmitter.map(str::to_owned),
        ..FormOptions::default()
    };
    let read = |form| robot_log::read(folder.path(), &ReadOptions { form, ..options() });
    let log = read(form(Some(CAPTURED[0]))).unwrap();
    assert_eq!(log.log.names(), ["roof", "yard"]);
    let received: Vec<u32> = log.log.receptions().iter().map(|at| at.received).collect();
    assert_eq!(received, [2; 12]);
    let problem = read(form(None)).unwrap_err().to_string();
    assert!(problem.contains("name the one that drove it with option `transmitter`"), "{problem}");
}

#[test]
fn what_is_there_twice_is_chosen_by_a_flag() {
    let folder = folder(&[]);
    std::fs::copy(kept("bags/odometry/odometry.mcap"), folder.path().join("walk.mcap")).unwrap();
    std::fs::copy(kept("captures/tap.pcap"), folder.path().join("sniff.pcap")).unwrap();
    let name = folder.path().file_name().unwrap().to_str().unwrap().to_owned();
    let problem = read(folder.path(), None, None).unwrap_err();
    let expected =
        format!("has the packets more than once: sniff.pcap, the bag `{name}`; choose with `packets=FILE`");
    assert!(problem.contains(&expected), "{problem}");
    let log = read(folder.path(), None, Some(folder.path().join("sniff.pcap"))).unwrap();
    assert_holds(&log, CAPTURED, [true; 3]);

    std::fs::remove_file(folder.path().join("sniff.pcap")).unwrap();
    std::fs::write(folder.path().join("path.csv"), path_csv(BAGS_NS)).unwrap();
    let problem = read(folder.path(), None, None).unwrap_err();
    let expected = format!("has the path more than once: path.csv, the bag `{name}`; choose with `path=FILE`");
    assert!(problem.contains(&expected), "{problem}");
    let log = read(folder.path(), Some(folder.path().join("path.csv")), None).unwrap();
    assert_holds(&log, IN_BAG, [true; 3]);

    std::fs::write(folder.path().join("stops.csv"), "stop,x_m,y_m\nA,0,0\n").unwrap();
    let problem = read(folder.path(), None, None).unwrap_err();
    assert!(problem.contains(&format!("has both the bag `{name}`, path.csv and stops.csv")), "{problem}");
    let capture = kept("captures/tap.pcap");
    let problem = read(&capture, None, Some(capture.clone())).unwrap_err();
    assert!(problem.ends_with("gives packets, but so does option `packets`: leave out one of them"), "{problem}");
    let problem = read(&kept("bags/odometry/odometry.mcap"), Some(capture.clone()), Some(capture)).unwrap_err();
    assert!(problem.ends_with("gives packets, but so does option `packets`: leave out one of them"), "{problem}");
    let tum = folder.path().join("walk.tum");
    std::fs::write(&tum, "0 0 0 0\n1 0 0 0\n").unwrap();
    let problem = read(&tum, Some(tum.clone()), Some(kept("captures/tap.pcap"))).unwrap_err();
    assert!(problem.ends_with("gives the path, but so does option `path`: leave out one of them"), "{problem}");
}

/// Changes how a log is read, by a flag of this name.
type Flag = (&'static str, fn(&mut ReadOptions));

#[test]
fn a_flag_for_another_form_of_log_is_an_error() {
    const FLAGS: [Flag; 12] = [
        ("stop_every", |options| options.stop_every = StopRule::Distance(1.0)),
        ("packet_interval", |options| options.packet_interval_s = Some(1.0)),
        ("path", |options| options.form.path = Some("path.csv".into())),
        ("pose_topic", |options| options.bag.pose_topic = Some("/odom".to_owned())),
        ("packet_topic", |options| options.bag.packet_topic = Some("/radio".to_owned())),
        ("bag_clock", |options| options.bag.bag_clock = Some(robot_log::BagClock::Log)),
        ("pan", |options| options.sniffer.pan = Some(1)),
        ("missing", |options| options.form.missing = vec!["100".parse().unwrap()]),
        ("node_columns", |options| options.form.node_columns = vec!["a*".parse().unwrap()]),
        ("transmitter", |options| options.form.transmitter = Some("tag".to_owned())),
        ("lora", |options| options.form.lora = true),
        ("packet_fields", |options| options.form.packet_fields = robot_log::FieldNames::parse_packets("node=a").ok()),
    ];
    let stops = folder(&[("stops.csv", "stop,x_m,y_m\nA,0,0\n"), ("receptions.csv", "node,stop,received\na,A,1\n")]);
    let wide = folder(&[("wide.csv", "x_m,y_m,a\n0,0,-50\n")]);
    let drive = folder(&[("path.csv", &path_csv(CAPTURES_NS))]);
    std::fs::copy(kept("captures/tap.pcap"), drive.path().join("sniff.pcap")).unwrap();
    for (log, form, allowed) in [
        (&stops, "a folder with stops", &["lora", "packet_fields"][..]),
        (&wide, "a table with a column a node", &["missing", "node_columns"]),
        (
            &drive,
            "a log with its path from a CSV file and its packets from the capture of a sniffer",
            &["stop_every", "packet_interval", "path", "pan", "transmitter"],
        ),
    ] {
        // A table beside a path has packets.
        let is_meant = |flag: &str| form != "a table with a column a node" || flag != "path";
        for (flag, give) in FLAGS.into_iter().filter(|(flag, _)| is_meant(flag)) {
            let mut options = ReadOptions::default();
            give(&mut options);
            let read = robot_log::read(log.path(), &options).map_err(|error| error.to_string());
            let refused = read.is_err_and(|problem| {
                problem.starts_with(&format!("option `{flag}` is for")) && problem.ends_with(&format!("is {form}"))
            });
            assert_eq!(refused, !allowed.contains(&flag), "{flag}, {form}");
        }
    }
    let stderr = map(&kept("bags/odometry"), &["--missing", "100"]).refusal();
    assert!(stderr.contains("`--missing` is for tables with a row a stop and a column a node, but"), "{stderr}");
}

#[cfg(feature = "sqlite-bags")]
#[test]
fn a_bag_in_sqlite_is_the_same_log() {
    for name in ["sqlite", "sqlite/sqlite.db3"] {
        let log = read(&kept("bags").join(name), None, None).unwrap();
        assert_holds(&log, IN_BAG, [true; 3]);
        let mcap = read(&kept("bags/odometry"), None, None).unwrap();
        assert_eq!(log.notes, mcap.notes);
    }
    // Before Iron such bags had no definitions: those of paths are known, those of packets are not.
    let humble = kept("bags/sqlite_humble");
    let folder = folder(&[("heard.csv", &packets_csv())]);
    assert_holds(&read(&humble, None, Some(folder.path().join("heard.csv"))).unwrap(), IN_BAG, [true; 3]);
    let mut options = options();
    options.bag.packet_topic = Some("/radio".to_owned());
    let problem = robot_log::read(&humble, &options).unwrap_err().to_string();
    assert!(
        problem
            .contains("topic `/radio`: the bag has no definition of its messages, as bags in SQLite of ROS 2 Humble"),
        "{problem}"
    );
}

#[cfg(feature = "sqlite-bags")]
#[test]
fn damaged_bags_in_sqlite_are_read_or_refused() {
    let whole = std::fs::read(kept("bags/sqlite/sqlite.db3")).unwrap();
    let folder = folder(&[]);
    let path = folder.path().join("a.db3");
    let (mut read_ones, mut refused) = (0, 0);
    for number in 0..200 {
        let bits = |what| Seed(number).bits(Purpose::new(1), [what, 0, 0]);
        let draw = |what, below: usize| usize::try_from(bits(what) % below as u64).unwrap();
        let mut octets = whole.clone();
        for change in 0..1 + draw(0, 12) as u64 {
            octets[draw(2 * change + 1, whole.len())] = bits(2 * change + 2).to_le_bytes()[0];
        }
        octets.truncate(whole.len() - draw(100, 4) / 3 * draw(101, whole.len()));
        std::fs::write(&path, octets).unwrap();
        match read(&path, None, None) {
            Ok(_) => read_ones += 1,
            Err(error) => {
                assert!(error.to_string().contains("a.db3"), "{error}");
                refused += 1;
            }
        }
    }
    assert!(read_ones > 20 && refused > 20, "{read_ones} read, {refused} refused");
}
