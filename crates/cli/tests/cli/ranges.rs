//! Measured ranges: maps of them, paths that they correct, and tracks of tags.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fmt::Write;
use std::process::Output;

use serde_json::Value;
use tempfile::TempDir;

use super::program::{Said, call, folder, sets, sextant, unwrapped};

const NODES: &str = "node,x_m,y_m\nA,4,5\nB,16,3\nC,10,13\nD,-3,9\n";
const PLACES: [(&str, [f64; 2]); 4] =
    [("A", [4.0, 5.0]), ("B", [16.0, 3.0]), ("C", [10.0, 13.0]), ("D", [-3.0, 9.0])];

/// Error of a range (m): of a fixed series that looks like noise.
fn noise(number: usize) -> f64 {
    0.2 * (((number * 7919) % 1000) as f64 / 1000.0 - 0.5)
}

/// The tables of a drive through lanes, with ranges 0.5 m too long: `path.csv` as odometry has it, whose heading drifts by so much,
/// and the true one.
fn drive(lanes: u32, drift_rad_per_m: f64) -> [String; 3] {
    let mut path = "t_s,x_m,y_m\n".to_owned();
    let (mut truth, mut ranges) = (path.clone(), "t_s,node,range_mm\n".to_owned());
    let (mut true_place, mut believed, mut turn) = ([0.0_f64, 0.0], [0.0_f64, 0.0], 0.0_f64);
    let mut step = 0_usize;
    for lane in 0..lanes {
        let along = if lane % 2 == 0 { [0.5, 0.0] } else { [-0.5, 0.0] };
        let legs = std::iter::repeat_n(along, 28).chain(std::iter::repeat_n([0.0, 0.5], 6));
        for [x, y] in legs {
            let (sin, cos) = turn.sin_cos();
            true_place = [true_place[0] + x, true_place[1] + y];
            believed = [believed[0] + cos * x - sin * y, believed[1] + sin * x + cos * y];
            turn += 0.5 * drift_rad_per_m;
            step += 1;
            let t_s = 0.5 * step as f64;
            writeln!(path, "{t_s},{},{}", believed[0], believed[1]).unwrap();
            writeln!(truth, "{t_s},{},{}", true_place[0], true_place[1]).unwrap();
            for (number, (node, place)) in PLACES.iter().enumerate() {
                let distance_m = f64::hypot(place[0] - true_place[0], place[1] - true_place[1]);
                let range_mm = 1000.0 * (distance_m + 0.5 + noise(4 * step + number));
                writeln!(ranges, "{t_s},{node},{range_mm:.0}").unwrap();
            }
        }
    }
    [path, truth, ranges]
}

fn run(folder: &TempDir, arguments: &[&str]) -> Output {
    sextant().arg("map").arg(folder.path()).args(arguments).current_dir(folder.path()).output().unwrap()
}

#[test]
fn a_path_with_ranges_alone_is_mapped_by_default() {
    let [path, _, ranges] = drive(5, 0.0);
    let log = folder(&[("path.csv", &path), ("ranges.csv", &ranges), ("nodes.csv", NODES)]);
    let out = folder(&[]);
    let places = out.path().join("places.csv").display().to_string();
    let summary = run(&log, &["--truth", "nodes.csv", "--out", &places, "--format", "json"]).json();
    let map = &summary["maps"][0];
    assert_eq!((map["algorithm"].as_str(), map["mapped"].as_u64()), (Some("auto"), Some(4)));
    assert!(map["position_error_m"]["max"].as_f64().unwrap() < 0.2, "{map}");
    let law = &map["range_law"];
    assert!((law["bias_m"].as_f64().unwrap() - 0.5).abs() < 4.0 * law["bias_sd_m"].as_f64().unwrap(), "{law}");
    assert!(map["knowledge"].as_array().unwrap().contains(&"robot-ranges".into()), "{map}");
    assert!(std::fs::read_to_string(&places).unwrap().contains("cov_xx_m2"));
    // Names of columns, and the same by the algorithm itself.
    let other = ranges.replace("t_s,node,range_mm", "seconds,anchor,dist");
    std::fs::write(log.path().join("ranges.csv"), other).unwrap();
    let fields = ["--range-fields", "t_s=seconds,node=anchor,range_mm=dist"];
    let same =
        run(&log, &[&fields[..], &["--algorithm", "range-ml", "--truth", "nodes.csv", "--format", "json"]].concat())
            .json();
    assert_eq!(same["maps"][0]["position_error_m"], map["position_error_m"]);
    let refused = run(&log, &["--truth", "nodes.csv"]).refusal();
    assert!(refused.contains("`node`") && refused.contains("--range-fields"), "{refused}");
}

