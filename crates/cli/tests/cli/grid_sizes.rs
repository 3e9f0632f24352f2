//! Grids that do not fit the memory: `sextant check` and `sextant run` refuse the same scenarios, with the same words.

use crate::program::call;

/// Nodes in a row, a robot without a controller, and a map in the plane of the robot.
const ROW: &str = r#"name = "row"
[world.nodes.explicit]
positions_m = [[0, 0], [10, 0], [20, 0], [30, 0]]
[radio]
tx_power_dbm = 0
sensitivity_dbm = -90
[channel]
max_range_m = 40.0
[channel.path_loss.log_distance]
exponent = 3.0
[channel.shadowing]
sigma_db = 4.0
[traffic.periodic]
mpdu_octets = 20
interval_s = 0.5
[[robots]]
name = "rover"
start_m = [0, 1, 0]
speed_m_per_s = 2.0
listen_s = 2.0
[[maps]]
[maps.algorithm.ml_tm]
grid_step_m = 0.2
profile.trapezoid = { plateau_m = 20.0, range_m = 40.0, p0 = 0.9 }
"#;

/// A window of 401³ vertices for each node.
const DENSE: &str = "grid_step_m = 0.2";
const COARSE: &str = "grid_step_m = 1.0";

/// Exit codes and messages of `sextant check` and of `sextant run`.
fn answers(text: &str) -> [(Option<i32>, String); 2] {
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("a.toml"), text).expect("there is room");
    ["check", "run"].map(|command| {
        let output = call(folder.path(), &[command, "a.toml"]);
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    })
}

fn are_refused(controller: &str) {
    let dense = format!("{ROW}[robots.controller.{controller}");
    let [check, run] = answers(&dense);
    assert_eq!((check.0, run.0), (Some(2), Some(2)), "{controller}: {} {}", check.1, run.1);
    assert_eq!(check.1, run.1, "{controller}");
    assert!(check.1.contains("`maps[0].algorithm`") && check.1.contains("vertices"), "{}", check.1);
    assert!(check.1.contains("`z_range_m` limits its heights"), "{}", check.1);
}

fn are_accepted(text: &str) {
    let [check, run] = answers(text);
    assert_eq!((check.0, run.0), (Some(0), Some(0)), "{} {}", check.1, run.1);
}

#[test]
fn the_grid_of_a_path_through_several_heights_is_refused_before_the_run() {
    are_refused("waypoints]\nplaces_m = [[0, 1, 0], [10, 1, 20]]\n");
    are_refused("automated_s]\nlane_spacing_m = 10.0\nlayers.spacing_m = 10.0\n");
    are_refused("random_walk]\nregion.box = { min_m = [-1, -1, -1], max_m = [40, 9, 30] }\n");
}

#[test]
fn the_grid_of_a_path_at_one_height_is_accepted_by_check_and_run() {
    are_accepted(&format!("{ROW}[robots.controller.waypoints]\nplaces_m = [[0, 1, 0], [10, 1, 0]]\n"));
    are_accepted(&format!("{ROW}[robots.controller.automated_s]\nlane_spacing_m = 10.0\nmax_steps = 5\n"));
}

#[test]
fn heights_of_nodes_and_a_coarser_grid_make_the_grid_of_a_climbing_robot_fit() {
    let climbing = format!("{ROW}[robots.controller.waypoints]\nplaces_m = [[0, 1, 0], [10, 1, 20]]\n");
    are_accepted(&climbing.replace(DENSE, &format!("{DENSE}\nz_range_m = [0.0, 0.5]")));
    are_accepted(&climbing.replace(DENSE, COARSE));
}

#[test]
fn a_bayesian_grid_is_refused_over_a_long_path_if_its_step_is_set_and_is_coarser_otherwise() {
    let ml_tm = ROW.find("[maps.algorithm.ml_tm]").expect("there is a map");
    let long = |map: &str, robot: &str| format!("{}{map}\n{robot}", &ROW[..ml_tm]);
    let robot = "[robots.controller.waypoints]\nplaces_m = [[0, 1, 0], [9000, 1, 0], [9000, 9000, 0]]\n";
    let [check, run] = answers(&long("algorithm.rss_grid = { grid_step_m = 1.0 }", robot));
    assert_eq!((check.0, run.0), (Some(2), Some(2)), "{} {}", check.1, run.1);
    assert_eq!(check.1, run.1);
    assert!(check.1.contains("`maps[0].algorithm`") && check.1.contains("vertices"), "{}", check.1);
    assert!(!check.1.contains("max_memory_mb"), "it has no such key: {}", check.1);
    are_accepted(&long("algorithm.rss_grid = { grid_step_m = 1.0 }", &robot.replace("9000", "90")));
    are_accepted(&long("algorithm.rss_grid = {}", robot));
}
