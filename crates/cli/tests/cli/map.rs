//! `sextant map` on the log of a real robot: a folder of CSV files.

use std::fmt::Write as _;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::program::{Said, call};

const PROFILE: &str = "p0=0.9,plateau_m=1,range_m=3";

/// A survey of four nodes by a robot on three lanes. Each node is at most 2 m from a lane, and is heard exactly at the
/// stops within 2 m.
fn survey() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("there is room");
    let nodes = [("a", 1.0, 1.0), ("b", 5.0, 1.0), ("c", 2.0, 4.0), ("d", 6.0, 4.0)];
    let (mut stops, mut receptions) = ("stop,t_s,x_m,y_m\n".to_owned(), "node,stop,received,sent\n".to_owned());
    let mut stop = 0;
    for lane in 0..3 {
        for step in 0..9 {
            let (x_m, y_m) = (f64::from(step), 2.5 * f64::from(lane));
            writeln!(stops, "{stop},{stop},{x_m},{y_m}").expect("a string grows");
            for (name, node_x_m, node_y_m) in nodes {
                if f64::hypot(x_m - node_x_m, y_m - node_y_m) <= 2.0 {
                    writeln!(receptions, "{name},{stop},1,1").expect("a string grows");
                }
            }
            stop += 1;
        }
    }
    let mut truth = "node,x_m,y_m,z_m\n".to_owned();
    for (name, x_m, y_m) in nodes {
        writeln!(truth, "{name},{x_m},{y_m},0").expect("a string grows");
    }
    std::fs::create_dir(folder.path().join("log")).expect("there is room");
    for (name, text) in [("log/stops.csv", stops), ("log/receptions.csv", receptions), ("nodes.csv", truth)] {
        std::fs::write(folder.path().join(name), text).expect("there is room");
    }
    folder
}

/// Runs `sextant map log WORDS` in `folder`; returns exit code, standard output and standard error.
fn map(folder: &Path, words: &[&str]) -> Output {
    call(folder, &[&["map", "log"], words].concat())
}

fn json(folder: &Path, words: &[&str]) -> Value {
    let words = [&["--profile", PROFILE, "--format", "json"], words].concat();
    let mut summary = map(folder, &words).json();
    summary.as_object_mut().expect("it is one object").remove("timing").expect("it has timing");
    summary
}

#[test]
fn a_map_of_a_log_is_close_to_the_truth() {
    let folder = survey();
    let summary = json(folder.path(), &["--truth", "nodes.csv", "--summary", "summary.json"]);
    let map = &summary["maps"][0];
    assert_eq!((&map["algorithm"], &map["mapped"], &map["unmapped"]), (&"ml-tm".into(), &4.into(), &0.into()));
    let mean_m = map["position_error_m"]["mean"].as_f64().unwrap();
    assert!(mean_m < 0.6, "{map:#}");
    assert_eq!(summary["gathering"]["stops"], 27);
    // Three lanes of 8 m, and two drives to the start of the next lane.
    let length_m = summary["gathering"]["path_length_m"].as_f64().unwrap();
    assert!((length_m - (24.0 + 2.0 * f64::hypot(8.0, 2.5))).abs() < 1e-9, "{length_m}");
    let written = std::fs::read_to_string(folder.path().join("summary.json")).unwrap();
    let mut written: Value = serde_json::from_str(&written).unwrap();
    written.as_object_mut().unwrap().remove("timing");
    assert_eq!(written, summary);
}

