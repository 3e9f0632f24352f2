//! Teams of robots: an area is divided among them, and their maps are stitched.

use std::path::Path;

use assert_cmd::cargo::cargo_bin_cmd;
use serde_json::Value;
use tempfile::TempDir;

use crate::program::{scenario, sextant, summary};

/// The summary of a run of the shipped team with these settings, and its recording in `folder`.
fn run(folder: &Path, settings: &[&str]) -> Value {
    let json = folder.join("run.json");
    let mut command = sextant();
    command.arg("run").arg(scenario("teams/size.toml")).args(["--quiet", "--summary"]).arg(&json);
    command.arg("--out").arg(folder.join("run.mcap"));
    // A third of the area is enough here.
    for setting in [
        "world.nodes.random.count=170",
        "world.nodes.random.region.rectangle.max_m=[24.0, 22.0]",
        "team.controller.s_path.region.rectangle.max_m=[24.0, 22.0]",
    ] {
        command.args(["--set", setting]);
    }
    settings.iter().for_each(|setting| {
        command.args(["--set", setting]);
    });
    let output = command.output().expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    summary(&json)
}

fn map<'a>(summary: &'a Value, name: &str) -> &'a Value {
    let maps = summary["maps"].as_array().expect("maps");
    maps.iter().find(|map| map["name"] == name).expect("the map")
}

fn error_m(map: &Value) -> f64 {
    map["position_error_m"]["mean"].as_f64().expect("an error")
}

