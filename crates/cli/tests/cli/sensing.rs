//! Targets, fields and sensors from a scenario to its recording and its figures.

use std::path::Path;

use sextant_channel::Position;
use sextant_kernel::SimTime;
use sextant_recording::{RecordedWorld, SUMMARY_ATTACHMENT, Sensation, read_log, read_run, read_world};
use tempfile::TempDir;

use crate::program::{Said, scenario, sets, sextant};

const SHIPPED: &str = "sensing/targets-and-fields.toml";

/// A target that stands at a place, as a flag sets it.
fn standing(name: &str, place_m: &str) -> String {
    format!("{{ name = \"{name}\", motion.waypoints = {{ places_m = [{place_m}], speed_m_per_s = 1.0 }} }}")
}

/// Runs a shipped scenario with other settings.
fn run(name: &str, set: &[&str], out: &Path) {
    let output = sextant().arg("run").arg(scenario(name)).arg("--out").arg(out).args(sets(set)).output();
    output.expect("it starts").printed();
}

/// The shipped scenario with other settings, and what is drawn of its recording.
fn recorded(set: &[&str]) -> (TempDir, RecordedWorld) {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("run.mcap");
    run(SHIPPED, set, &path);
    let drawn = read_world(&path).expect("a recording");
    (folder, drawn)
}

#[test]
fn the_summary_counts_the_recorded_detections() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("run.mcap");
    run(SHIPPED, &[], &path);
    let recorded = read_run(&path).expect("a recording");
    let summary = recorded.attachments.iter().find(|attachment| attachment.name == SUMMARY_ATTACHMENT);
    let json: serde_json::Value = serde_json::from_slice(&summary.expect("a summary").data).expect("JSON");
    let drawn = read_world(&path).expect("a recording");
    let entered = drawn.detections.iter().filter(|detection| detection.sensation == Sensation::Entered).count();
    assert_eq!(json["sensing"]["detections"].as_u64(), Some(entered as u64));
    assert_eq!((json["sensing"]["targets"].as_u64(), json["sensing"]["fields"].as_u64()), (Some(2), Some(1)));
    assert!(json["sensing"]["samples"].as_u64() > Some(1000), "{}", json["sensing"]);
}

#[test]
fn recordings_and_summaries_have_what_sensors_that_err_said() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("run.mcap");
    let counts = |set: &[&str]| {
        run(SHIPPED, set, &path);
        let recorded = read_run(&path).expect("a recording");
        let summary = recorded.attachments.iter().find(|attachment| attachment.name == SUMMARY_ATTACHMENT);
        let json: serde_json::Value = serde_json::from_slice(&summary.expect("a summary").data).expect("JSON");
        let drawn = read_world(&path).expect("a recording");
        let entered = drawn.detections.iter().filter(|detection| detection.sensation == Sensation::Entered).count();
        let count = |key: &str| json["sensing"][key].as_u64();
        assert_eq!(count("detections"), Some(entered as u64));
        (entered as u64, count("missed_detections"), count("false_detections"))
    };
    let (all, none, neither) = counts(&[]);
    assert_eq!((none, neither), (None, None), "sensors without errors have no counts of them");
    let (some, missed, false_ones) = counts(&["sensors.targets.miss_probability=0.4"]);
    assert_eq!((some + missed.expect("a count"), false_ones), (all, Some(0)));
    assert!(missed > Some(0) && some > 0);
    let (more, missed, false_ones) = counts(&["sensors.targets.false_alarms_per_h=40.0"]);
    // A false alarm of a node that detects the target already says nothing new, and neither does the target.
    let false_ones = false_ones.expect("a count");
    assert!(
        missed == Some(0) && false_ones > 10 && more <= all + false_ones && more > all,
        "{more} {all} {false_ones}"
    );
}