#[test]
fn a_log_is_mapped_by_the_estimator_that_it_chooses() {
    let folder = survey();
    let summary = map(folder.path(), &["--truth", "nodes.csv", "--format", "json"]).json();
    let mapped = &summary["maps"][0];
    assert_eq!((&mapped["mapped"], &mapped["algorithm"]), (&4.into(), &"auto".into()));
    assert!(mapped["position_error_m"]["mean"].as_f64().unwrap() < 0.8, "{mapped:#}");
    let scores = mapped["scores"].as_array().unwrap();
    assert!(scores.iter().any(|score| score["estimator"] == mapped["chosen"]), "{mapped:#}");
    assert!(scores.iter().all(|score| score["log_probability"].as_f64().unwrap() < 0.0), "{mapped:#}");
    let text = map(folder.path(), &["--truth", "nodes.csv"]).printed();
    assert!(text.contains("auto: the log chose "), "{text}");
    for algorithm in ["link-model", "packet-centroid"] {
        let summary = map(folder.path(), &["--algorithm", algorithm, "--format", "json"]).json();
        let mapped = &summary["maps"][0];
        assert_eq!((&mapped["mapped"], &mapped["algorithm"]), (&4.into(), &algorithm.into()));
        assert_eq!(mapped["link_law"].is_object(), algorithm == "link-model", "{mapped:#}");
    }
}

#[test]
fn packets_of_two_robots_are_counted_and_the_table_says_how() {
    let folder = survey();
    let stops = std::fs::read_to_string(folder.path().join("log/stops.csv")).unwrap();
    let of_two = |(number, line): (usize, &str)| match number {
        0 => format!("{line},robot\n"),
        1..=13 => format!("{line},west\n"),
        _ => format!("{line},east\n"),
    };
    let summary = json(folder.path(), &[]);
    let packets = &summary["gathering"]["packets_received"];
    assert!(packets.as_u64().unwrap() > 10 && summary["gathering"]["packets_received_by_robots"].is_null());
    let of_two: String = stops.lines().enumerate().map(of_two).collect();
    std::fs::write(folder.path().join("log/stops.csv"), of_two).unwrap();
    let of_two = json(folder.path(), &[]);
    assert!(of_two["gathering"]["packets_received"].is_null());
    assert_eq!(of_two["gathering"]["packets_received_by_robots"], *packets);
    let text = map(folder.path(), &["--profile", PROFILE]).printed();
    let line = text.lines().find(|line| line.starts_with("packets received")).expect("a line");
    assert!(line.contains(&packets.to_string()) && line.contains("counts twice"), "{line}");
}

#[test]
fn baselines_map_a_log_with_strengths_by_name_and_refuse_one_without() {
    let folder = survey();
    let path = folder.path().join("log/receptions.csv");
    let nodes = [("a", 1.0, 1.0), ("b", 5.0, 1.0), ("c", 2.0, 4.0), ("d", 6.0, 4.0)];
    let mut receptions = "node,stop,received,rssi_dbm\n".to_owned();
    for (name, x_m, y_m) in nodes {
        for stop in 0..27 {
            let apart_m = f64::hypot(f64::from(stop % 9) - x_m, 2.5 * f64::from(stop / 9) - y_m);
            writeln!(receptions, "{name},{stop},1,{}", -50.0 - 25.0 * apart_m.log10()).expect("a string grows");
        }
    }
    let names = [("strongest-stop", 1.2), ("rssi-centroid", 1.5), ("least-squares", 0.01), ("gaussian-process", 1.2)];
    for (algorithm, _) in names {
        let words = ["--algorithm", algorithm];
        let (code, _, stderr) = map(folder.path(), &words).all();
        assert!(code == 2 && stderr.contains(algorithm) && stderr.contains("`rssi_dbm`"), "{code}: {stderr}");
    }
    std::fs::write(path, receptions).unwrap();
    for (algorithm, most_m) in names {
        let words = ["--algorithm", algorithm, "--truth", "nodes.csv", "--format", "json"];
        let summary = map(folder.path(), &words).json();
        let mapped = &summary["maps"][0];
        assert_eq!((&mapped["mapped"], &mapped["algorithm"]), (&4.into(), &algorithm.into()));
        assert!(mapped["position_error_m"]["mean"].as_f64().unwrap() < most_m, "{mapped:#}");
        assert_eq!(mapped["knowledge"], serde_json::json!(["robot-rssi"]));
    }
    let set = ["--set", "maps.0.algorithm.rssi_centroid.g=0.5"];
    let (_, text, stderr) = map(folder.path(), &set).all();
    assert!(text.contains("rssi-centroid"), "{text}{stderr}");
    let stderr = map(folder.path(), &["--set", "maps.0.algorithm.rssi_centroid.g=0"]).refusal();
    assert!(stderr.contains("a number above 0, at most 100"), "{stderr}");
}

