//! Robots whose odometry has errors, and robots that listen while they drive: their recordings and their maps.

use std::path::{Path, PathBuf};

use foxglove::messages::{FrameTransform, PoseInFrame, Vector3};
use prost::Message;
use serde_json::Value;
use sextant_channel::Position;
use sextant_recording::{read_log, read_world};

use crate::program::{Said, scenario, sets, sextant, summary};

/// A recording and the summary of its run.
struct Run {
    folder: tempfile::TempDir,
    recording: PathBuf,
    summary: Value,
}

/// Runs a scenario with these settings.
fn run(name: &str, settings: &[&str]) -> Run {
    let folder = tempfile::tempdir().expect("there is room");
    let (recording, json) = (folder.path().join("run.mcap"), folder.path().join("run.json"));
    let mut command = sextant();
    command.arg("run").arg(scenario(name)).arg("--out").arg(&recording).arg("--summary").arg(&json);
    command.args(sets(settings)).output().expect("it starts").printed();
    Run { summary: summary(&json), folder, recording }
}

/// The messages of a topic with their times (ns).
fn messages<M: Message + Default>(recording: &Path, topic: &str) -> Vec<(u64, M)> {
    let bytes = std::fs::read(recording).expect("a recording");
    let messages = mcap::MessageStream::new(&bytes).expect("a recording").map(|message| message.expect("a message"));
    messages
        .filter(|message| message.channel.topic == topic)
        .map(|message| (message.log_time, M::decode(&*message.data).expect("a message of this type")))
        .collect()
}

fn position(vector: Option<Vector3>) -> Position {
    let Vector3 { x, y, z } = vector.expect("a position");
    Position::new(x, y, z)
}

fn mean_error_m(run: &Run) -> f64 {
    run.summary["maps"][0]["position_error_m"]["mean"].as_f64().expect("an error")
}

#[test]
fn a_recording_has_the_believed_and_the_true_poses() {
    // The robot starts at the origin: all true places are 5 % farther from there than the believed ones.
    let run = run(
        "ml-tm/odometry-drift.toml",
        &["robots.0.odometry.heading_drift_rad_per_m=0.0", "robots.0.odometry.scale_error=0.05"],
    );
    let truth: Vec<(u64, FrameTransform)> = messages(&run.recording, "/tf");
    let belief: Vec<(u64, PoseInFrame)> = messages(&run.recording, "/robot/surveyor/odometry");
    assert_eq!(truth.len(), belief.len());
    assert!(truth.len() > 200);
    for ((time, truth), (believed_at, belief)) in truth.iter().zip(&belief) {
        assert_eq!((time, belief.frame_id.as_str()), (believed_at, "world"));
        let truth = position(truth.translation);
        let believed = position(belief.pose.as_ref().and_then(|pose| pose.position));
        assert!(truth.distance_m(believed * 1.05) < 1e-9, "{truth} and {believed}");
    }
    // Stops are at believed places, on the lattice of the path; the path is the true one.
    let log = read_log(&run.recording).expect("a recording").logs.first().clone();
    assert_eq!(log.stops().len(), 121);
    for stop in log.stops() {
        let Position { x_m, y_m, .. } = stop.position;
        assert!((x_m - x_m.round()).abs() < 1e-9 && (y_m - y_m.round()).abs() < 1e-9, "{}", stop.position);
    }
    let drawn = read_world(&run.recording).expect("a recording");
    let end = *drawn.paths[0].1.last().expect("a path");
    assert!(end.distance_m(Position::new(10.5, 10.5, 0.0)) < 1e-9, "{end}");
    let length_m = run.summary["gathering"]["path_length_m"].as_f64().expect("a length");
    assert!((length_m - 126.0).abs() < 1e-9, "{length_m}");
}

