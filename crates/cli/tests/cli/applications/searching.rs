//! Searches for targets.

use std::fs;

use sextant_recording::read_world;

use super::{AGENT, NODES, topics};
use crate::program::{Said, call, number, run_text, sextant, table};

const TARGET: &str = r#"
[[world.targets]]
name = "hare"
motion.waypoints = { places_m = [[1.0, 1.0], [7.0, 1.5], [7.0, 6.5], [1.5, 6.5]], speed_m_per_s = 0.4 }
[sensors.targets]
radius_m = 1.5
[[sinks]]
name = "gate"
position_m = [0.5, 0.5]
"#;

const SEARCHES: &str = r#"
[[applications]]
map.physical = {}
duration_s = 90.0
algorithm.detarsk = {}
[[applications]]
map.physical = {}
duration_s = 90.0
algorithm.p_g = {}
"#;

/// A robot with 1 m/s at the other end of the world.
fn hunter() -> String {
    let hunter = AGENT.replace("\"agent\"\nrole", "\"hunter\"\nrole").replace("[1.0, 2.0]", "[7.0, 7.0]");
    hunter.replace("speed_m_per_s = 0.5", "speed_m_per_s = 1.0")
}

fn searching() -> String {
    [NODES, TARGET, &hunter(), SEARCHES].concat()
}

#[test]
fn robots_capture_a_target_and_the_recording_tells_where() {
    let (folder, summary) = run_text(&searching(), &[]);
    let drawn = read_world(&folder.path().join("run.mcap")).unwrap();
    for (i, name) in ["detarsk", "p-g"].into_iter().enumerate() {
        let application = &summary["applications"][i];
        assert_eq!((&application["name"], &application["captured"]), (&name.into(), &true.into()), "{application}");
        let target = &application["targets"][0];
        assert_eq!((&target["name"], &target["robot"]), (&"hare".into(), &"hunter".into()));
        let time_s = number(&application["time_s"]);
        assert!((number(&target["captured_s"]) - time_s).abs() < 1e-12 && time_s > 5.0);
        assert_eq!(application["robots"][0]["captures"], 1);
        assert!(number(&application["prediction_error_m"]["mean"]) >= 0.0);
        assert!(number(&application["messages"]["requests"]) > 0.0 && application["arrived"].is_null());
        let drawn = &drawn.applications[i];
        let capture = &drawn.captures[0];
        assert!(((capture.time - drawn.start).as_secs_f64() - time_s).abs() < 1e-6);
        // The robot touched it: both ways end within a metre of each other, and of where the capture was.
        let (_, path) = &drawn.paths[0];
        let way = &drawn.targets[0].way;
        assert!(path.last().unwrap().distance_m(capture.place) <= 1.0 + 1e-6, "{name}");
        assert!(way.at(capture.time).unwrap().distance_m(capture.place) < 1e-6, "{name}");
        // Each search has the target where it starts.
        assert!(way.points()[0].1.distance_m([1.0, 1.0, 0.0].into()) < 1e-9);
        // The distance to the target, as recorded, is that of the two ways.
        let (_, distances) = drawn.series_of("distance_to_target_m").next().unwrap();
        let start_m = ((7.0 - 1.0_f64).powi(2) * 2.0).sqrt();
        assert!((distances[0].1 - start_m).abs() < 1e-9 && distances.last().unwrap().1 <= 1.0 + 1e-6);
    }
    let topics = topics(&folder);
    assert_eq!((topics["/application/detarsk/captures"], topics["/application/p-g/captures"]), (1, 1));
}

