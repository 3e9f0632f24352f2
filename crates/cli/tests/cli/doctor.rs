//! What `sextant map` and `sextant inspect` say of logs that are broken, and what the flags do that they name. Each check by
//! itself is tested beside its code.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;
use sextant_kernel::{Purpose, Seed};
use sextant_logs::{self as robot_log, PacketDelay, ReadOptions, RobotLog};
use tempfile::TempDir;

use super::drive::kept;
use super::program::{Said, call};

/// Places of the nodes of a hall of 12 by 8 m.
const NODES: [(&str, f64, f64); 8] = [
    ("a", 1.0, 1.5),
    ("b", 4.5, 2.0),
    ("c", 10.5, 1.0),
    ("d", 2.5, 6.5),
    ("e", 7.0, 3.5),
    ("f", 11.0, 6.0),
    ("g", 6.0, 7.5),
    ("h", 8.5, 5.5),
];

fn normal(place: [u64; 3]) -> f64 {
    Seed(5).normal(Purpose::new(8), place)
}

/// Strength of a packet of a node at a place (dBm).
fn level_dbm(node: usize, (x_m, y_m): (f64, f64), packet: u64) -> f64 {
    let (_, node_x_m, node_y_m) = NODES[node];
    let distance_m = f64::hypot(x_m - node_x_m, y_m - node_y_m).max(0.3);
    (-48.0 - 26.0 * distance_m.log10() + 2.5 * normal([node as u64, packet, 1])).round()
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).unwrap();
}

/// A log of stops every 2 m, five packets of each node at each. `place` is how the rows of `stops.csv` give places, `level`
/// changes strengths.
fn stops(header: &str, place: impl Fn(f64, f64) -> String, level: impl Fn(u32, f64) -> f64) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut stops = format!("stop,{header}\n");
    let mut receptions = "node,stop,received,sent,rssi_dbm\n".to_owned();
    let mut row = 0;
    for stop in 0..35_u32 {
        let (x_m, y_m) = (2.0 * f64::from(stop % 7), 2.0 * f64::from(stop / 7));
        writeln!(stops, "{stop},{}", place(x_m, y_m)).unwrap();
        for (node, (name, ..)) in NODES.iter().enumerate() {
            let heard: Vec<f64> = (0..5_u64)
                .map(|packet| level_dbm(node, (x_m, y_m), 5 * u64::from(stop) + packet))
                .filter(|level| *level > -70.0)
                .collect();
            let mean = heard.iter().sum::<f64>() / heard.len() as f64;
            let shown = if heard.is_empty() { String::new() } else { level(row, mean).to_string() };
            writeln!(receptions, "{name},{stop},{},5,{shown}", heard.len()).unwrap();
            row += 1;
        }
    }
    write(folder.path(), "stops.csv", &stops);
    write(folder.path(), "receptions.csv", &receptions);
    folder
}

fn metres(x_m: f64, y_m: f64) -> String {
    format!("{x_m},{y_m}")
}

/// A drive on lanes to and fro at 0.5 m/s; the packets, two a second of each node, have times that are late by `delay_s`.
fn drive(delay_s: f64) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let mut path = "t_s,x_m,y_m\n".to_owned();
    let mut packets = Vec::new();
    let (mut x_m, mut y_m, mut heading, mut turning_to_m) = (0.0, 0.0, 1.0, 0.0_f64);
    for half in 0_u32.. {
        let time_s = 50.0 + 0.5 * f64::from(half);
        writeln!(path, "{time_s},{x_m},{y_m}").unwrap();
        for (node, (name, ..)) in NODES.iter().enumerate() {
            let level = level_dbm(node, (x_m, y_m), u64::from(half));
            if level > -72.0 {
                packets.push(format!("{},{name},{level}\n", time_s + delay_s));
            }
        }
        if y_m < turning_to_m {
            y_m = (y_m + 0.25_f64).min(turning_to_m);
        } else if (0.0..=12.0).contains(&(x_m + 0.25 * heading)) {
            x_m += 0.25 * heading;
        } else if y_m >= 8.0 {
            break;
        } else {
            (heading, turning_to_m) = (-heading, y_m + 2.0);
        }
    }
    write(folder.path(), "path.csv", &path);
    write(folder.path(), "packets.csv", &format!("t_s,node,rssi_dbm\n{}", packets.concat()));
    folder
}