#[test]
fn a_log_of_an_unknown_channel_is_mapped_with_a_fitted_profile() {
    let folder = survey();
    let words = ["--algorithm", "ml-tm", "--truth", "nodes.csv", "--format", "json"];
    let summary = map(folder.path(), &words).json();
    let mapped = &summary["maps"][0];
    assert_eq!((&mapped["mapped"], &mapped["algorithm"]), (&4.into(), &"ml-tm".into()));
    assert!(mapped["position_error_m"]["mean"].as_f64().unwrap() < 0.6, "{mapped:#}");
    assert!(mapped["coverage_95"].as_f64().unwrap() >= 0.75, "{mapped:#}");
    let profile = &mapped["fitted_profile"];
    assert_eq!(profile["converged"], true, "{profile:#}");
    // Every node was heard up to 2 m.
    assert!((profile["range_m"].as_f64().unwrap() - 2.0).abs() < 0.5, "{profile:#}");
    let text = map(folder.path(), &["--profile", "fitted", "--truth", "nodes.csv"]).printed();
    assert!(text.contains("ml-tm: fitted profile of range") && text.contains("converged in"), "{text}");
    assert!(text.contains("in 95 % region"), "{text}");
}

#[test]
fn a_log_is_mapped_by_the_given_algorithm() {
    let folder = survey();
    let words = ["--algorithm", "self-calibrated", "--truth", "nodes.csv"];
    let summary = map(folder.path(), &[&words[..], &["--format", "json"]].concat()).json();
    let mapped = &summary["maps"][0];
    assert_eq!((&mapped["mapped"], &mapped["algorithm"]), (&4.into(), &"self-calibrated".into()));
    assert!(mapped["position_error_m"]["mean"].as_f64().unwrap() < 0.6, "{mapped:#}");
    let calibration = &mapped["calibration"];
    assert_eq!((&calibration["obstacle_knowledge"], &calibration["converged"]), (&"from_log".into(), &true.into()));
    assert!((calibration["range_m"].as_f64().unwrap() - 2.0).abs() < 0.5, "{calibration:#}");
    let text = map(folder.path(), &words).printed();
    assert!(text.contains("self-calibrated: curve of range"), "{text}");
    assert!(text.contains("no obstacles found from receptions, drives and contacts"), "{text}");
    let stderr = map(folder.path(), &[&words[..], &["--profile", PROFILE]].concat()).refusal();
    assert!(stderr.contains("no map has a reception profile"), "{stderr}");
    let stderr = map(folder.path(), &["--algorithm", "guess"]).refusal();
    assert!(stderr.contains("self-calibrated"), "{stderr}");
}

#[test]
fn a_log_of_a_known_channel_is_mapped_with_its_profile() {
    let folder = survey();
    let profile = "channel:exponent=2,sigma_db=1,tx_power_dbm=-50,sensitivity_dbm=-57";
    let summary = map(folder.path(), &["--profile", profile, "--truth", "nodes.csv", "--format", "json"]).json();
    assert!(summary["maps"][0]["position_error_m"]["mean"].as_f64().unwrap() < 0.6, "{summary:#}");
    assert!(summary["maps"][0].get("fitted_profile").is_none());
}

