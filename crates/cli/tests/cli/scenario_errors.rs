//! Invalid scenarios: each is rejected with exit code 2, and the error points at the mistake.

use insta::assert_snapshot;
use tempfile::TempDir;

use crate::program::{Said, call, folder};

/// A valid scenario, in which tests change one line.
const GOOD: &str = r#"name = "good"
seed = 1

[world.nodes.explicit]
positions_m = [[0.0, 0.0], [1.0, 0.0]]

[[world.obstacles]]
name = "wall"
material = "concrete"
[world.obstacles.shape.box]
center_m = [5.0, 5.0, 0.0]
size_m = [2.0, 1.0, 3.0]

[radio]
tx_power_dbm = -50.0
sensitivity_dbm = -90.0

[channel]
environment = "suburban"

[channel.path_loss.log_distance]
exponent = 3.0

[traffic.beacon]
interval_s = 1.0

[[robots]]
name = "surveyor"
start_m = [-3.0, 0.0]
[robots.controller.automated_s]
step_m = 1.0
lane_spacing_m = 5.0

[[maps]]
[maps.algorithm.ml_tm]
grid_step_m = 0.25
[maps.algorithm.ml_tm.profile.trapezoid]
p0 = 0.95
plateau_m = 2.0
range_m = 10.0
"#;

/// The errors that `check` with the arguments `words` prints in a folder.
fn refusal(folder: &TempDir, words: &[&str]) -> String {
    let (code, stdout, stderr) = call(folder.path(), &[&["check"], words].concat()).all();
    assert_eq!((code, stdout.as_str()), (2, ""), "{stderr}");
    stderr
}

/// The errors of the valid scenario with `from` replaced by `to`.
fn refused(from: &str, to: &str) -> String {
    assert_eq!(GOOD.matches(from).count(), 1, "{from}");
    refusal(&folder(&[("a.toml", &GOOD.replace(from, to))]), &["a.toml"])
}

fn refused_flag(flag: &str) -> String {
    refusal(&folder(&[("a.toml", GOOD)]), &["a.toml", "--set", flag])
}

#[test]
fn the_unchanged_scenario_is_valid() {
    let (code, stdout, stderr) = call(folder(&[("a.toml", GOOD)]).path(), &["check", "a.toml"]).all();
    assert_eq!((code, stderr.as_str()), (0, ""));
    assert_eq!(stdout, "ok good: 2 nodes, 1 obstacle, 1 robot, 0 sinks, 1 map\n");
}

#[test]
fn a_missing_file() {
    assert_snapshot!(refusal(&folder(&[]), &["none.toml"]));
}

#[test]
fn a_folder() {
    assert_snapshot!(refusal(&folder(&[("folder/a.toml", GOOD)]), &["folder"]));
}

#[test]
fn broken_toml() {
    assert_snapshot!(refused("seed = 1", "seed = = 1"));
}

#[test]
fn a_typo_in_a_key() {
    assert_snapshot!(refused("sensitivity_dbm", "sensitivty_dbm"));
}

#[test]
fn odometry_with_negative_noise() {
    let body = "name = \"surveyor\"\nodometry = { heading_noise_rad_per_sqrt_m = -0.01 }";
    assert_snapshot!(refused("name = \"surveyor\"", body));
}

#[test]
fn odometry_with_a_scale_that_is_no_number() {
    assert_snapshot!(refused_flag("robots.0.odometry.scale_error=nan"));
}

#[test]
fn a_typo_in_a_key_of_odometry() {
    assert_snapshot!(refused_flag("robots.0.odometry.heading_drift_rad=0.1"));
}

#[test]
fn a_typo_in_a_table() {
    assert_snapshot!(refused("[radio]", "[radios]"));
}

#[test]
fn a_typo_in_a_choice() {
    assert_snapshot!(refused("[world.nodes.explicit]", "[world.nodes.explicite]"));
}

#[test]
fn an_unknown_environment() {
    assert_snapshot!(refused("\"suburban\"", "\"suburb\""));
}

#[test]
fn a_missing_key() {
    assert_snapshot!(refused("tx_power_dbm = -50.0\n", ""));
}

#[test]
fn a_wrong_type() {
    assert_snapshot!(refused("grid_step_m = 0.25", "grid_step_m = \"fine\""));
}

#[test]
fn a_negative_exponent() {
    assert_snapshot!(refused("exponent = 3.0", "exponent = -3.0"));
}

#[test]
fn a_nan() {
    assert_snapshot!(refused("tx_power_dbm = -50.0", "tx_power_dbm = nan"));
}

#[test]
fn no_nodes() {
    assert_snapshot!(refused("[[0.0, 0.0], [1.0, 0.0]]", "[]"));
}

#[test]
fn a_node_in_an_obstacle() {
    assert_snapshot!(refused("[1.0, 0.0]]", "[5.0, 5.0]]"));
}

#[test]
fn a_robot_in_an_obstacle() {
    assert_snapshot!(refused("start_m = [-3.0, 0.0]", "start_m = [5.0, 5.0]"));
}

#[test]
fn an_obstacle_without_volume() {
    assert_snapshot!(refused("size_m = [2.0, 1.0, 3.0]", "size_m = [2.0, 0.0, 3.0]"));
}

#[test]
fn an_unknown_material() {
    let text = refused("\"concrete\"", "\"cheese\"");
    assert!(text.contains("`world.obstacles[0].material` is \"cheese\""), "{text}");
    assert!(text.contains("a.toml:9:12"), "{text}");
    assert!(text.contains("concrete"), "{text}");
}

