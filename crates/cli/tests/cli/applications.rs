//! Applications on maps of the nodes, from a scenario to the summary, the recording, the figures and a sweep.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

mod refusals;
mod searching;

use std::collections::BTreeMap;

use serde_json::Value;
use sextant_kernel::SimTime;
use sextant_recording::{inspect, read_run, read_world};
use tempfile::TempDir;

use crate::program::{Said, call, number, run_text, sextant, table};

/// 36 nodes a metre and a half apart, which always listen.
const NODES: &str = r#"
name = "applied"
seed = 5
[world.nodes.lattice]
spacing_m = 1.5
count = 36
region.rectangle = { min_m = [0.0, 0.0], max_m = [9.0, 9.0] }
[radio]
tx_power_dbm = -30.0
sensitivity_dbm = -90.0
[channel]
environment = "suburban"
path_loss.log_distance.reference_loss_db = 0.0
max_range_m = 5.0
[mac.csma_unslotted]
rx_on_when_idle = true
"#;

const FIELD: &str = r#"
[[world.fields]]
name = "gas"
gaussians = [{ center_m = [6.0, 6.0], peak = 10.0, sigma_m = 4.0 }]
[sensors.fields]
interval_s = 1.0
"#;

const AGENT: &str = r#"
[[robots]]
name = "agent"
role = "agent"
start_m = [1.0, 2.0]
speed_m_per_s = 0.5
"#;

const SEEKING: &str = r#"
[[applications]]
map.physical = {}
duration_s = 60.0
algorithm.gradient = { goal = { level = 9.0 } }
[[applications]]
name = "law"
map.physical = {}
duration_s = 90.0
algorithm.level_set = { goal = { level = 9.0 }, delta = 0.5 }
"#;

/// A robot that surveys, and the map of what it hears.
const SURVEY: &str = r#"
[traffic.beacon]
interval_s = 0.5
[[robots]]
name = "surveyor"
start_m = [0.5, 0.5]
speed_m_per_s = 0.5
controller.waypoints.places_m = [[0.5, 0.5], [8.5, 0.5], [8.5, 3.5], [0.5, 3.5], [0.5, 6.5], [8.5, 6.5], [4.0, 8.0]]
listen_while_driving = true
[[maps]]
name = "heard"
algorithm.ml_tm = { grid_step_m = 0.5, estimate = "posterior_mean", profile.fitted = {} }
"#;

fn seeking() -> String {
    [NODES, FIELD, AGENT, SEEKING].concat()
}

/// Number of messages on each topic of a recording.
fn topics(folder: &TempDir) -> BTreeMap<String, u64> {
    let topics = inspect(&folder.path().join("run.mcap")).unwrap().topics;
    topics.into_iter().map(|topic| (topic.topic, topic.messages)).collect()
}