#[test]
fn odometry_is_corrected_by_ranges() {
    let [odometry, _, ranges] = drive(2, 0.012);
    let log = folder(&[("odometry.csv", &odometry), ("ranges.csv", &ranges), ("nodes.csv", NODES)]);
    let error = |output: &Output| output.json()["maps"][0]["position_error_m"]["mean"].as_f64().unwrap();
    let as_believed = run(&log, &["--truth", "nodes.csv", "--format", "json"]);
    let believed_m = error(&as_believed);
    let out = folder(&[]);
    let [tum, csv] = ["path.tum", "path.csv"].map(|name| out.path().join(name).display().to_string());
    let arguments = ["--estimate-path", "--path-out", &tum, "--truth", "nodes.csv", "--format", "json"];
    let corrected = run(&log, &arguments);
    assert!(error(&corrected) < 0.3 * believed_m, "{} of {believed_m} m", error(&corrected));
    // What corrects odometry is told where it was not done.
    let told = "odometry.csv is the path, and odometry drifts: `sextant map` with `--estimate-path` corrects it";
    let notes = |output: &Output| output.json()["notes"].to_string();
    assert!(
        notes(&as_believed).contains(told) && !notes(&corrected).contains("and odometry drifts"),
        "{}",
        notes(&corrected)
    );
    for words in [&["inspect"][..], &["report", "--algorithm", "range-ml"]] {
        let output = sextant().args(words).arg(log.path()).current_dir(out.path()).output().unwrap();
        let (_, printed, message) = output.all();
        let all = unwrapped(&(printed + &message));
        assert!(all.contains(told), "{words:?}: {all}");
    }
    let path = &corrected.json()["path"];
    assert_eq!((path["moved"].as_bool(), path["frame"].as_str()), (Some(true), Some("first-pose")));
    let tum = std::fs::read_to_string(&tum).unwrap();
    assert!(tum.lines().nth(1).unwrap().split(' ').count() == 8, "{tum}");
    // CSV is read as a path again.
    assert!(run(&log, &["--estimate-path", "--path-out", &csv]).status.success());
    assert!(
        (error(&run(&log, &["--path", &csv, "--truth", "nodes.csv", "--format", "json"])) - error(&corrected)).abs()
            < 0.1
    );

    let [path, _, ranges] = drive(2, 0.0);
    let right = folder(&[("path.csv", &path), ("ranges.csv", &ranges)]);
    for (arguments, problem) in [
        (&["--estimate-path", "--path-error", "scale=9"][..], "allowed: KEY=NUMBER from 0 to 1"),
        (&["--path-out", "a.csv"], "--estimate-path"),
        (&["--estimate-path", "--path-out", "path.csv"], "an output never replaces an input"),
        (&["--estimate-path", "--tiles", "2"], "tile by tile"),
    ] {
        let refused = run(&right, arguments).refusal();
        assert!(refused.contains(problem), "{refused}");
    }
}