fn options(change: impl Fn(&mut ReadOptions)) -> ReadOptions {
    let mut options = ReadOptions::default();
    change(&mut options);
    options
}

fn read(folder: &TempDir, change: impl Fn(&mut ReadOptions)) -> RobotLog {
    robot_log::read(folder.path(), &options(change)).unwrap()
}

fn checks(log: &RobotLog) -> Vec<&'static str> {
    log.findings.iter().map(|finding| finding.check).collect()
}

#[test]
fn good_logs_have_no_findings() {
    assert_eq!(checks(&read(&stops("x_m,y_m", metres, |_, level| level), |_| {})), Vec::<&str>::new());
    // A drive has none either: [`late_packets_are_found_and_corrected`] reads one whose times are right.
}

#[test]
fn late_packets_are_found_and_corrected() {
    let late = drive(4.0);
    let broken = read(&late, |_| {});
    assert_eq!(checks(&broken), ["clock-offset"]);
    let told = read(&late, |options| options.repair.packet_delay = PacketDelay::Estimated);
    assert_eq!(checks(&told), Vec::<&str>::new());
    let clock = broken.clock.unwrap();
    assert!((clock.delay_s - 4.0).abs() < 0.5, "{clock:?}");
    let note = told.notes.iter().find(|note| note.contains("`packet_delay=auto`")).unwrap();
    assert!(
        note.starts_with(&format!("the times of the packets are estimated to be {:.2} ±", clock.delay_s)),
        "{note}"
    );
    let none = read(&drive(0.0), |options| options.repair.packet_delay = PacketDelay::Estimated);
    assert_eq!(checks(&none), Vec::<&str>::new());
    assert!(none.notes.iter().any(|note| note.starts_with("no delay of the packets is clear")));
    let stdout = call(late.path(), &["inspect", "."]).printed();
    assert!(stdout.contains("odd: the times of the packets seem to be ") && stdout.contains("s late by the clock"));
    assert!(stdout.contains("nodes      8 named, 8 heard"), "{stdout}");
    let inside = call(late.path(), &["inspect", ".", "--format", "json", "--packet-delay", "4"]).json();
    assert_eq!((&inside["log"]["findings"], &inside["log"]["nodes"]), (&serde_json::json!([]), &8.into()));
}

#[test]
fn a_delay_is_for_packets_with_a_path() {
    let folder = stops("x_m,y_m", metres, |_, level| level);
    let stderr = call(folder.path(), &["map", ".", "--packet-delay", "auto"]).refusal();
    assert!(stderr.contains("`--packet-delay` is for logs of packets and a path"), "{stderr}");
    let stderr = call(folder.path(), &["map", ".", "--packet-delay", "soon"]).refusal();
    assert!(stderr.contains("expected seconds from -1e9 to 1e9, or auto"), "{stderr}");
}

#[test]
fn strengths_that_stand_for_none_are_found_and_left_out() {
    let folder = stops("x_m,y_m", metres, |row, level| if row % 9 == 0 { 127.0 } else { level });
    let broken = read(&folder, |_| {});
    assert_eq!(checks(&broken), ["impossible-strengths"]);
    let repaired = read(&folder, |options| options.repair.rssi_missing = vec![127.0]);
    assert_eq!(checks(&repaired), Vec::<&str>::new());
    let levels = |log: &RobotLog| log.log.receptions().iter().filter_map(|row| row.rssi_dbm).fold(-200.0, f64::max);
    assert!((levels(&broken) - 127.0).abs() < 1e-9 && levels(&repaired) < 0.0);
    let received = |log: &RobotLog| log.log.receptions().iter().map(|row| row.received).sum::<u32>();
    assert_eq!(received(&broken), received(&repaired), "the packets count all the same");
    assert!(repaired.notes.iter().any(|note| note.contains("signal strengths of 127 dBm count as not measured")));
}

#[test]
fn silence_that_is_written_as_a_strength_is_found_and_left_out() {
    let folder = stops("x_m,y_m", metres, |row, level| if row % 2 == 0 { -92.0 } else { level });
    let broken = read(&folder, |_| {});
    assert!(checks(&broken).contains(&"silence-as-strength"), "{:?}", broken.findings);
    let repaired = read(&folder, |options| options.form.noise_floor = Some("-92".parse().unwrap()));
    assert!(!checks(&repaired).contains(&"silence-as-strength"), "{:?}", repaired.findings);
}

