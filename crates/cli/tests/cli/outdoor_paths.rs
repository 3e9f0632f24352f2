//! Paths of satellite receivers and of other programs as they are found: prefixes of names, bad points, other sentences and units.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fmt::Write as _;

use sextant_logs::{self as robot_log, ReadOptions, RobotLog, StopRule};

use super::program::folder;

const PACKETS: &str = "t_s,node\n1700000001,lamp\n1700000006,lamp\n";

fn read(name: &str, path: &str) -> Result<RobotLog, String> {
    let options =
        ReadOptions { stop_every: StopRule::Distance(5.0), packet_interval_s: Some(1.0), ..ReadOptions::default() };
    let folder = folder(&[(name, path), ("packets.csv", PACKETS)]);
    // Named by the flag, so that its content tells what it is.
    let mut named = options;
    named.form.path = Some(folder.path().join(name));
    let read = robot_log::read(&folder.path().join("packets.csv"), &named);
    read.map_err(|error| error.to_string().replace(&format!("{}/", folder.path().display()), ""))
}

/// A track of so many seconds northwards, 0.00001 degrees a second, with the points that `change` makes of the usual ones.
fn gpx(prefix: &str, seconds: u32, change: impl Fn(u32, String) -> String) -> String {
    let mut points = String::new();
    for second in 0..seconds {
        let (lat, time) = (48.0 + f64::from(second) * 1e-5, 1_700_000_000 + second);
        let clock = format!("2023-11-14T22:{:02}:{:02}Z", 13 + (20 + second) / 60, (20 + second) % 60);
        assert!(time < 1_700_002_000);
        let point = format!(
            "<{prefix}trkpt lat=\"{lat:.5}\" lon=\"7.0\"><{prefix}time>{clock}</{prefix}time></{prefix}trkpt>"
        );
        writeln!(points, "{}", change(second, point)).unwrap();
    }
    let namespace =
        if prefix.is_empty() { "xmlns".to_owned() } else { format!("xmlns:{}", prefix.trim_end_matches(':')) };
    format!(
        "<?xml version=\"1.0\"?>\n<!-- made by hand -->\n<{prefix}gpx {namespace}=\"http://www.topografix.com/GPX/1/1\" version=\"1.1\">\
         <{prefix}trk><{prefix}trkseg>\n{points}</{prefix}trkseg></{prefix}trk></{prefix}gpx>\n"
    )
}

fn usual(_: u32, point: String) -> String {
    point
}

#[test]
fn names_of_gpx_may_have_a_prefix() {
    let plain = read("walk.gpx", &gpx("", 12, usual)).unwrap();
    assert_eq!(plain.log.stops().len(), 3);
    for name in ["walk.gpx", "walk.xml"] {
        assert_eq!(read(name, &gpx("ns:", 12, usual)).unwrap().log, plain.log, "{name}");
    }
}

#[test]
fn one_bad_point_of_a_track_is_skipped_and_named() {
    let whole = read("walk.gpx", &gpx("", 1000, usual)).unwrap();
    for (from, to, problem) in [
        ("2023-11-14T22:13:27Z", "1901-01-01T00:00:00Z", "`time` is `1901-01-01T00:00:00Z`"),
        ("2023-11-14T22:13:27Z", "yesterday", "`time` is `yesterday`"),
        ("48.00007", "98.00007", "found latitude 98.00007"),
        ("48.00007", "", "found latitude NaN"),
        ("48.00007", "0.00000", "a place at most 100 km from the first one"),
        ("48.00007", "north", "`lat` is `north`"),
    ] {
        let change = |second: u32, point: String| if second == 7 { point.replace(from, to) } else { point };
        let log = read("walk.gpx", &gpx("", 1000, change)).unwrap();
        let note = log
            .notes
            .iter()
            .find(|note| note.contains("1 of 1000 points are skipped; the first one, line 11: "))
            .unwrap();
        assert!(note.contains(problem), "{note}");
        assert_eq!(log.log.stops().len(), whole.log.stops().len(), "{to}");
    }
    // More than one in ten are no accident.
    let change = |second: u32, point: String| if second % 5 == 2 { point.replace("48.0", "98.0") } else { point };
    let problem = read("walk.gpx", &gpx("", 100, change)).unwrap_err();
    assert!(problem.starts_with("walk.gpx, line 6: found latitude 98"), "{problem}");
}