#[test]
fn a_tag_is_tracked_among_receivers() {
    let [_, truth, ranges] = drive(5, 0.0);
    let log = folder(&[("ranges.csv", &ranges), ("nodes.csv", NODES), ("truth.csv", &truth)]);
    let known = ["--track", "--known", "nodes.csv"];
    let place = folder(&[]);
    let out = place.path().join("track.csv").display().to_string();
    let arguments = [&known[..], &["--truth", "truth.csv", "--out", &out, "--format", "json"]].concat();
    let summary = run(&log, &arguments).json();
    let track = &summary["tracks"][0];
    assert!(track["position_rmse_m"].as_f64().unwrap() < 0.35, "{track}");
    assert!(track["in_region_95"].as_f64().unwrap() > 0.8, "{track}");
    let table = std::fs::read_to_string(&out).unwrap();
    assert!(table.starts_with("t_s,tag,x_m,y_m,z_m,cov_xx_m2,"));
    assert!(run(&log, &arguments).status.success(), "a track of ours may be replaced");
    let text = run(&log, &[&known[..], &["--truth", "truth.csv"]].concat());
    assert!(String::from_utf8_lossy(&text.stdout).contains("within the 95 % regions"), "{text:?}");
    // Two names in each other's row are told.
    std::fs::write(log.path().join("swapped.csv"), "node,x_m,y_m\nA,4,5\nC,16,3\nB,10,13\nD,-3,9\n").unwrap();
    let swapped = ["--track", "--known", "swapped.csv"];
    let track = run(&log, &[&swapped[..], &["--format", "json"]].concat()).json()["tracks"][0].clone();
    assert_eq!(track["exchanged"][0], serde_json::json!(["B", "C"]), "{track}");
    let text = run(&log, &swapped).printed();
    assert!(text.contains("warning: the ranges fit clearly better with `B` and `C`"), "{text}");
    std::fs::write(log.path().join("two.csv"), "node,x_m,y_m\nA,4,5\nB,16,3\n").unwrap();
    let refused = run(&log, &["--track", "--known", "two.csv"]).refusal();
    assert!(refused.contains("at least 3 receivers at known places, but there are those of 2"), "{refused}");
    let refused = run(&log, &["--track"]).refusal();
    assert!(refused.contains("--known"), "{refused}");
    std::fs::write(log.path().join("other.csv"), "node,x_m,y_m\nX,4,5\n").unwrap();
    let refused = run(&log, &["--track", "--known", "other.csv"]).refusal();
    assert!(refused.contains("no strength of a receiver with a known place"), "{refused}");
}

#[test]
fn a_scenario_says_that_a_map_is_on_the_estimated_path() {
    let scenario = super::program::scenario("ml-tm/odometry-drift.toml");
    let run = |more: &[&str]| {
        let small = [
            "robots.0.odometry.heading_drift_rad_per_m=0.01",
            "world.nodes.random.count=8",
            "world.nodes.random.region.rectangle.max_m=[10.0, 3.0]",
            "robots.0.controller.s_path.region.rectangle.max_m=[10.0, 3.0]",
        ];
        let set = small.into_iter().flat_map(|setting| ["--set", setting]);
        sextant()
            .arg("run")
            .arg(&scenario)
            .args(set)
            .args(["--format", "json", "--quiet"])
            .args(more)
            .output()
            .unwrap()
    };
    let estimated = run(&["--set", "maps.0.path=\"estimated\""]);
    assert_eq!(estimated.json()["maps"][0]["path"]["evidence"], "packets");
    for (set, problem) in [
        ("maps.0.path_error.scale=0.1", "path_error"),
        ("maps.0.algorithm={range_ml={}}", "robots measure no ranges"),
        ("maps.0.path=\"guessed\"", "believed"),
    ] {
        let refused = run(&["--set", set]).refusal();
        assert!(refused.contains(problem), "{refused}");
    }
}

/// The path of a robot through lanes with its heading (degrees), and ranges from two antennas on it: 1.5 m ahead, and 1 m to the left
/// and behind.
fn drive_with_antennas() -> [String; 3] {
    let arms = [("front", [1.5, 0.0]), ("back", [-0.5, 1.0])];
    let mut path = "t_s,x_m,y_m,heading_deg\n".to_owned();
    let mut ranges = "t_s,tag,node,range_m\n".to_owned();
    let mut tags = "tag,x_m,y_m\n".to_owned();
    arms.iter().for_each(|(tag, [x, y])| writeln!(tags, "{tag},{x},{y}").unwrap());
    let (mut place, mut step) = ([0.0_f64, 0.0], 0_usize);
    for lane in 0..5 {
        let along = if lane % 2 == 0 { 0.0 } else { 180.0 };
        for heading_deg in std::iter::repeat_n(along, 28).chain(std::iter::repeat_n(90.0, 6)) {
            let (sin, cos) = f64::to_radians(heading_deg).sin_cos();
            place = [place[0] + 0.5 * cos, place[1] + 0.5 * sin];
            step += 1;
            let t_s = 0.5 * step as f64;
            writeln!(path, "{t_s},{},{},{heading_deg}", place[0], place[1]).unwrap();
            let (tag, [x, y]) = arms[step % 2];
            let antenna = [place[0] + cos * x - sin * y, place[1] + sin * x + cos * y];
            for (node, at) in PLACES {
                let distance_m = f64::hypot(at[0] - antenna[0], at[1] - antenna[1]);
                writeln!(ranges, "{t_s},{tag},{node},{:.4}", distance_m + 0.05 * noise(step)).unwrap();
            }
        }
    }
    [path, ranges, tags]
}

