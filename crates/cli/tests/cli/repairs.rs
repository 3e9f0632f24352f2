//! Corrections of logs (option `packet_delay`, option `skip_no_fix`, option `rssi_missing`) in all forms of logs.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fmt::Write;

use sextant_logs::{self as robot_log, FormOptions, PacketDelay, ReadOptions, RepairOptions, RobotLog, StopRule};

use super::program::folder;

/// Reads a folder with these files; stops of a path are 5 s long.
fn read(files: &[(&str, &str)], form: FormOptions, repair: RepairOptions) -> Result<RobotLog, String> {
    let is_drive = files.iter().any(|(name, _)| name.starts_with("path"));
    let options = ReadOptions {
        stop_every: if is_drive { StopRule::Time(std::time::Duration::from_secs(5)) } else { StopRule::Automatic },
        packet_interval_s: is_drive.then_some(1.0),
        form,
        repair,
        ..ReadOptions::default()
    };
    let folder = folder(files);
    robot_log::read(folder.path(), &options).map_err(|why| why.to_string())
}

fn skipping() -> RepairOptions {
    RepairOptions { skip_no_fix: true, ..RepairOptions::default() }
}

fn missing(value_dbm: f64) -> RepairOptions {
    RepairOptions { rssi_missing: vec![value_dbm], ..RepairOptions::default() }
}

/// The times, far from 1970, and places (degrees) of a drive; `lost` are the seconds without a fix.
fn fixes(lost: &[u32]) -> Vec<(u32, f64, f64)> {
    let fix = |second: u32| {
        let place = (50.0 + 1e-5 * f64::from(second), 8.0);
        let (lat, lon) = if lost.contains(&second) { (0.0, 0.0) } else { place };
        (second, lat, lon)
    };
    (0..11).map(fix).collect()
}

fn gpx(lost: &[u32]) -> String {
    let mut points = String::new();
    for (second, lat, lon) in fixes(lost) {
        let time = format!("2023-11-14T22:13:{:02}Z", 20 + second);
        writeln!(points, "<trkpt lat=\"{lat}\" lon=\"{lon}\"><time>{time}</time></trkpt>").unwrap();
    }
    format!("<gpx version=\"1.1\"><trk><trkseg>\n{points}</trkseg></trk></gpx>\n")
}

fn nmea(lost: &[u32]) -> String {
    let mut sentences = String::new();
    for (second, lat, lon) in fixes(lost) {
        let time = format!("2213{:02}", 20 + second);
        let minutes = |angle: f64| format!("{:02.0}{:09.6}", angle.trunc(), 60.0 * angle.fract());
        writeln!(sentences, "$GPRMC,{time},A,{},N,0{},E,0,0,141123,,", minutes(lat), minutes(lon)).unwrap();
    }
    sentences
}

const PACKETS: &str = "t_s,node\n1700000001,lamp\n1700000006,lamp\n";

#[test]
fn fixes_at_zero_are_left_out_of_satellite_paths() {
    let lost = [3, 7];
    for (name, write) in [("path.gpx", gpx as fn(&[u32]) -> String), ("path.nmea", nmea)] {
        let files = |lost: &[u32]| [(name, write(lost)), ("packets.csv", PACKETS.to_owned())];
        let of = |lost: &[u32], repair: RepairOptions| {
            let files = files(lost);
            let files: Vec<(&str, &str)> = files.iter().map(|(name, text)| (*name, text.as_str())).collect();
            read(&files, FormOptions::default(), repair)
        };
        let refused = of(&lost, RepairOptions::default()).unwrap_err();
        assert!(
            refused.contains("line ") && refused.contains("option `skip_no_fix` leaves such places out"),
            "{refused}"
        );
        let repaired = of(&lost, skipping()).unwrap();
        let note = format!("{name}: 2 places without a fix are left out (option `skip_no_fix`)");
        assert!(repaired.notes.contains(&note), "{:?}", repaired.notes);
        let good = of(&[], skipping()).unwrap();
        assert!(!good.notes.iter().any(|note| note.contains("skip-no-fix")), "{:?}", good.notes);
        assert_eq!(repaired.log.stops().len(), good.log.stops().len());
        let apart_m = |(a, b): (&sextant_channel::Stop, &sextant_channel::Stop)| a.position.distance_m(b.position);
        let pairs = repaired.log.stops().iter().zip(good.log.stops());
        assert!(pairs.map(apart_m).all(|apart_m| apart_m < 0.5), "{name}");
    }
}

#[test]
fn places_without_a_fix_are_left_out_of_a_tum_path() {
    let lines = |lost: [&str; 2]| {
        let place = |second: u32| match second {
            3 => lost[0].to_owned(),
            7 => lost[1].to_owned(),
            _ => format!("{} 4000 0", 7000.0 + f64::from(second)),
        };
        (0..11).map(|second| format!("{} {}\n", 1_700_000_000 + second, place(second))).collect::<String>()
    };
    let text = lines(["nan nan nan", "0 0 0"]);
    let files = [("path.tum", text.as_str()), ("packets.csv", PACKETS)];
    let refused = read(&files, FormOptions::default(), RepairOptions::default()).unwrap_err();
    assert!(refused.contains("line 4: found `1700000003 nan nan nan`"), "{refused}");
    let repaired = read(&files, FormOptions::default(), skipping()).unwrap();
    let note = "path.tum: 2 places without a fix are left out (option `skip_no_fix`)";
    assert!(repaired.notes.iter().any(|told| told == note), "{:?}", repaired.notes);
    assert!(repaired.log.stops().iter().all(|stop| stop.position.x_m >= 7000.0));
}