#[test]
fn without_truth_nothing_is_measured() {
    let folder = survey();
    let summary = json(folder.path(), &[]);
    assert!(summary["maps"][0].get("position_error_m").is_none(), "{summary:#}");
    std::fs::write(folder.path().join("some.csv"), "node,x_m,y_m\na,1,1\n").unwrap();
    let words = ["--profile", PROFILE, "--truth", "some.csv"];
    let (code, _, stderr) = map(folder.path(), &words).all();
    assert_eq!(code, 0);
    assert!(stderr.contains("note: the true positions of 3 of 4 nodes are unknown"), "{stderr}");
    assert_eq!(map(folder.path(), &[&words[..], &["--quiet"]].concat()).all().2, "");
}

#[test]
fn a_map_file_names_every_mapped_node() {
    let folder = survey();
    json(folder.path(), &["--out", "map.csv", "--set", "maps.0.algorithm.ml_tm.grid_step_m=0.5"]);
    let text = std::fs::read_to_string(folder.path().join("map.csv")).unwrap();
    let mut names: Vec<_> = text.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
    names.sort_unstable();
    assert_eq!(names, ["a", "b", "c", "d"]);
    assert!(text.starts_with("node,x_m,y_m,z_m,"), "{text}");
}

#[test]
fn the_number_of_threads_does_not_change_the_results() {
    let folder = survey();
    let with = |threads| json(folder.path(), &["--truth", "nodes.csv", "--threads", threads]);
    assert_eq!(with("1"), with("3"));
}