#[test]
fn ranges_were_measured_where_the_antennas_are_on_the_robot() {
    let [path, ranges, tags] = drive_with_antennas();
    let error = |output: &Output| output.json()["maps"][0]["position_error_m"]["mean"].as_f64().unwrap();
    let arguments = ["--truth", "nodes.csv", "--algorithm", "range-ml", "--format", "json"];
    let log = folder(&[("path.csv", &path), ("ranges.csv", &ranges), ("tags.csv", &tags), ("nodes.csv", NODES)]);
    let with_arms_m = error(&run(&log, &arguments));
    let bare = folder(&[("path.csv", &path), ("ranges.csv", &ranges), ("nodes.csv", NODES)]);
    let without_m = error(&run(&bare, &arguments));
    assert!(with_arms_m < 0.03 && without_m > 4.0 * with_arms_m, "{with_arms_m} {without_m}");
    // The robot is tracked by the same, in the frame of the nodes, from odometry in a frame of its own.
    let odometry: String = std::iter::once("t_s,x_m,y_m,heading_deg\n".to_owned())
        .chain(path.lines().skip(1).map(|row| {
            let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap()).collect();
            format!("{},{},{},{}\n", cells[0], -cells[2], cells[1], cells[3] + 90.0)
        }))
        .collect();
    let truth: String = path.lines().map(|row| row.rsplit_once(',').unwrap().0.to_owned() + "\n").collect();
    let parts = [("odometry.csv", &*odometry), ("ranges.csv", &*ranges), ("tags.csv", &*tags)];
    let tracked = folder(&[&parts[..], &[("nodes.csv", NODES), ("truth.csv", &truth)]].concat());
    let words = ["--track", "--known", "nodes.csv", "--truth", "truth.csv", "--format", "json"];
    let track = run(&tracked, &words).json()["tracks"][0].clone();
    assert!(track["position_rmse_m"].as_f64().unwrap() < 0.15, "{track}");
    assert_eq!(track["tag"], "robot");
    assert!(track["odometry_scale"].is_number() && track.get("acceleration_m2_per_s3").is_none(), "{track}");

    let refused = |file: &str, text: &str, problem: &str| {
        std::fs::write(log.path().join(file), text).unwrap();
        let refused = run(&log, &arguments).refusal();
        assert!(refused.contains(problem), "{refused}");
    };
    refused("tags.csv", "tag,x_m,y_m\nfront,1,0\nfront,2,0\n", "each tag once");
    refused("tags.csv", "tag,x_m,y_m\nfront,1,0\nside,2,0\n", "a tag of tags.csv: front, side");
    refused("tags.csv", "tag,x_m,y_m\nfront,1,far\n", "tags.csv");
    std::fs::write(log.path().join("tags.csv"), &tags).unwrap();
    refused("path.csv", &path.replace("heading_deg", "speed"), "column `heading_rad` is missing");
    std::fs::remove_file(tracked.path().join("odometry.csv")).unwrap();
    let refused = run(&tracked, &words).refusal();
    assert!(refused.contains("tags.csv") && refused.contains("beside odometry.csv"), "{refused}");
}