#[test]
fn rows_without_a_fix_are_left_out_of_a_wide_table() {
    let table = "x_m,y_m,lamp,door\n7000,4000,-50,-80\n7001,4000,-55,-75\n0,0,-90,-90\n0,0,-91,\n,,-60,-70\n7002,4000,-60,-70\n";
    let files = [("scans.csv", table)];
    assert!(read(&files, FormOptions::default(), RepairOptions::default()).is_err());
    let repaired = read(&files, FormOptions::default(), skipping()).unwrap();
    assert_eq!(repaired.log.stops().len(), 3);
    let levels: Vec<_> = repaired.log.receptions().iter().filter_map(|at| at.rssi_dbm).collect();
    assert_eq!(levels, [-50.0, -55.0, -60.0, -80.0, -75.0, -70.0]);
    let note = "scans.csv: 3 rows without a fix are left out (option `skip_no_fix`)";
    assert!(repaired.notes.iter().any(|told| told == note), "{:?}", repaired.notes);
}

#[test]
fn in_a_wide_table_a_strength_that_was_not_measured_is_a_packet_without_one() {
    let files = [("scans.csv", "x_m,y_m,lamp\n0,0,-50\n1,0,127\n2,0,\n")];
    let refused = read(&files, FormOptions::default(), RepairOptions::default()).unwrap_err();
    assert!(refused.contains("a strength from -200 to 30 dBm"), "{refused}");
    let repaired = read(&files, FormOptions::default(), missing(127.0)).unwrap();
    let rows: Vec<_> =
        repaired.log.receptions().iter().map(|at| (at.stop, at.received, at.sent, at.rssi_dbm)).collect();
    assert_eq!(rows, [(0, 1, 1, Some(-50.0)), (1, 1, 1, None)]);
    let note = "1 signal strengths of 127 dBm count as not measured (option `rssi_missing`)";
    assert!(repaired.notes.iter().any(|told| told == note), "{:?}", repaired.notes);
}

#[test]
fn what_is_not_measured_is_no_noise() {
    // 127 is above the noise; -100 is noise, and so a packet that was lost.
    let packets = "t_s,node,rssi_dbm\n1,lamp,127\n2,lamp,-100\n3,lamp,-60\n";
    let path = "t_s,x_m,y_m\n0,0,0\n5,5,0\n";
    let form = FormOptions { noise_floor: "-95".parse().ok(), ..FormOptions::default() };
    let log = read(&[("path.csv", path), ("packets.csv", packets)], form, missing(127.0)).unwrap();
    let at = log.log.receptions().iter().next().unwrap();
    assert_eq!((at.received, at.rssi_dbm), (2, Some(-60.0)));
    let note = "1 of 2 signal strengths are at or below -95 dBm (option `noise_floor`) and count as not heard";
    assert!(log.notes.iter().any(|told| told == note), "{:?}", log.notes);
}

#[test]
fn a_delay_is_taken_off_packets_whatever_gives_the_path() {
    let path: String = (0..11).map(|second| format!("{} {second} 0 0\n", 1_700_000_000 + second)).collect();
    let files = [("path.tum", path.as_str()), ("packets.csv", "t_s,node\n1700000006,lamp\n")];
    let stops = |delay_s: f64| {
        let repair = RepairOptions { packet_delay: PacketDelay::Seconds(delay_s), ..RepairOptions::default() };
        let log = read(&files, FormOptions::default(), repair).unwrap().log;
        log.receptions().iter().filter(|at| at.received > 0).map(|at| at.stop).collect::<Vec<_>>()
    };
    assert_eq!((stops(0.0), stops(3.0), stops(-3.0)), (vec![1], vec![0], vec![1]));
}

#[test]
fn a_delay_is_refused_where_there_are_no_times_of_packets() {
    let delay = RepairOptions { packet_delay: PacketDelay::Estimated, ..RepairOptions::default() };
    let wide = [("scans.csv", "x_m,y_m,lamp\n0,0,-50\n1,0,-60\n")];
    let refused = read(&wide, FormOptions::default(), delay.clone()).unwrap_err();
    assert!(
        refused.contains("option `packet_delay` is for logs of packets and a path")
            && refused.contains("a column a node"),
        "{refused}"
    );
    let stops = [("stops.csv", "stop,x_m,y_m\nA,0,0\n"), ("receptions.csv", "node,stop,received,sent\na,A,1,1\n")];
    let refused = read(&stops, FormOptions::default(), delay).unwrap_err();
    assert!(refused.contains("a folder with stops"), "{refused}");
}