#[test]
fn each_recorded_detection_is_at_the_rim_of_the_node() {
    let (_folder, drawn) = recorded(&[]);
    assert_eq!(drawn.detection_radius_m, Some(2.5));
    let [intruder, animal] = &drawn.targets[..] else { panic!("two targets") };
    // Seven places, the last one again at the end.
    assert_eq!(
        (intruder.name.as_str(), intruder.way.points().len(), animal.way.points().len() > 20),
        ("intruder", 8, true)
    );
    assert!(drawn.detections.len() > 150, "{}", drawn.detections.len());
    for detection in &drawn.detections {
        let target = drawn.targets.iter().find(|target| target.name == detection.target).unwrap();
        let distance_m = target.way.at(detection.time).unwrap().distance_m(drawn.nodes[&detection.node]);
        let starts_inside = detection.time == SimTime::ZERO && distance_m < 2.5;
        assert!(starts_inside || (distance_m - 2.5).abs() < 1e-8, "{detection:?} at {distance_m} m");
    }
    for node in drawn.nodes.keys() {
        for target in &drawn.targets {
            let of_both = drawn.detections.iter().filter(|d| d.node == *node && d.target == target.name);
            let in_turn = of_both.enumerate().all(|(i, d)| (d.sensation == Sensation::Entered) == (i % 2 == 0));
            assert!(in_turn, "{node:?} {}", target.name);
        }
    }
}

#[test]
fn readings_and_snapshots_are_those_of_the_field() {
    let set = ["sensors.fields={ interval_s = 20.0 }", "recording.fields.at_s=[10.0, 1e6]", "world.targets=[]"];
    let (_folder, drawn) = recorded(&set);
    let gas = |p: Position, time: SimTime| {
        let bell = |x: f64, y: f64, sigma: f64| {
            (-((p.x_m - x).powi(2) + (p.y_m - y).powi(2) + p.z_m.powi(2)) / (2.0 * sigma * sigma)).exp()
        };
        let since_closed = (time.as_secs_f64() - 120.0).max(0.0);
        10.0 * bell(33.0, 8.0, 6.0) + 7.0 * bell(12.0, 13.0, 4.0) * (-since_closed / 40.0).exp()
    };
    assert_eq!(drawn.samples.len(), 15 * drawn.nodes.len());
    for sample in &drawn.samples {
        assert!((sample.value - gas(drawn.nodes[&sample.node], sample.time)).abs() < 1e-12, "{sample:?}");
    }
    // The second instant is after the end.
    let [snapshot] = &drawn.fields[..] else { panic!("one snapshot") };
    let plane = &snapshot.plane;
    assert!(plane.values.len() > 4000);
    for (i, value) in (0_u32..).zip(&plane.values) {
        let (column, row) = (f64::from(i % plane.columns), f64::from(i / plane.columns));
        let place = plane.first + Position::new(column, row, 0.0) * plane.step_m;
        // Recorded with single precision.
        assert!((value - gas(place, snapshot.time)).abs() < 1e-5, "{value} at {place:?}");
    }
}

#[test]
fn equal_seeds_give_equal_bytes() {
    let folder = TempDir::new().unwrap();
    let bytes = |set: &[&str]| {
        let path = folder.path().join("run.mcap");
        run(SHIPPED, set, &path);
        std::fs::read(&path).unwrap()
    };
    let first = bytes(&[]);
    assert!(first == bytes(&[]), "the recordings differ");
    assert!(first != bytes(&["seed=2"]));
}

#[test]
fn sensors_do_not_change_what_a_robot_hears() {
    let folder = TempDir::new().unwrap();
    let log = |set: &[&str]| {
        let path = folder.path().join("run.mcap");
        run("smoke.toml", set, &path);
        (read_log(&path).unwrap().logs, read_world(&path).unwrap().detections.len())
    };
    let (without, none) = log(&[]);
    let target = format!("world.targets=[{}]", standing("cat", "[3.0, 3.0]"));
    let (with, some) = log(&[&target, "sensors.targets.radius_m=2.0"]);
    assert!(none == 0 && some > 0 && !without.first().receptions().is_empty());
    assert_eq!(with, without);
}