#[test]
fn strengths_track_a_tag_and_a_side_is_for_receivers_on_a_line() {
    let mut packets = "t_s,receiver,node,rssi_dbm\n".to_owned();
    let mut truth = "t_s,x_m,y_m\n".to_owned();
    for step in 0..120_usize {
        let t_s = 0.5 * step as f64;
        let place = [6.0 + 5.0 * (0.1 * t_s).cos(), 7.0 + 3.0 * (0.1 * t_s).sin()];
        writeln!(truth, "{t_s},{},{}", place[0], place[1]).unwrap();
        for (number, (node, at)) in PLACES.iter().enumerate() {
            let distance_m = f64::hypot(at[0] - place[0], at[1] - place[1]);
            let rssi_dbm = -42.0 - 24.0 * distance_m.log10() + 10.0 * noise(4 * step + number);
            writeln!(packets, "{t_s},{node},badge,{rssi_dbm:.1}").unwrap();
        }
    }
    let log = folder(&[("packets.csv", &packets), ("nodes.csv", NODES), ("truth.csv", &truth)]);
    let words = ["--track", "--known", "nodes.csv", "--truth", "truth.csv", "--format", "json"];
    let track = run(&log, &words).json()["tracks"][0].clone();
    assert_eq!((&track["tag"], &track["ranges"]), (&Value::from("badge"), &Value::from(0)));
    assert!(track["position_rmse_m"].as_f64().unwrap() < 1.0 && track.get("noise_m").is_none(), "{track}");
    assert_eq!(run(&log, &[&words[..], &["--reciprocal"]].concat()).json()["tracks"][0], track);
    for (more, problem) in [
        (&["--side", "1,2"][..], "straight line"),
        (&["--side", "left"], "two numbers of metres, X,Y"),
        (&["--reciprocal", "--transmitter", "other"], "no range and no strength"),
        (&["--stop-every", "1m"], "is for logs of packets and a path"),
    ] {
        let told = run(&log, &[&words[..], more].concat()).refusal();
        assert!(told.contains(problem), "{told}");
    }
    let row = "node,x_m,y_m\nA,0,0\nB,8,0\nC,16,0\nD,24,0\n";
    std::fs::write(log.path().join("row.csv"), row).unwrap();
    let told = run(&log, &["--track", "--known", "row.csv"]).printed();
    assert!(told.contains("mirror image"), "{told}");
}

#[test]
fn a_run_whose_robot_measured_nothing_is_recorded_and_says_that_it_has_no_map() {
    let folder = tempfile::tempdir().unwrap();
    let run = |words: &[&str]| call(folder.path(), words);
    run(&["init", "ranges"]);
    let silent = ["--set", "radio.tx_power_dbm=-100.0", "--out", "run.mcap", "--format", "json", "--quiet"];
    let map = run(&[&["run", "ranges.toml"], &silent[..]].concat()).json()["maps"][0].clone();
    assert!(map["mapped"] == 0 && map["unmapped"] == 16, "{map}");
    assert!(map["not_made"].as_str().unwrap().contains("needs measured ranges"), "{map}");
    assert!(map["judgement"].to_string().contains("no map was made"), "{map}");
    assert!(run(&["inspect", "run.mcap"]).status.success());
}

#[test]
fn ranges_that_cannot_be_are_refused_where_they_are_written() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |set: &[&str]| {
        let words: Vec<&str> = ["check", "ranges.toml"].into_iter().chain(sets(set)).collect();
        call(folder.path(), &words).refusal()
    };
    call(folder.path(), &["init", "ranges"]);
    assert!(refused(&["ranging.noise_m=-1"]).contains("`ranging.noise_m` is -1; allowed: a number from 0 to 1000"));
    assert!(refused(&["ranging.exchange={ideal={interval_s=0}}"]).contains("ranging.exchange.ideal.interval_s"));
    assert!(refused(&["ranging.bias=1"]).contains("did you mean `bias_m`?"));
    // Nothing of a recording is of a receiver at a known place.
    call(folder.path(), &["init", "survey"]);
    call(folder.path(), &["run", "survey.toml", "--quiet"]);
    std::fs::write(folder.path().join("known.csv"), NODES).unwrap();
    let words = ["map", "survey.mcap", "--track", "--known", "known.csv"];
    let problem = call(folder.path(), &words).refusal();
    assert!(problem.contains("no strength to a node with a known place"), "{problem}");
}