#[test]
fn bad_input_and_an_output_in_a_missing_folder_exit_with_two() {
    let folder = survey();
    let refused = |words: &[&str], code: i32, message: &str| {
        let (found, stdout, stderr) = map(folder.path(), words).all();
        assert_eq!((found, stdout.as_str()), (code, ""), "{words:?}: {stderr}");
        assert!(stderr.contains(message), "{words:?}: {stderr}");
    };
    let profile = ["--profile", PROFILE];
    let with = |words: &[&'static str]| [&profile[..], words].concat();
    refused(&["--profile", "square"], 2, "unknown choice `square`");
    refused(&["--profile", "channel:sigma_db=8"], 2, "tx_power_dbm` is missing; needed: a number");
    refused(&["--profile", "fitted:max_rounds=0"], 2, "max_rounds` is 0; allowed: 1 or more");
    refused(&["--profile", "p0=2,plateau_m=1,range_m=3"], 2, "p0` is 2; allowed: above 0, at most 1");
    refused(&["--profile", "p0=0.9,plateau=1,range_m=3"], 2, "did you mean `plateau_m`?");
    refused(&with(&["--truth", "none.csv"]), 2, "none.csv");
    refused(&with(&["--set", "maps.0.algorithm.ml_tm.grid_step_m=0"]), 2, "grid_step_m` is 0");
    refused(&with(&["--set", "maps.0.algorithm.ml_tm.grid_step_m=1e-5"]), 2, "allow more with max_memory_mb");
    refused(&with(&["--out", "none/map.csv"]), 2, "none/map.csv` cannot be written: there is no folder `none`");
    refused(&with(&["--summary", "none/summary.json"]), 2, "none/summary.json");
    std::fs::write(folder.path().join("log/receptions.csv"), "node,stop,received\na,0,1\na,zero,1\n").unwrap();
    refused(&with(&[]), 2, "receptions.csv, line 3");
}

#[test]
fn a_log_without_a_scenario_cannot_know_the_obstacles() {
    let folder = survey();
    let profile = "channel:exponent=2,sigma_db=4,tx_power_dbm=-50,sensitivity_dbm=-60,obstacles=\"known\"";
    let stderr = map(folder.path(), &["--profile", profile]).refusal();
    assert!(stderr.contains("obstacles of the world"), "{stderr}");
}

#[test]
fn a_stop_with_an_invalid_position_is_rejected_with_its_line() {
    let folder = survey();
    std::fs::write(folder.path().join("log/stops.csv"), "stop,t_s,x_m,y_m\n0,0,0,0\n1,1,1e308,0\n").expect("room");
    let stderr = map(folder.path(), &[]).refusal();
    assert!(stderr.contains("stops.csv") && stderr.contains("1e308"), "{stderr}");
}

/// Replaces the stops and the receptions of a survey by twelve stops on a circle of radius 4 m with heights `heights_m`.
/// Each stop has `received` of ten packets from each of three nodes.
fn round_survey(folder: &Path, heights_m: impl Fn(u32) -> f64, received: u32) {
    let (mut stops, mut receptions) = ("stop,t_s,x_m,y_m,z_m\n".to_owned(), "node,stop,received,sent\n".to_owned());
    for stop in 0..12 {
        let angle = f64::from(stop) * std::f64::consts::TAU / 12.0;
        let (x_m, y_m) = (4.0 * angle.cos(), 4.0 * angle.sin());
        writeln!(stops, "{stop},{stop},{x_m},{y_m},{}", heights_m(stop)).expect("a string grows");
        for node in ["a", "b", "c"] {
            writeln!(receptions, "{node},{stop},{received},10").expect("a string grows");
        }
    }
    for (name, text) in [("log/stops.csv", stops), ("log/receptions.csv", receptions)] {
        std::fs::write(folder.join(name), text).expect("there is room");
    }
}

#[test]
fn a_map_reports_the_heights_at_which_it_searched_for_nodes() {
    let folder = survey();
    for algorithm in ["ml-tm", "self-calibrated"] {
        let summary = |heights_m: fn(u32) -> f64| {
            round_survey(folder.path(), heights_m, 9);
            let summary = map(folder.path(), &["--algorithm", algorithm, "--format", "json"]).json();
            (summary["maps"][0]["heights"].clone(), map(folder.path(), &["--algorithm", algorithm]).printed())
        };
        let (heights, text) = summary(|_| 1.0);
        assert_eq!(heights, serde_json::json!({"low_m": 1.0, "high_m": 1.0, "from": "stops"}));
        assert!(!text.contains("z_range_m"), "{text}");
        let (heights, text) = summary(|stop| f64::from(stop % 2) * 0.0625);
        assert_eq!(
            heights,
            serde_json::json!({"low_m": 0.03125, "high_m": 0.03125, "from": "stops", "uneven_m": 0.0625})
        );
        assert!(text.contains("plane at 0.03 m, because the heights of the stops differ by only 0.06 m"), "{text}");
        let (heights, text) = summary(|stop| f64::from(stop % 2) * 2.0);
        assert_eq!(heights["from"], "reach");
        assert!(heights["low_m"].as_f64() < Some(0.0) && heights["high_m"].as_f64() > Some(2.0), "{heights}");
        assert!(text.contains(&format!("{algorithm}: nodes searched at heights from -")), "{text}");
    }
}

#[test]
fn a_curve_and_nodes_at_their_bound_are_reported() {
    let folder = survey();
    round_survey(folder.path(), |_| 0.0, 5);
    let words = ["--algorithm", "self-calibrated"];
    let stdout = map(folder.path(), &[&words[..], &["--format", "json"]].concat()).printed();
    let summary: Value = serde_json::from_str(&stdout).expect("JSON");
    let mapped = &summary["maps"][0];
    let calibration = &mapped["calibration"];
    assert_eq!((&calibration["converged"], &calibration["curve_at_bound"]), (&false.into(), &true.into()));
    // All positions agree equally well with the log, also those at the boundary of the search.
    assert_eq!(mapped["at_bound"], serde_json::json!(["a", "b", "c"]), "{mapped:#}");
    let concerns = ["a", "b", "c"].map(|node| serde_json::json!({"node": node, "concern": "no-evidence"}));
    assert_eq!(mapped["concerns"], serde_json::json!(concerns), "{mapped:#}");
    let text = map(folder.path(), &words).printed();
    assert!(
        text.contains("warning: 3 nodes have no place that the evidence prefers") && text.contains(": a, b, c"),
        "{text}"
    );
    assert!(text.contains("did not converge") && text.contains("received at all distances in the log"), "{text}");
}