#[test]
fn robots_with_unknown_frames_make_one_map_together() {
    let folder = TempDir::new().expect("there is room");
    let summary = run(folder.path(), &["team.robots=3"]);
    let robots = summary["gathering"]["robots"].as_array().expect("robots");
    let names: Vec<&str> = robots.iter().map(|robot| robot["name"].as_str().expect("a name")).collect();
    assert_eq!(names, ["surveyor-1", "surveyor-2", "surveyor-3"]);
    let times: Vec<f64> = robots.iter().map(|robot| robot["duration_s"].as_f64().expect("a time")).collect();
    let (least, most) =
        (times.iter().copied().fold(f64::INFINITY, f64::min), times.iter().copied().fold(0.0, f64::max));
    assert!(most < 1.35 * least, "{times:?}");
    let (stitched, apart) = (map(&summary, "stitched"), map(&summary, "apart"));
    assert!(error_m(stitched) < 0.6 && error_m(apart) > 5.0, "{} m, {} m", error_m(stitched), error_m(apart));
    let stitching = &stitched["stitching"];
    assert_eq!(stitching["joined"], 3);
    assert!(apart.get("stitching").is_none() && apart.get("posterior_bound_m").is_none());
    // The first robot has the frame of the map.
    assert_eq!(stitching["robots"][0]["offset_m"], serde_json::json!([0.0, 0.0, 0.0]));
    assert!(stitching["robots"][2]["shared_nodes"].as_u64().expect("a number") > 20);
    // The same from the recording.
    let again = folder.path().join("map.json");
    let mut command = sextant();
    let output = command.arg("map").arg(folder.path().join("run.mcap")).arg("--summary").arg(&again).output();
    let output = output.expect("it starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(text.contains("surveyor-3 joined: "), "{text}");
    let again = self::summary(&again);
    assert_eq!(map(&again, "stitched")["position_error_m"], stitched["position_error_m"]);
}

#[test]
fn one_robot_of_a_team_needs_no_stitching_and_known_frames_are_kept() {
    let folder = TempDir::new().expect("there is room");
    let alone = run(folder.path(), &["team.robots=1"]);
    let (stitched, apart) = (map(&alone, "stitched"), map(&alone, "apart"));
    assert_eq!(stitched["position_error_m"], apart["position_error_m"]);
    assert!(stitched.get("stitching").is_none());
    let shared = run(folder.path(), &["team.robots=2", "team.frames=shared"]);
    let (stitched, apart) = (map(&shared, "stitched"), map(&shared, "apart"));
    assert_eq!(stitched["position_error_m"], apart["position_error_m"]);
    // The recording knows it too, and the list of known frames overrules it.
    let mapped = |words: &[&str]| {
        let output =
            sextant().arg("map").arg(folder.path().join("run.mcap")).args(words).output().expect("it starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    let kept = mapped(&["--stitch"]);
    assert!(kept.contains("the frames of all 2 robots are known, so nothing was stitched"), "{kept}");
    let found = mapped(&["--set", "maps.0.stitch.known=[]"]);
    assert!(found.contains("surveyor-2 joined: "), "{found}");
}

#[test]
fn teams_that_cannot_be_are_refused_at_their_keys() {
    let robot = "robots=[{ name = \"surveyor-2\", start_m = [0, 0], controller.waypoints.places_m = [[1, 1]] }]";
    let no_region = "team.controller={ waypoints.places_m = [[1, 1]] }";
    let no_area = "team.controller={ automated_s = {} }";
    let alone = "robots=[{ name = \"a\", start_m = [0, 0], controller.waypoints.places_m = [[1, 1]] }]";
    for (settings, expected) in [
        (&["team.robots=0"][..], "`team.robots` is 0; allowed: 1 to 256"),
        (&["team.robots=257"], "`team.robots` is 257; allowed: 1 to 256"),
        (&["team.robots=12", "team.controller.s_path.stop_spacing_m=80.0"], "one for each stop of the whole path"),
        (&["team.overlap_m=-1"], "`team.overlap_m` is -1"),
        (&["team.name=a b"], "`team.name` is `a b"),
        (&["team.partition.balance=luck"], "`area`"),
        (&[robot], "`team.name` is `surveyor-2`, the name of an earlier robot"),
        (&[no_region], "`team.controller` is a path that is not over a region"),
        (&[no_area], "team.controller.automated_s.area"),
        (&["team.controller.s_path.lane_spacing_m=0"], "team.controller.s_path.lane_spacing_m"),
        (&["maps=[{ stitch = {}, algorithm = { centroid = {} } }]"], "maps[0].stitch"),
        (&["maps.0.stitch.scale=true"], "unknown key"),
        (&["maps.0.stitch.known=[\"surveyor-9\"]"], "`maps[0].stitch.known` is `surveyor-9`"),
        (&[alone, "team.robots=1"], ""),
    ] {
        let mut command = cargo_bin_cmd!("sextant");
        command.arg("check").arg(scenario("teams/size.toml")).env("NO_COLOR", "1");
        settings.iter().for_each(|setting| {
            command.args(["--set", setting]);
        });
        let output = command.output().expect("it starts");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        let message: Vec<&str> = message.split_whitespace().filter(|word| *word != "│").collect();
        let message = message.join(" ");
        let code = output.status.code();
        assert_eq!(code, Some(if expected.is_empty() { 0 } else { 2 }), "{settings:?}: {message}");
        assert!(message.contains(expected), "{settings:?}: {message}");
    }
}

#[test]
fn one_robot_without_a_team_has_nothing_to_stitch() {
    let mut command = cargo_bin_cmd!("sextant");
    command.arg("check").arg(scenario("smoke.toml")).args(["--set", "maps.0.stitch={}"]).env("NO_COLOR", "1");
    let output = command.output().expect("it starts");
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("maps[0].stitch") && message.contains("one robot that surveys"), "{message}");
}

#[test]
fn the_log_of_one_robot_is_not_stitched() {
    let folder = TempDir::new().expect("there is room");
    for (name, text) in [
        ("stops.csv", "stop,t_s,x_m,y_m\n0,0,0,0\n1,1,2,0\n2,2,4,1\n"),
        ("receptions.csv", "node,stop,received,sent\na,0,3,5\na,1,5,5\nb,1,2,5\nb,2,5,5\n"),
    ] {
        std::fs::write(folder.path().join(name), text).expect("there is room");
    }
    for words in [&["--stitch"][..], &["--algorithm", "packet-centroid", "--set", "maps.0.stitch={}"]] {
        let mut command = cargo_bin_cmd!("sextant");
        let output = command.args(["map", "."]).args(words).current_dir(folder.path()).env("NO_COLOR", "1").output();
        let output = output.expect("it starts");
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        let message: Vec<&str> = message.split_whitespace().filter(|word| *word != "│").collect();
        let message = message.join(" ");
        assert_eq!(output.status.code(), Some(2), "{words:?}: {message}");
        assert!(message.contains("give the stops a column `robot`"), "{words:?}: {message}");
    }
}