#[test]
fn saturated_and_coarse_strengths_are_found_in_logs() {
    let saturated = stops("x_m,y_m", metres, |_, level| level.min(-58.0));
    assert_eq!(checks(&read(&saturated, |_| {})), ["saturated-strengths"]);
    let coarse = stops("x_m,y_m", metres, |_, level| (level / 4.0).round() * 4.0);
    assert_eq!(checks(&read(&coarse, |_| {})), ["coarse-strengths"]);
}

#[test]
fn rows_without_a_fix_are_left_out_by_a_flag() {
    let degrees = |x_m: f64, y_m: f64| match (x_m, y_m) {
        (4.0, 4.0) => "0,0".to_owned(),
        (6.0, 4.0) => ",".to_owned(),
        _ => format!("{},{}", 50.0 + y_m / 111_230.0, 3.0 + x_m / 71_700.0),
    };
    #[expect(clippy::float_cmp, reason = "small whole numbers")]
    let far = |x_m: f64, y_m: f64| {
        if y_m == 4.0 && x_m < 5.0 { "0,0".to_owned() } else { format!("{},{}", 5e5 + x_m, 5.5e6 + y_m) }
    };
    let folder = stops("lat,lon", degrees, |_, level| level);
    let refused = robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("option `skip_no_fix` leaves such rows out"), "{refused}");
    let repaired = read(&folder, |options| options.repair.skip_no_fix = true);
    assert_eq!((repaired.log.stops().len(), checks(&repaired)), (33, Vec::new()));
    let note = "stops.csv: 2 rows without a fix are left out, with 16 rows of receptions.csv (option `skip_no_fix`)";
    assert!(repaired.notes.iter().any(|told| told == note), "{:?}", repaired.notes);

    let folder = stops("x_m,y_m", far, |_, level| level);
    let broken = read(&folder, |_| {});
    assert_eq!(checks(&broken), ["no-fix"]);
    assert!(broken.findings[0].odd.starts_with("3 of 35 stops are at x = y = 0, "), "{}", broken.findings[0]);
    let repaired = read(&folder, |options| options.repair.skip_no_fix = true);
    assert_eq!((repaired.log.stops().len(), checks(&repaired)), (32, Vec::new()));

    let folder = drive(0.0);
    let path = std::fs::read_to_string(folder.path().join("path.csv")).unwrap();
    write(folder.path(), "path.csv", &path.replacen("\n60,", "\n60,,\n60.1,", 1).replacen("60,,", "60,nan,", 1));
    let repaired = read(&folder, |options| options.repair.skip_no_fix = true);
    assert!(
        repaired
            .notes
            .iter()
            .any(|note| note == "path.csv: 1 rows without a fix are left out (option `skip_no_fix`)")
    );
}

/// A path from a base 300 m west of a hall, in ten minutes, and then through the hall: places of whole metres by time (s).
fn from_base() -> Vec<(f64, f64, f64)> {
    let hall = |step: u32| (700.0 + f64::from(step), 300.0 + f64::from(step % 13), f64::from(step / 13));
    std::iter::once((100.0, 0.0, 0.0)).chain((0..117).map(hall)).collect()
}