#[test]
fn the_table_of_a_sweep_has_the_course_of_each_search() {
    let scenario = searching() + "\n[sweep]\nruns = 2\n";
    let (folder, summary) = run_text(&scenario, &[]);
    let swept = |arguments: &[&str]| {
        let words = ["sweep", "a.toml", "--out", "t.csv", "--quiet"];
        sextant().current_dir(folder.path()).args(words).args(arguments).output().unwrap().printed()
    };
    // Of two runs that both captured, the low end of the share is the square root of 0.025.
    assert!(swept(&[]).contains("100 % (16 to 100 %)"));
    let results: serde_json::Value = serde_json::from_str(&swept(&["--resume", "--format", "json"])).unwrap();
    let measures = results["sweep"]["cells"][0]["measures"].as_object().unwrap();
    let (_, captured) = measures.iter().find(|(name, _)| *name == "applications.detarsk.captured").unwrap();
    assert!((number(&captured["interval_95"][0]) - 0.025_f64.sqrt()).abs() < 1e-6, "{captured}");
    assert_eq!((&captured["interval_95"][1], captured.get("half_width_95")), (&1.0.into(), None));
    let rows = table(&folder.path().join("t.csv"));
    let value = |name: &str| rows[0].get(&format!("applications.{name}"))?.parse::<f64>().ok();
    let drawn = read_world(&folder.path().join("run.mcap")).unwrap();
    for (i, name) in ["detarsk", "p-g"].into_iter().enumerate() {
        let captured_s = number(&summary["applications"][i]["time_s"]);
        let drawn = &drawn.applications[i];
        let series = |what: &str| -> Vec<(f64, f64)> {
            let (_, series) = drawn.series_of(what).next().unwrap();
            series.iter().map(|&(time, value)| ((time - drawn.start).as_secs_f64(), value)).collect()
        };
        let (distances_m, errors_m) = (series("distance_to_target_m"), series("prediction_error_m"));
        let mut compared = 0;
        for time_s in (4..=84).step_by(4).map(f64::from) {
            let distance_m = value(&format!("{name}.distance_to_target_m.at_{time_s}_s"));
            let recorded = distances_m.iter().find(|(at_s, _)| (at_s - time_s).abs() < 1e-9);
            let expected_m = if time_s >= captured_s { 0.0 } else { recorded.unwrap().1 };
            assert!((distance_m.unwrap() - expected_m).abs() < 1e-9, "{name} at {time_s} s: {distance_m:?}");
            let since = errors_m.iter().filter(|(at_s, _)| time_s - 4.0 + 1e-9 < *at_s && *at_s <= time_s + 1e-9);
            let since: Vec<f64> = since.map(|&(_, error_m)| error_m).collect();
            let error_m = value(&format!("{name}.prediction_error_m.at_{time_s}_s"));
            assert_eq!(error_m.is_some(), !since.is_empty(), "{name} at {time_s} s: {error_m:?}");
            if let Some(error_m) = error_m {
                let mean_m = since.iter().sum::<f64>() / since.len() as f64;
                assert!((error_m - mean_m).abs() < 1e-9, "{name} at {time_s} s: {error_m}");
                compared += 1;
            }
        }
        assert!(compared > 0, "{name} predicts");
    }
}

#[test]
fn figures_show_ways_and_the_capture() {
    let (folder, _) = run_text(&searching(), &[]);
    call(folder.path(), &["figure", "run.mcap", "--out", "f"]).printed();
    let figure = |name: &str| fs::read_to_string(folder.path().join("f").join(name)).unwrap();
    let picture = figure("application-detarsk.svg");
    for text in ["way of hare", "path of hunter", "capture", "1 of 1 target captured"] {
        assert!(picture.contains(text), "{text}");
    }
    assert!(figure("application-detarsk-prediction-error.svg").contains("prediction of targets"));
    assert!(figure("application-p-g-distance.svg").contains("nearest target"));
}

#[test]
fn a_search_with_false_alarms_captures_and_counts_them() {
    let errors = "radius_m = 1.5\nmiss_probability = 0.2\nfalse_alarms_per_h = 120.0\n";
    let trusted = "[[applications]]\nname = \"trusted\"\nmap.physical = {}\nduration_s = 90.0\n\
        algorithm.detarsk = { detections = \"trusted\" }\n";
    let scenario = [&searching().replace("radius_m = 1.5\n", errors), trusted].concat();
    let (folder, summary) = run_text(&scenario, &[]);
    let [doubted, _, trusted] = [0, 1, 2].map(|i| &summary["applications"][i]);
    assert_eq!((&doubted["captured"], &trusted["name"]), (&true.into(), &"trusted".into()));
    let mut said = 0.0;
    for application in summary["applications"].as_array().unwrap() {
        let (false_ones, missed) = (&application["false_detections"], &application["missed_detections"]);
        assert!(number(false_ones) > 5.0 && number(missed) > 0.0, "{application}");
        said += number(false_ones);
    }
    // The recording has what nodes said, true or not.
    assert!(topics(&folder)["/sensed"] as f64 > said);
    let table = String::from_utf8(call(folder.path(), &["run", "a.toml", "--force"]).stdout);
    assert!(table.unwrap().contains("missed and"));
}