#[test]
fn an_array_that_is_too_short() {
    assert_snapshot!(refused("size_m = [2.0, 1.0, 3.0]", "size_m = [2.0, 1.0]"));
}

#[test]
fn several_errors_are_reported_at_once() {
    let text = GOOD.replace("exponent = 3.0", "exponent = 0.0").replace("p0 = 0.95", "p0 = 1.5");
    let text = text.replace("interval_s = 1.0", "interval_s = 0.0");
    let text = refusal(&folder(&[("a.toml", &text)]), &["a.toml"]);
    for place in ["a.toml:22:12", "a.toml:25:14", "a.toml:38:6"] {
        assert!(text.contains(place), "{place}: {text}");
    }
}

#[test]
fn valid_files_are_reported_beside_invalid_ones() {
    let folder = folder(&[("a.toml", GOOD), ("b.toml", "nam = 1"), ("c.toml", GOOD)]);
    let (code, stdout, stderr) = call(folder.path(), &["check", "a.toml", "b.toml", "none.toml", "c.toml"]).all();
    assert_eq!(code, 2);
    assert_eq!(stdout.lines().count(), 2, "{stdout}");
    assert!(stderr.contains("b.toml:1:1") && stderr.contains("`none.toml`"), "{stderr}");
}

#[test]
fn a_flag_with_a_bad_path() {
    assert_snapshot!(refused_flag("robots.1.speed_m_per_s=2"));
}

#[test]
fn a_flag_with_a_bad_value() {
    assert_snapshot!(refused_flag("channel.path_loss.log_distance.exponent=-1"));
}

#[test]
fn a_flag_with_a_typo() {
    assert_snapshot!(refused_flag("radio.tx_power=-40"));
}

#[test]
fn a_circle_of_files() {
    let folder = folder(&[("a.toml", "extends = \"b.toml\""), ("b.toml", "extends = \"a.toml\"")]);
    assert_snapshot!(refusal(&folder, &["a.toml"]));
}

#[test]
fn an_error_in_an_extended_file() {
    let base = GOOD.replace("exponent = 3.0", "exponent = inf");
    let folder = folder(&[("base/base.toml", &base), ("a.toml", "extends = \"base/base.toml\"\nseed = 2")]);
    let text = refusal(&folder, &["a.toml"]);
    assert!(text.contains("base/base.toml:22:12"), "{text}");
}

#[test]
fn file_paths_are_relative_to_the_layer_that_names_them() {
    let base = GOOD.replace("[world.nodes.explicit]", "[world.nodes.csv]");
    let base = base.replace("positions_m = [[0.0, 0.0], [1.0, 0.0]]", "file = \"nodes.csv\"");
    let folder = folder(&[
        ("base/base.toml", &base),
        ("base/nodes.csv", "node,x_m,y_m\na,0,0\nb,1,0\nc,2,0\n"),
        ("top/a.toml", "extends = \"../base/base.toml\""),
    ]);
    for file in ["base/base.toml", "top/a.toml"] {
        let (_, stdout, stderr) = call(folder.path(), &["check", file]).all();
        assert_eq!(stdout, "ok good: 3 nodes, 1 obstacle, 1 robot, 0 sinks, 1 map\n", "{stderr}");
    }
    let mesh = base.replace("shape.box]", "shape.mesh]").replace("center_m = [5.0, 5.0, 0.0]", "file = \"hut.obj\"");
    std::fs::write(folder.path().join("base/base.toml"), mesh.replace("size_m = [2.0, 1.0, 3.0]", "")).unwrap();
    let hut = "v 5 5 0\nv 6 5 0\nv 5 6 0\nv 5 5 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
    std::fs::write(folder.path().join("base/hut.obj"), hut).unwrap();
    for file in ["base/base.toml", "top/a.toml"] {
        let (_, stdout, stderr) = call(folder.path(), &["check", file]).all();
        assert_eq!(stdout, "ok good: 3 nodes, 1 obstacle, 1 robot, 0 sinks, 1 map\n", "{stderr}");
    }
    std::fs::write(folder.path().join("base/nodes.csv"), "node,x_m,y_m\na,0,zero\n").unwrap();
    let text = refusal(&folder, &["base/base.toml"]);
    assert!(text.contains("line 2") && text.contains("`zero`") && text.contains("base/base.toml:5:8"), "{text}");
}

/// The errors of the valid scenario with these settings of a beacon-enabled MAC.
fn refused_superframe(settings: &str) -> String {
    refused("[traffic.beacon]", &format!("[mac.beacon_enabled]\n{settings}\n\n[traffic.beacon]"))
}

#[test]
fn an_active_part_longer_than_the_beacon_interval() {
    assert_snapshot!(refused_superframe("beacon_order = 3\nsuperframe_order = 4"));
}

#[test]
fn guaranteed_slots_that_leave_too_little_for_contention() {
    let settings = "beacon_order = 0\nsuperframe_order = 0\ngts = [{ node = \"n0\", slots = 8 }]";
    assert_snapshot!(refused_superframe(settings));
}

#[test]
fn eight_guaranteed_slots() {
    let slots = ["{ node = \"n0\" }"; 8].join(", ");
    assert_snapshot!(refused_superframe(&format!("gts = [{slots}]")));
}

#[test]
fn a_guaranteed_slot_of_an_unknown_node() {
    assert_snapshot!(refused_superframe("gts = [{ node = \"n0\" }, { node = \"n9\" }]"));
}

#[test]
fn a_stop_shorter_than_the_beacon_interval() {
    assert_snapshot!(refused_superframe("beacon_order = 7\nsuperframe_order = 0"));
}