#[test]
fn the_first_place_is_one_whatever_form_the_path_has() {
    let degrees = |x_m: f64, y_m: f64| (50.0 + y_m / 111_230.0, 3.0 + x_m / 71_700.0);
    let csv = |header: &str, place: &dyn Fn(f64, f64) -> String| {
        let row = |(time_s, x_m, y_m): (f64, f64, f64)| format!("{time_s},{}\n", place(x_m, y_m));
        format!("t_s,{header}\n{}", from_base().into_iter().map(row).collect::<String>())
    };
    let point = |(time_s, x_m, y_m): (f64, f64, f64)| {
        let (lat, lon) = degrees(x_m, y_m);
        let (minute, second) = ((time_s / 60.0).floor(), time_s % 60.0);
        format!("<trkpt lat=\"{lat}\" lon=\"{lon}\"><time>1970-01-01T00:{minute:02}:{second:02}Z</time></trkpt>")
    };
    let points = from_base().into_iter().map(point).collect::<String>();
    let pose = |(time_s, x_m, y_m): (f64, f64, f64)| format!("{time_s} {x_m} {y_m} 0 0 0 0 1\n");
    let paths = [
        ("path.csv", csv("x_m,y_m", &metres)),
        (
            "path.csv",
            csv("lat,lon", &|x_m, y_m| {
                let (lat, lon) = degrees(x_m, y_m);
                format!("{lat},{lon}")
            }),
        ),
        ("walk.gpx", format!("<gpx><trk><trkseg>{points}</trkseg></trk></gpx>")),
        ("walk.tum", from_base().into_iter().map(pose).collect::<String>()),
    ];
    for (name, text) in paths {
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), name, &text);
        let packet = |i: u32| format!("{},lamp,{}\n", 700 + i, -60 - i32::try_from(i % 9).unwrap());
        write(
            folder.path(),
            "packets.csv",
            &format!("t_s,node,rssi_dbm\n{}", (0..117).map(packet).collect::<String>()),
        );
        let found = read(&folder, |_| {});
        assert!(!checks(&found).contains(&"no-fix"), "{name}: {:?}", found.findings);
        let skipping = read(&folder, |options| options.repair.skip_no_fix = true);
        assert!(!skipping.notes.iter().any(|note| note.contains("left out")), "{name}: {:?}", skipping.notes);
        assert_eq!(skipping.log, found.log, "{name}");
    }
}

#[test]
fn the_first_stop_is_one_whatever_its_places_are() {
    let west = |x_m: f64, y_m: f64| if x_m + y_m > 0.0 { (x_m + 300.0, y_m) } else { (0.0, 0.0) };
    let degrees = |x_m: f64, y_m: f64| {
        let (x_m, y_m) = west(x_m, y_m);
        format!("{},{}", 50.0 + y_m / 111_230.0, 3.0 + x_m / 71_700.0)
    };
    let plain = |x_m: f64, y_m: f64| {
        let (x_m, y_m) = west(x_m, y_m);
        metres(x_m, y_m)
    };
    for folder in [stops("lat,lon", degrees, |_, level| level), stops("x_m,y_m", plain, |_, level| level)] {
        assert!(!checks(&read(&folder, |_| {})).contains(&"no-fix"));
        let skipping = read(&folder, |options| options.repair.skip_no_fix = true);
        assert_eq!(skipping.log.stops().len(), 35, "{:?}", skipping.notes);
    }
}

#[test]
fn strengths_that_distances_do_not_explain_are_told_everywhere() {
    let folder = stops("x_m,y_m", metres, |row, _| (-70.0 + 12.0 * normal([7, u64::from(row), 2])).round());
    assert_eq!(checks(&read(&folder, |_| {})), ["flat-losses", "no-distance"]);
    let (code, inspected, _) = call(folder.path(), &["inspect", "."]).all();
    assert!(code == 0 && inspected.contains("odd: distances explain nothing here"), "{inspected}");
    let words = ["map", ".", "--algorithm", "rss-grid", "--format", "json"];
    let (_, summary, stderr) = call(folder.path(), &words).all();
    assert!(stderr.contains("note: distances explain nothing here"), "{stderr}");
    let told = |notes: &Value| notes.to_string().contains("distances explain nothing here");
    assert!(told(&serde_json::from_str::<Value>(&summary).unwrap()["notes"]), "{summary}");
    let (code, _, stderr) =
        call(folder.path(), &["report", ".", "--out", "log.html", "--algorithm", "rss-grid"]).all();
    assert_eq!(code, 0, "{stderr}");
    assert!(stderr.contains("note: distances explain nothing here"), "{stderr}");
}

#[test]
fn swapped_degrees_are_told() {
    let folder = tempfile::tempdir().unwrap();
    write(folder.path(), "stops.csv", "stop,lat,lon\nA,50,3\nB,3,50\n");
    write(folder.path(), "receptions.csv", "node,stop,received,sent\na,A,1,1\n");
    let refused = robot_log::read(folder.path(), &ReadOptions::default()).unwrap_err().to_string();
    assert!(refused.contains("with `lat` and `lon` swapped it is that near"), "{refused}");
}

/// The summary and the text of a quick map of a log with the true positions in `truth`.
fn mapped(folder: &Path, truth: &str) -> (Value, String) {
    write(folder, "truth.csv", truth);
    let words = ["map", ".", "--algorithm", "rss-grid", "--truth", "truth.csv"];
    (call(folder, &[&words[..], &["--format", "json"]].concat()).json(), call(folder, &words).printed())
}