#[test]
fn nodes_that_die_during_an_application_are_named() {
    let deaths = "[faults.deaths]\nnames = [\"n3\", \"n1\"]\nfrom_s = 1.0\nto_s = 2.0\n";
    let (_folder, summary) = run_text(&[&seeking(), deaths].concat(), &[]);
    for application in summary["applications"].as_array().unwrap() {
        let mut names: Vec<&str> =
            application["deaths"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
        names.sort_unstable();
        assert_eq!(names, ["n1", "n3"]);
    }
    let (_folder, summary) = run_text(&seeking(), &[]);
    assert!(summary["applications"][0]["deaths"].is_null());
}

#[test]
fn robots_arrive_at_the_level_of_a_field() {
    let (_folder, summary) = run_text(&seeking(), &[]);
    let applications = summary["applications"].as_array().unwrap();
    assert_eq!(applications.len(), 2);
    for (application, name, algorithm) in
        [(&applications[0], "gradient", "gradient"), (&applications[1], "law", "level-set")]
    {
        assert_eq!((&application["name"], &application["algorithm"]), (&name.into(), &algorithm.into()));
        assert_eq!((&application["map"], &application["arrived"]), (&"physical".into(), &true.into()));
        assert!(application["map_error_m"].is_null() && application["captured"].is_null());
        let arrival = &application["arrivals"][0];
        // It stops when it believes to be at most 0.1 below the level, and a lattice of sensors tells the field well.
        assert!(number(&arrival["believed"]) >= 8.9 - 1e-9, "{arrival}");
        assert!((number(&arrival["value"]) - 9.0).abs() < 0.5, "{arrival}");
        let time_s = number(&application["time_s"]);
        // The level is 9 within 1.84 m of the source: no robot with 0.5 m/s is there from 6.4 m in less than 9 s.
        assert!(time_s > 9.0 && time_s < 60.0, "{time_s} s");
        assert!(number(&application["path_length_m"]) <= 0.5 * time_s + 1e-9);
        assert!(
            number(&application["messages"]["requests"]) > 5.0 && number(&application["messages"]["answers"]) > 20.0
        );
        assert!(number(&application["energy_j"]["rx"]) > 0.0);
    }
    // The law climbs by at most 0.5 each second, from 10 exp(-41 / 32) at its start to 8.9.
    let least_s = (8.9 - 10.0 * (-41.0_f64 / 32.0).exp()) / 0.5;
    assert!((number(&applications[1]["law_minimum_s"]) - least_s).abs() < 1e-9);
    assert!(applications[0]["law_minimum_s"].is_null());
    // Nothing was surveyed, and the simulation is all phases together.
    assert!(summary["gathering"].is_null());
    let sum_s: f64 = applications.iter().map(|application| number(&application["sim_time_s"])).sum();
    assert!((number(&summary["simulation"]["sim_time_s"]) - sum_s).abs() < 1e-9);
}

#[test]
fn robots_that_survey_take_part_beside_agents_unless_others_are_named() {
    let application = SEEKING.split("[[applications]]").nth(1).unwrap();
    let scenario = |robots: &str| [NODES, FIELD, AGENT, SURVEY, "[[applications]]\n", robots, application].concat();
    for (robots, expected) in [
        ("", &["agent", "surveyor"][..]),
        ("robots = [\"agent\"]", &["agent"]),
        ("robots = [\"surveyor\"]", &["surveyor"]),
    ] {
        let (folder, summary) = run_text(&scenario(robots), &[]);
        let found = summary["applications"][0]["robots"].as_array().unwrap();
        let names: Vec<&str> = found.iter().map(|robot| robot["name"].as_str().unwrap()).collect();
        assert_eq!(names, expected, "{robots}");
        let output = call(folder.path(), &["run", "a.toml", "--quiet"]);
        let table = String::from_utf8(output.stdout).unwrap();
        assert!(table.contains(&format!("({}) take part", expected.join(", "))), "{table}");
    }
}

#[test]
fn a_recording_has_a_phase_for_each_application() {
    let (folder, summary) = run_text(&seeking(), &[]);
    let topics = topics(&folder);
    for (topic, least) in [
        ("/application/gradient", 1),
        ("/application/gradient/estimates", 20),
        ("/application/gradient/path/agent", 1),
        ("/application/law", 1),
        ("/world/fields/gas", 2),
        ("/tf", 10),
        ("/log", 4),
        ("/metrics", 40),
    ] {
        assert!(topics.get(topic).is_some_and(|&count| count >= least), "{topic}: {:?}", topics.get(topic));
    }
    assert!(!topics.contains_key("/robot/agent/path") && !topics.contains_key("/stops"));
    let recording = folder.path().join("run.mcap");
    let phases = &read_run(&recording).unwrap().metadata["phases"];
    assert_eq!(phases["names"], "gradient,law");
    let list = |key: &str| phases[key].split(',').map(|ns| ns.parse::<u64>().unwrap()).collect::<Vec<_>>();
    let (starts, ends) = (list("start_ns"), list("end_ns"));
    let length_s = |i: usize| (ends[i] - starts[i]) as f64 * 1e-9;
    for i in 0..2 {
        assert!((length_s(i) - number(&summary["applications"][i]["sim_time_s"])).abs() < 1e-6);
    }
    assert_eq!((starts[0], starts[1]), (0, (ends[0] / 1_000_000_000 + 1) * 1_000_000_000));

    let drawn = read_world(&recording).unwrap();
    let law = &drawn.applications[1];
    assert_eq!(
        (law.field.as_deref(), law.level, law.start),
        (Some("gas"), Some(9.0), SimTime::from_nanos(starts[1]))
    );
    assert_eq!((law.paths[0].0.as_str(), law.fields.len()), ("agent", 1));
    let (_, truth) = law.series_of("field_truth").next().unwrap();
    assert!(truth.iter().all(|(time, _)| (starts[1]..=ends[1]).contains(&time.as_nanos())));
    // The true value where the robot starts is that of the formula of the field.
    assert!((truth[0].1 - 10.0 * (-41.0_f64 / 32.0).exp()).abs() < 1.0, "{}", truth[0].1);
    let (_, estimate) = law.series_of("field_estimate").next().unwrap();
    let mean = estimate.iter().zip(truth).map(|(a, b)| (a.1 - b.1).abs()).sum::<f64>() / truth.len() as f64;
    assert!((mean - number(&summary["applications"][1]["field_error"]["mean"])).abs() < 1e-9);
}

#[test]
fn figures_show_the_field_with_the_level_and_the_path() {
    let (folder, _) = run_text(&seeking(), &[]);
    let figures = |words: &[&str]| {
        let output =
            sextant().current_dir(folder.path()).args(["figure", "run.mcap", "--out", "f"]).args(words).output();
        output.unwrap().printed();
    };
    figures(&[]);
    let figure = |name: &str| std::fs::read_to_string(folder.path().join("f").join(name)).unwrap();
    let picture = figure("application-law.svg");
    for text in ["applied: law (level-set)", "level 9", "path of agent", "value of the field"] {
        assert!(picture.contains(text), "{text}");
    }
    assert!(figure("application-law-value.svg").contains("agent, estimate"));
    assert!(figure("application-gradient-own-place-error.svg").contains("gradient on the map physical"));
    assert!(!folder.path().join("f/application-law-distance.svg").exists(), "there are no targets");
    figures(&["--format", "png"]);
    let png = std::fs::read(folder.path().join("f/application-law.png")).unwrap();
    assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
}

#[test]
fn the_number_of_threads_changes_no_byte() {
    let bytes =
        |threads| std::fs::read(run_text(&seeking(), &["--threads", threads]).0.path().join("run.mcap")).unwrap();
    assert!(bytes("1") == bytes("2"));
}

#[test]
fn a_robot_surveys_then_uses_its_map_from_where_the_survey_ended() {
    let applied =
        SEEKING.split("[[applications]]").nth(1).unwrap().replace("map.physical = {}", "map.computed = \"heard\"");
    let scenario = [NODES, FIELD, "\n", SURVEY, "[[applications]]", &applied].concat();
    let (folder, summary) = run_text(&scenario, &[]);
    let application = &summary["applications"][0];
    assert_eq!((&application["map"], &application["arrived"]), (&"heard".into(), &true.into()));
    let map_error_m = number(&application["map_error_m"]);
    // The local alignment leaves less than the map as a whole is wrong.
    assert!(map_error_m > 0.0 && map_error_m <= number(&summary["maps"][0]["position_error_m"]["mean"]) + 0.05);
    assert!(number(&summary["gathering"]["stops"]) > 10.0);
    let survey_s = number(&summary["gathering"]["duration_s"]);
    let total_s = survey_s + number(&application["sim_time_s"]);
    assert!((number(&summary["simulation"]["sim_time_s"]) - total_s).abs() < 1e-9);

    let recording = folder.path().join("run.mcap");
    let phases = &read_run(&recording).unwrap().metadata["phases"];
    assert_eq!(phases["names"], "survey,gradient");
    let drawn = read_world(&recording).unwrap();
    let (_, surveyed) = &drawn.paths[0];
    let (_, sought) = &drawn.applications[0].paths[0];
    assert!(surveyed.last().unwrap().distance_m(sought[0]) < 1e-9, "{:?} {:?}", surveyed.last(), sought.first());
    // The log of the survey is that of the survey alone: mapping the recording again gives the same map.
    call(folder.path(), &["map", "run.mcap", "--out", "heard.csv", "--quiet"]).printed();
    let from_file = applied.replace("map.computed = \"heard\"", "map.file = \"heard.csv\"");
    let scenario = [NODES, FIELD, "\n", AGENT, "[[applications]]", &from_file].concat();
    std::fs::write(folder.path().join("b.toml"), scenario).unwrap();
    call(folder.path(), &["run", "b.toml", "--out", "b.mcap", "--summary", "b.json", "--quiet"]).printed();
    let of_file = crate::program::summary(&folder.path().join("b.json"))["applications"][0].clone();
    assert_eq!(of_file["map"], "heard.csv");
    assert!((number(&of_file["map_error_m"]) - map_error_m).abs() < 1e-9, "{of_file}");
}

#[test]
fn a_map_from_neighbours_alone_needs_no_survey() {
    // Its orientation, handedness and scale are unknown.
    let map = "[[maps]]\nalgorithm.tpm = {}\n[[applications]]";
    let applied =
        SEEKING.split("[[applications]]").nth(1).unwrap().replace("map.physical = {}", "map.computed = \"tpm\"");
    let (folder, summary) = run_text(&[NODES, FIELD, AGENT, map, &applied].concat(), &[]);
    let application = &summary["applications"][0];
    assert_eq!(application["map"], "tpm");
    assert!(number(&application["map_error_m"]) > 0.0 && number(&application["own_place_error_m"]["mean"]) < 4.0);
    assert!(summary["gathering"].is_null() && summary["discovery"]["neighbours"].is_object());
    let phases = &read_run(&folder.path().join("run.mcap")).unwrap().metadata["phases"];
    assert_eq!((phases["names"].as_str(), phases["end_ns"].starts_with("0,")), ("survey,gradient", true));
}

#[test]
fn odometry_that_has_erred_in_the_survey_errs_on() {
    let erring =
        SURVEY.replace("listen_while_driving = true", "listen_while_driving = true\nodometry.scale_error = 0.05");
    let applied = SEEKING.split("[[applications]]").nth(1).unwrap();
    let (folder, summary) = run_text(&[NODES, FIELD, "\n", &erring, "[[applications]]", applied].concat(), &[]);
    assert_eq!(summary["applications"][0]["arrived"], true);
    let drawn = read_world(&folder.path().join("run.mcap")).unwrap();
    let start = drawn.applications[0].paths[0].1[0];
    // The survey ends where it believes to be at (4, 8); each way was 5 % longer.
    assert!((start.x_m - 4.0).abs() > 0.05 && start.distance_m([4.0, 8.0, 0.0].into()) < 1.0, "{start}");
    assert!(topics(&folder)["/robot/surveyor/odometry"] > 5);
}

#[test]
fn a_sweep_has_columns_of_each_application() {
    let folder = TempDir::new().unwrap();
    let sweep = "\n[sweep]\nruns = 1\nproduct.applications.0.algorithm.gradient.goal.level = [6.0, 9.0]\n";
    std::fs::write(folder.path().join("a.toml"), seeking() + sweep).unwrap();
    call(folder.path(), &["sweep", "a.toml", "--out", "t.csv", "--quiet"]).printed();
    let rows = table(&folder.path().join("t.csv"));
    let value = |row: usize, name: &str| rows[row][name].parse::<f64>().unwrap();
    let time = "applications.gradient.time_s";
    assert!(value(0, time) < value(1, time), "a lower level is reached earlier");
    assert!((value(0, "applications.gradient.level") - 6.0).abs() < 1e-12);
    assert!(value(0, "applications.gradient.arrived") > 0.5);
    assert!(!rows[0].contains_key("applications.gradient.captured"), "no run has a value");
    let (_folder, summary) = run_text(&seeking(), &[]);
    assert!((value(1, "applications.law.time_s") - number(&summary["applications"][1]["time_s"])).abs() < 1e-9);
}

#[cfg(unix)]
#[test]
fn a_signal_ends_an_application_and_keeps_what_was_done() {
    use std::time::Duration;

    // The level is reached nowhere: the peak of 10 is between nodes, and noise is absent.
    let slow = seeking().replace("duration_s = 60.0", "duration_s = 1e6").replacen(
        "level = 9.0",
        "level = 10.0, tolerance = 1e-6, hold_s = 1e5",
        1,
    );
    let folder = TempDir::new().unwrap();
    std::fs::write(folder.path().join("a.toml"), slow).unwrap();
    let arguments = ["run", "a.toml", "--out", "run.mcap", "--summary", "run.json", "--quiet"];
    let mut child = sextant().current_dir(folder.path()).args(arguments).spawn().unwrap();
    while !folder.path().join("run.mcap.part").exists() {
        std::thread::sleep(Duration::from_millis(20));
    }
    std::thread::sleep(Duration::from_secs(2));
    crate::program::signal(&child, "-INT");
    #[expect(clippy::disallowed_methods, reason = "a program that hangs must fail the test")]
    let start = std::time::Instant::now();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(start.elapsed() < Duration::from_secs(10), "{:?}", start.elapsed());
    let summary = crate::program::summary(&folder.path().join("run.json"));
    assert_eq!((&summary["interrupted"], summary["applications"].as_array().unwrap().len()), (&true.into(), 1));
    assert_eq!(summary["applications"][0]["interrupted"], true);
    let drawn = read_world(&folder.path().join("run.mcap")).unwrap();
    assert!(drawn.applications[0].paths[0].1.len() > 2);
}