#[test]
fn an_arc_is_recorded_with_poses_on_the_way() {
    // Each step of 1 m turns the robot by 11.5 degrees: three parts, and so four poses. Their headings are 0.2 / 3 rad
    // apart, and a chord points halfway between the headings at its ends.
    let run = run("ml-tm/odometry-drift.toml", &["robots.0.odometry.heading_drift_rad_per_m=0.2"]);
    let poses: Vec<(u64, FrameTransform)> = messages(&run.recording, "/tf");
    assert_eq!(poses.len(), 1 + 4 * 120);
    let heading_rad = |pose: &FrameTransform| {
        let rotation = pose.rotation.as_ref().expect("a rotation");
        2.0 * rotation.z.atan2(rotation.w)
    };
    for drive in poses[1..].chunks(4) {
        for pair in drive.windows(2) {
            let [from, to] = [&pair[0].1, &pair[1].1];
            let chord = position(to.translation) - position(from.translation);
            let turn_rad = heading_rad(to) - heading_rad(from);
            assert!((turn_rad.rem_euclid(std::f64::consts::TAU) - 0.2 / 3.0).abs() < 1e-6, "{turn_rad}");
            let middle_rad = heading_rad(from) + 0.1 / 3.0;
            let aside_m = chord.y_m * middle_rad.cos() - chord.x_m * middle_rad.sin();
            assert!(aside_m.abs() < 1e-6 && (chord.length_m() - 1.0 / 3.0).abs() < 1e-4, "{chord}");
        }
    }
    let drawn = read_world(&run.recording).expect("a recording");
    assert_eq!(drawn.paths[0].1.len(), 1 + 3 * 120);
}

#[test]
fn a_map_is_worse_the_more_the_odometry_drifts_and_has_no_bound() {
    let drifting = |drift: &str| {
        run("ml-tm/odometry-drift.toml", &[&format!("robots.0.odometry.heading_drift_rad_per_m={drift}")])
    };
    let [none, some, much] = ["0.0", "0.002", "0.01"].map(drifting);
    let errors = [&none, &some, &much].map(mean_error_m);
    assert!(errors[0] < 0.5 && errors[1] > 1.3 * errors[0] && errors[2] > 2.0 * errors[1], "{errors:?} m");
    let bound = |run: &Run| run.summary["maps"][0].get("posterior_bound_m").is_some();
    assert_eq!([bound(&none), bound(&some), bound(&much)], [true, false, false]);
    // Exact odometry is not recorded, because it is the truth.
    let topic = "/robot/surveyor/odometry";
    assert_eq!(messages::<PoseInFrame>(&none.recording, topic).len(), 0);
    // The network and the path are those of trajectory-s.
    let plain = run("ml-tm/trajectory-s.toml", &[]);
    assert_eq!(read_log(&none.recording).expect("a log").logs, read_log(&plain.recording).expect("a log").logs);
}

#[test]
fn what_a_robot_hears_while_it_drives_is_mapped() {
    let standing = run("smoke.toml", &["robots.0.listen_s=0.5"]);
    let driving = run("smoke.toml", &["robots.0.listen_s=0.5", "robots.0.listen_while_driving=true"]);
    let count = |run: &Run, key: &str| run.summary["gathering"][key].as_u64().expect("a count");
    // Most drives are 1 m long: two slots of half a second beside each stop.
    let (stops, more) = (count(&standing, "stops"), count(&driving, "stops"));
    assert!(more > 2 * stops && more <= 4 * stops, "{stops} and {more} stops");
    assert!(count(&driving, "packets_received") > 2 * count(&standing, "packets_received"));
    let duration = |run: &Run| run.summary["gathering"]["duration_s"].as_f64().expect("a duration");
    assert!((duration(&driving) - duration(&standing)).abs() < 1e-9);
    assert!(mean_error_m(&driving) < mean_error_m(&standing));
    assert!(driving.summary["maps"][0].get("posterior_bound_m").is_none());
    let json = driving.folder.path().join("map.json");
    let output =
        sextant().arg("map").arg(&driving.recording).arg("--summary").arg(&json).output().expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let of_map = summary(&json);
    assert_eq!(of_map["gathering"]["stops"].as_u64(), Some(more));
    assert_eq!(of_map["maps"][0]["position_error_m"], driving.summary["maps"][0]["position_error_m"]);
}