fn truth(header: &str, place: impl Fn(f64, f64) -> String) -> String {
    let rows: String = NODES.iter().map(|(name, x_m, y_m)| format!("{name},{}\n", place(*x_m, *y_m))).collect();
    format!("node,{header}\n{rows}")
}

#[test]
fn swapped_axes_are_told_by_the_true_positions() {
    let folder = stops("x_m,y_m", metres, |_, level| level);
    let told = |truth: &str| {
        let (summary, _) = mapped(folder.path(), truth);
        let notes = summary["notes"].as_array().unwrap().clone();
        notes
            .iter()
            .filter_map(Value::as_str)
            .filter(|note| note.contains("differ by their axes"))
            .collect::<String>()
    };
    assert_eq!(told(&truth("x_m,y_m", metres)), "");
    let swapped = told(&truth("x_m,y_m", |x_m, y_m| metres(y_m, x_m)));
    assert!(swapped.contains("x and y are swapped") && swapped.contains("Swap the columns"), "{swapped}");
    let feet = told(&truth("x_m,y_m", |x_m, y_m| metres(x_m / 0.3048, y_m / 0.3048)));
    assert!(feet.contains("the true positions seem to be in feet"), "{feet}");
}

#[test]
fn true_positions_without_heights_are_measured_in_the_plane() {
    let folder = stops("x_m,y_m,z_m", |x_m, y_m| format!("{x_m},{y_m},1.2"), |_, level| level);
    let (flat, text) = mapped(folder.path(), &truth("x_m,y_m", metres));
    let (space, other) = mapped(folder.path(), &truth("x_m,y_m,z_m", |x_m, y_m| format!("{x_m},{y_m},1.2")));
    let (flat, space) = (&flat["maps"][0], &space["maps"][0]);
    assert_eq!((&flat["measured_in"], space.get("measured_in")), (&"plane".into(), None));
    let mean = |map: &Value| map["position_error_m"]["mean"].as_f64().unwrap();
    // The map is at the height of the stops, so the errors are those of true positions at this height.
    assert!((mean(flat) - mean(space)).abs() < 1e-9, "{flat:#}");
    let (ground, _) = mapped(folder.path(), &truth("x_m,y_m,z_m", |x_m, y_m| format!("{x_m},{y_m},0")));
    assert!(mean(&ground["maps"][0]) > mean(flat) + 0.3);
    let line = "errors and regions in the plane (x, y): the true positions have no heights";
    assert!(text.contains(line) && !other.contains(line), "{text}");
}

#[test]
fn nobody_with_strengths_is_told_to_measure_strengths() {
    let folder = tempfile::tempdir().unwrap();
    let (mut with, mut without) =
        ("node,stop,received,sent,rssi_dbm\n".to_owned(), "node,stop,received,sent\n".to_owned());
    for (node, stop) in (0..4).flat_map(|node| (0..9).map(move |stop| (node, stop))) {
        writeln!(with, "n{node},{stop},10,10,{}", -50 - 3 * ((node + stop) % 7)).unwrap();
        writeln!(without, "n{node},{stop},10,10").unwrap();
    }
    let stops: String = (0..9).map(|stop| format!("{stop},{},{}\n", stop % 3, stop / 3)).collect();
    write(folder.path(), "stops.csv", &format!("stop,x_m,y_m\n{stops}"));
    let advice = "a map needs stops that are out of reach";
    for (text, is_told) in [(with, false), (without, true)] {
        write(folder.path(), "receptions.csv", &text);
        let (code, stdout, stderr) = call(folder.path(), &["inspect", "."]).all();
        assert_eq!((code, stdout.contains(advice)), (0, is_told), "{stdout}{stderr}");
    }
}

#[test]
fn an_inspected_bag_has_recorded_time_and_its_log() {
    let bag = kept("bags").join("odometry/odometry.mcap");
    let stdout = call(Path::new("."), &["inspect", bag.to_str().unwrap(), "--stop-every", "1s"]).printed();
    assert!(stdout.contains("of recorded time") && !stdout.contains("simulated"), "{stdout}");
    assert!(stdout.contains("nodes      3 named, 3 heard"), "{stdout}");
}