#[test]
fn a_search_with_doubts_needs_sensors_that_raise_false_alarms() {
    let scenario = searching().replace("detarsk = {}", "detarsk.detections = \"doubted\"");
    let said = super::refusals::refused(&scenario, None);
    let key = "`applications[0].algorithm.detarsk.detections` is `doubted`, without false alarms";
    assert!(said.contains(key) && said.contains("false_alarms_per_h"), "{said}");
}

#[test]
fn a_robot_on_patrol_captures_a_target_that_no_node_detects() {
    // The sensors miss nearly all; the target stands beside a lane.
    let hidden = searching()
        .replace("radius_m = 1.5\n", "radius_m = 1.5\nmiss_probability = 0.9999999\n")
        .replace("[[1.0, 1.0], [7.0, 1.5], [7.0, 6.5], [1.5, 6.5]]", "[[4.0, 3.6]]");
    let rule = |rule: &str| hidden.replace("detarsk = {}", &format!("detarsk.before_detection = \"{rule}\""));
    let captured = |rule_name: &str| run_text(&rule(rule_name), &[]).1["applications"][0]["captured"].clone();
    assert_eq!([captured("wait"), captured("patrol")], [false, true]);
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let bytes =
        |threads| fs::read(run_text(&searching(), &["--threads", threads]).0.path().join("run.mcap")).unwrap();
    assert!(bytes("1") == bytes("2"));
}

#[test]
fn a_sink_in_an_obstacle_is_there_for_a_search() {
    let around = "[[world.obstacles]]\nmaterial = \"concrete\"\n\
                  shape.box = { center_m = [0.5, 0.5, 0.0], size_m = [0.6, 0.6, 2.0] }\n";
    let said = super::refusals::refused(&[&searching(), around].concat(), None);
    assert!(said.contains("`sinks[0].position_m`") && !said.contains("without a sink"), "{said}");
}

#[test]
fn slower_robots_targets_elsewhere_and_missing_sinks_are_refused() {
    let good = searching();
    let slow = good.replace("speed_m_per_s = 1.0", "speed_m_per_s = 0.3");
    let two = good.split("[[applications]]").collect::<Vec<_>>();
    let alone = [two[0], "[[applications]]", two[1]].concat();
    for (scenario, key, allowed) in [
        (
            slow.clone(),
            "`applications[0].robots` is `hunter` with 0.3 m/s, slower than the target `hare` with 0.4 m/s",
            "`allow_slower = true`",
        ),
        (
            alone.replace("[[sinks]]\nname = \"gate\"\nposition_m = [0.5, 0.5]\n", ""),
            "`applications[0].algorithm` is `detarsk`, without a sink",
            "[[sinks]]",
        ),
        (
            alone.replace(
                "places_m = [[1.0, 1.0], [7.0, 1.5], [7.0, 6.5], [1.5, 6.5]]",
                "places_m = [[30.0, 1.0], [40.0, 1.0]]",
            ),
            "target `hare`, whose way is outside the world",
            "within 1.5 m",
        ),
        (
            alone.replace("[sensors.targets]\nradius_m = 1.5\n", ""),
            "`applications[0].algorithm` is `detarsk`, without sensors of targets",
            "[sensors.targets]",
        ),
        (
            [NODES, &hunter(), "[[applications]]", two[1]].concat(),
            "`applications[0].algorithm` is `detarsk`, without targets",
            "[[world.targets]]",
        ),
        (
            alone.replace("detarsk = {}", "detarsk.capture_m = 0.0"),
            "`applications[0].algorithm.detarsk.capture_m` is 0",
            "",
        ),
    ] {
        let said = super::refusals::refused(&scenario, None);
        assert!(said.contains(key) && said.contains(allowed), "{key}: {said}");
    }
    let allowed = slow.replace("duration_s = 90.0", "duration_s = 8.0\nallow_slower = true");
    let (_folder, summary) = run_text(&allowed, &[]);
    assert!((number(&summary["applications"][0]["sim_time_s"]) - 8.0).abs() < 1e-9, "nobody is that fast");
}

#[test]
fn a_target_that_nobody_meets_is_not_captured() {
    let short = searching().replace("duration_s = 90.0", "duration_s = 6.0");
    let (folder, summary) = run_text(&short, &[]);
    let application = &summary["applications"][0];
    assert_eq!(application["captured"], false);
    assert!(application["time_s"].is_null() && application["targets"][0]["captured_s"].is_null());
    assert!((number(&application["sim_time_s"]) - 6.0).abs() < 1e-9);
    assert!(!topics(&folder).contains_key("/application/detarsk/captures"));
}