#[test]
fn the_ways_with_their_detections_and_the_fields_are_drawn() {
    let (folder, drawn) = recorded(&[]);
    sextant().arg("figure").arg(folder.path().join("run.mcap")).output().expect("it starts").printed();
    let figure = |name: &str| std::fs::read_to_string(folder.path().join("run.figures").join(name)).unwrap();
    let targets = figure("targets.svg");
    assert!(targets.contains("way of intruder") && targets.contains("radius of detection, 2.5 m"));
    // A disc and a dot for each node, a mark for each crossing, a hole in it where a target leaves; one node and one
    // crossing in the legend.
    let left = drawn.detections.iter().filter(|detection| detection.sensation == Sensation::Left).count();
    let circles = 2 * drawn.nodes.len() + drawn.detections.len() + left + 2;
    assert_eq!(targets.matches("<circle").count(), circles);
    // Nobody has read anything at the start; later each node has, and its disc has two rims.
    assert_eq!(figure("field-gas-0s.svg").matches("<circle").count(), drawn.nodes.len() + 1);
    assert_eq!(figure("field-gas-150s.svg").matches("<circle").count(), 3 * drawn.nodes.len() + 1);
    assert!(figure("field-gas-300s.svg").contains("targets-and-fields: gas at 300 s"));
}

#[test]
fn mistakes_in_targets_fields_and_sensors_are_found_at_their_key() {
    let cases = [
        (
            "world.targets.0.motion.waypoints.places_m=[]",
            "`world.targets[0].motion.waypoints.places_m` is an empty list",
        ),
        (
            "world.targets.0.motion.waypoints.places_m.1=[24.0, 15.0]",
            "`world.targets[0].motion.waypoints.places_m[1]` is [24, 15, 0], inside obstacle `shed`",
        ),
        (
            "world.targets.0.motion.waypoints.places_m.2=[30.0, 20.0]",
            "`world.targets[0].motion.waypoints.places_m[2]` is [30, 20, 0], behind obstacle `shed`",
        ),
        (
            "world.targets.1.motion.random_walk.speed_m_per_s=0.0",
            "`world.targets[1].motion.random_walk.speed_m_per_s` is 0",
        ),
        (
            "world.targets.1.motion.random_walk.start_m=[90.0, 0.0]",
            "`world.targets[1].motion.random_walk.start_m` is",
        ),
        ("world.targets.1.name=\"intruder\"", "`world.targets[1].name` is `intruder`, as targets[0]"),
        ("world.fields.0.gaussians.1.sigma_m=-4.0", "`world.fields[0].gaussians[1].sigma_m` is -4"),
        ("world.fields.0.gaussians.0.peak=nan", "`world.fields[0].gaussians[0].peak` is NaN"),
        ("sensors.targets.radius_m=0.0", "`sensors.targets.radius_m` is 0"),
        ("sensors.targets.miss_probability=1.0", "`sensors.targets.miss_probability` is 1"),
        ("sensors.targets.false_alarms_per_h=-2.0", "`sensors.targets.false_alarms_per_h` is -2"),
        ("sensors.targets.false_alarm_s=0.0", "`sensors.targets.false_alarm_s` is 0"),
        ("sensors.fields.offset_snr_db=1e9", "`sensors.fields.offset_snr_db` is 1000000000"),
        ("recording.fields.step_m=1e-3", "`recording.fields.step_m` is 0.001, which gives"),
        ("recording.fields.at_s.1=-1.0", "`recording.fields.at_s[1]` is -1"),
    ];
    for (set, expected) in cases {
        let output = sextant().arg("check").arg(scenario(SHIPPED)).args(["--set", set]).output().expect("it starts");
        let words = String::from_utf8_lossy(&output.stderr)
            .replace("\n  │", "")
            .split_whitespace()
            .collect::<Vec<_>>()
            .join(" ");
        assert_eq!(output.status.code(), Some(2), "{set}: {words}");
        assert!(words.contains(expected), "{set}: {words}");
    }
}

#[test]
fn a_target_with_the_name_of_a_robot_is_rejected() {
    let target = format!("world.targets=[{}]", standing("surveyor", "[3.0, 3.0]"));
    let output =
        sextant().arg("check").arg(scenario("smoke.toml")).args(["--set", &target]).output().expect("it starts");
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(error.contains("`world.targets[0].name` is `surveyor`, the name of a robot"), "{error}");
}
