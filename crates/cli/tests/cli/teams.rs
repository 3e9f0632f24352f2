//! Teams of robots: what their recordings say when they are mapped, and logs of one robot.

use tempfile::TempDir;

use crate::program::{Said, call, folder, scenario, sextant, summary};

#[test]
fn a_recording_of_robots_with_unknown_frames_is_stitched_as_in_the_run() {
    let folder = TempDir::new().expect("there is room");
    let path = |name: &str| folder.path().join(name);
    let mut run = sextant();
    run.arg("run").arg(scenario("teams/size.toml")).args(["--quiet", "--summary"]).arg(path("run.json"));
    // A third of the area, and one of the maps.
    for setting in [
        "world.nodes.random.count=170",
        "world.nodes.random.region.rectangle.max_m=[24.0, 22.0]",
        "team.controller.s_path.region.rectangle.max_m=[24.0, 22.0]",
        "team.robots=3",
        "recording.map_snapshots=0",
        "maps=[{ name = \"stitched\", stitch = {}, \
            algorithm.ml_tm = { grid_step_m = 0.25, estimate = \"posterior_mean\", profile.fitted = {} } }]",
    ] {
        run.args(["--set", setting]);
    }
    run.arg("--out").arg(path("run.mcap")).output().expect("it starts").printed();
    let output = sextant().arg("map").arg(path("run.mcap")).arg("--summary").arg(path("map.json")).output();
    let text = output.expect("it starts").printed();
    assert!(text.contains("surveyor-3 joined: "), "{text}");
    let [of_run, of_recording] = ["run.json", "map.json"].map(|name| summary(&path(name))["maps"][0].clone());
    assert!(of_run["position_error_m"]["mean"].is_number() && of_run["stitching"]["joined"] == 3, "{of_run}");
    assert_eq!(of_run["position_error_m"], of_recording["position_error_m"]);
}

#[test]
fn the_log_of_one_robot_is_not_stitched() {
    let folder = folder(&[
        ("stops.csv", "stop,t_s,x_m,y_m\n0,0,0,0\n1,1,2,0\n2,2,4,1\n"),
        ("receptions.csv", "node,stop,received,sent\na,0,3,5\na,1,5,5\nb,1,2,5\nb,2,5,5\n"),
    ]);
    for words in [&["--stitch"][..], &["--algorithm", "packet-centroid", "--set", "maps.0.stitch={}"]] {
        let message = call(folder.path(), &[&["map", "."], words].concat()).refusal();
        assert!(message.contains("give the stops a column `robot`"), "{words:?}: {message}");
    }
}