/// A sentence of NMEA 0183 with its checksum.
fn sentence(body: &str) -> String {
    let checksum = body.bytes().fold(0, |sum, octet| sum ^ octet);
    format!("${body}*{checksum:02X}\r\n")
}

#[test]
fn sentences_of_several_systems_of_satellites_are_places() {
    // Northwards by 0.0006 minutes, which is 0.00001 degrees, a second; the date is that of ZDA.
    let walk = |of_second: &dyn Fn(u32, String) -> String| {
        let mut text = sentence("GNZDA,221320.00,14,11,2023,00,00");
        for second in 0..12 {
            text += &of_second(second, format!("{:02}", 20 + second));
        }
        text
    };
    let minutes = |second: u32| format!("{:07.4}", f64::from(second) * 6e-4);
    let gga = |talker: &'static str| {
        move |second: u32, clock: String| {
            sentence(&format!(
                "{talker}GGA,2213{clock}.00,48{},N,00700.0000,E,1,08,0.9,150.0,M,46.9,M,,",
                minutes(second)
            ))
        }
    };
    let expected = read("walk.nmea", &walk(&gga("GP"))).unwrap().log;
    assert_eq!(expected.stops().len(), 3);
    for talker in ["GN", "GL", "GA", "BD", "GB"] {
        assert_eq!(read("walk.txt", &walk(&gga(talker))).unwrap().log, expected, "{talker}");
    }
    let gns = |second: u32, clock: String| {
        let body = |mode: &str, minutes: String| {
            sentence(&format!("GNGNS,2213{clock}.00,48{minutes},N,00700.0000,E,{mode},13,0.9,150.0,46.9,,"))
        };
        // One of two systems without a fix is enough; a sentence without any says nothing.
        body(if second == 3 { "AN" } else { "AA" }, minutes(second)) + &body("NN", minutes(9))
    };
    let log = read("walk.nmea", &walk(&gns)).unwrap();
    assert_eq!(log.log, expected);
    assert!(log.notes.contains(&"walk.nmea: 12 sentences without a fix are skipped".to_owned()), "{:?}", log.notes);
    let gll = |second: u32, clock: String| {
        sentence(&format!("GNGLL,48{},N,00700.0000,E,2213{clock}.00,A,A", minutes(second)))
    };
    assert_eq!(read("walk.nmea", &walk(&gll)).unwrap().log.stops().len(), 3);
    let satellites = sentence("GPGSV,1,1,00").repeat(5);
    let problem = read("walk.nmea", &satellites).unwrap_err();
    assert!(problem.contains("no sentence"), "{problem}");
}

#[test]
fn times_of_a_tum_path_may_be_nanoseconds() {
    let lines = |time: &dyn Fn(u32) -> String| {
        (0..12).map(|second| format!("{} {second} 0 0 0 0 0 1\n", time(1_700_000_000 + second))).collect::<String>()
    };
    let expected = read("walk.tum", &lines(&|second| format!("{second}.0"))).unwrap();
    assert_eq!(expected.log.stops().len(), 3);
    for (zeros, unit) in [("000000000", "nanoseconds"), ("000000", "microseconds"), ("000", "milliseconds")] {
        let log = read("walk.txt", &lines(&|second| format!("{second}{zeros}"))).unwrap();
        assert_eq!(log.log, expected.log, "{unit}");
        let note = format!("walk.txt: times are {unit} since 1970, by the number of their digits");
        assert!(log.notes.contains(&note), "{:?}", log.notes);
    }
    assert!(
        !expected.notes.iter().any(|note| note.contains("by the number of their digits")),
        "{:?}",
        expected.notes
    );
}
