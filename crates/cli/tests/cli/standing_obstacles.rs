//! Obstacles that stand on the ground, as users write them: from z = 0 up, among stations at z = 0.

use std::path::Path;

use serde_json::Value;
use tempfile::TempDir;

use crate::program::{call, summary};

/// A wall of 1 m from x = 4.5 m on between two nodes, as a shape of each kind.
const WALLS: [&str; 5] = [
    "box = { center_m = [5.0, 0.0, 1.0], size_m = [1.0, 8.0, 2.0] }",
    "cylinder = { base_m = [5.0, 0.0], radius_m = 0.5, height_m = 2.0 }",
    "prism = { corners_m = [[4.5, -4.0], [5.5, -4.0], [5.5, 4.0], [4.5, 4.0]], height_m = 2.0 }",
    "convex = { points_m = [[4.5, -4, 0], [5.5, -4, 0], [5.5, 4, 0], [4.5, 4, 0], [4.5, -4, 2], [5.5, -4, 2], [5.5, 4, 2], [4.5, 4, 2]] }",
    "mesh = { file = \"wall.obj\" }",
];

const WALL_FILE: &str = "v 4.5 -4 0\nv 5.5 -4 0\nv 5.5 4 0\nv 4.5 4 0\nv 4.5 -4 2\nv 5.5 -4 2\nv 5.5 4 2\nv 4.5 4 2\n\
                         f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

fn world(shape: &str) -> String {
    format!(
        r#"name = "yard"
[world.nodes.explicit]
positions_m = [[0, 0], [10, 0]]
[[world.obstacles]]
name = "wall"
loss_db = 80.0
shape.{shape}
[radio]
tx_power_dbm = 0
sensitivity_dbm = -90
[channel.path_loss.log_distance]
exponent = 2.0
[traffic.periodic]
mpdu_octets = 20
interval_s = 0.5
[[robots]]
name = "rover"
start_m = [1, 0]
listen_s = 10.0
[robots.controller.waypoints]
places_m = [[1, 0], [2, 0]]
"#
    )
}

/// A folder with the wall as a mesh file.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("there is room");
    std::fs::write(folder.path().join("wall.obj"), WALL_FILE).expect("there is room");
    folder
}

/// Exit code, standard output and standard error of the program with a scenario `a.toml`.
fn told(folder: &Path, text: &str, words: &[&str]) -> (Option<i32>, String, String) {
    std::fs::write(folder.join("a.toml"), text).expect("there is room");
    let output = call(folder, words);
    let text = |bytes| String::from_utf8(bytes).expect("the output is text");
    (output.status.code(), text(output.stdout), text(output.stderr))
}

/// The warnings of obstacles that block nothing.
fn idle(warnings: &str) -> String {
    warnings.lines().filter(|line| line.contains("blocks nothing")).collect()
}

/// Packets that the robot received.
fn received(folder: &Path, text: &str) -> u64 {
    let (code, _, stderr) = told(folder, text, &["run", "a.toml", "--quiet", "--summary", "s.json"]);
    assert_eq!(code, Some(0), "{stderr}");
    summary(&folder.join("s.json"))["gathering"]["packets_received"].as_u64().expect("a count")
}

#[test]
fn a_wall_on_the_ground_takes_the_packets_of_the_node_behind_it() {
    let folder = folder();
    let folder = folder.path();
    let open = received(folder, &world("box = { center_m = [5, 9, 1], size_m = [1, 1, 2] }"));
    for shape in WALLS {
        let behind = world(shape);
        // Half of the packets were those of the node behind the wall; phases of the traffic are drawn.
        let near = received(folder, &behind);
        assert!(open >= 76 && 2 * near <= open + 4 && 2 * near + 4 >= open, "{shape}: {near} of {open}");
        let (code, stdout, stderr) =
            told(folder, &behind, &["explain-link", "a.toml", "n0", "n1", "--format", "json"]);
        assert_eq!(code, Some(0), "{stderr}");
        let link: Value = serde_json::from_str(&stdout).expect("JSON");
        let crossed = &link["path"]["obstacles"][0];
        let length_m = crossed["length_m"].as_f64().expect("the wall is crossed");
        assert!((length_m - 1.0).abs() < 1e-9 && crossed["loss_db"] == 80.0, "{shape}: {crossed}");
        assert_eq!(idle(&told(folder, &behind, &["check", "a.toml"]).2), "", "{shape}");
        // On the wall, and on the roof of a lower one, stations are free.
        for places in ["[[4.5, -3], [4.5, 3]]", "[[0, 0, 2], [10, 0, 2]]", "[[0, 0, -0.5], [10, 0, -0.5]]"] {
            let beside = behind.replace("[[0, 0], [10, 0]]", places);
            let (code, stdout, stderr) =
                told(folder, &beside, &["explain-link", "a.toml", "n0", "n1", "--format", "json"]);
            assert_eq!(code, Some(0), "{stderr}");
            let link: Value = serde_json::from_str(&stdout).expect("JSON");
            assert_eq!(link["path"]["obstacles"], serde_json::json!([]), "{shape} {places}");
        }
    }
}

#[test]
fn nobody_stands_in_what_stands_on_the_ground() {
    let folder = folder();
    for shape in WALLS {
        let text = world(shape);
        for (from, to, key) in [
            ("start_m = [1, 0]", "start_m = [5, 0]", "start_m"),
            ("[[0, 0], [10, 0]]", "[[0, 0], [5, 0.2]]", "positions_m[1]"),
            ("[[1, 0], [2, 0]]", "[[1, 0], [5, 0]]", "places_m[1]"),
            ("[radio]", "[[sinks]]\nname = \"gate\"\nposition_m = [5, 0]\n[radio]", "position_m"),
        ] {
            let (code, _, stderr) = told(folder.path(), &text.replace(from, to), &["check", "a.toml"]);
            assert_eq!(code, Some(2), "{shape}: {to}");
            assert!(stderr.contains(key) && stderr.contains("inside obstacle `wall`"), "{shape}: {stderr}");
        }
    }
}

/// Walls of metal around the line of stations, 4 m away, and something else.
fn room(more: &str) -> String {
    let walls: String =
        [([5.0, -4.0], [20.0, 0.3]), ([5.0, 4.0], [20.0, 0.3]), ([-4.0, 0.0], [0.3, 8.0]), ([14.0, 0.0], [0.3, 8.0])]
            .iter()
            .map(|([x, y], [dx, dy])| {
                let shape = format!("box = {{ center_m = [{x}, {y}, 1.5], size_m = [{dx}, {dy}, 3.0] }}");
                format!("[[world.obstacles]]\nmaterial = \"metal\"\nshape.{shape}\n")
            })
            .collect();
    // Reflections go past it: two nodes are behind it.
    world("box = { center_m = [5.0, 1.0, 1.0], size_m = [1.0, 3.0, 2.0] }")
        .replace("[[0, 0], [10, 0]]", "[[0, 0], [10, 0], [12, 0]]")
        .replace("[radio]", &format!("{walls}{more}[radio]"))
}

#[test]
fn walls_that_reflect_are_not_said_to_block_nothing_and_those_that_do_not_are() {
    let folder = folder();
    let warning = |text: &str| idle(&told(folder.path(), text, &["check", "a.toml"]).2);
    let reflecting = |law: &str, more: &str| {
        room(more).replace("[traffic.periodic]", &format!("[channel.reflections]\n{law}\n[traffic.periodic]"))
    };
    let silent = warning(&room(""));
    assert!(
        silent.contains("`world.obstacles[1]`: the obstacle blocks nothing")
            && silent.contains("and 3 obstacles more"),
        "{silent}"
    );
    for law in ["loss_db = 6.0", "order = 2", "edges = true"] {
        assert_eq!(warning(&reflecting(law, "")), "", "{law}");
        for shape in [
            // Above all links, far beside them, and below the ground.
            "box = { center_m = [5, 9, 20], size_m = [0.4, 0.4, 0.4], yaw_deg = 20 }",
            "box = { center_m = [5000, 0, 1], size_m = [1, 1, 2] }",
            "cylinder = { base_m = [5, 0, -9], radius_m = 1, height_m = 2 }",
        ] {
            let more = format!("[[world.obstacles]]\nname = \"lost\"\nmaterial = \"metal\"\nshape.{shape}\n");
            let found = warning(&reflecting(law, &more));
            assert!(
                found.contains("`world.obstacles[5]`: the obstacle `lost` blocks nothing"),
                "{law} {shape}: {found}"
            );
            assert!(!found.contains("more"), "{law} {shape}: {found}");
        }
        // What stands in the way of a reflection only, and a volume that dims it.
        for more in ["material = \"wood\"", "solid = false\nloss_db = 3.0"] {
            let more = format!(
                "[[world.obstacles]]\n{more}\nshape.box = {{ center_m = [3.5, -2, 1], size_m = [9, 0.3, 2] }}\n"
            );
            assert_eq!(warning(&reflecting(law, &more)), "", "{law}: {more}");
        }
    }
}

#[test]
fn an_obstacle_before_a_source_of_noise_or_in_the_way_of_a_target_blocks_something() {
    let folder = folder();
    let warning = |text: &str| idle(&told(folder.path(), text, &["check", "a.toml"]).2);
    let aside = world("box = { center_m = [5.0, 20.0, 1.0], size_m = [1.0, 3.0, 2.0] }");
    assert!(warning(&aside).contains("blocks nothing"), "{}", warning(&aside));
    let with = |table: &str| warning(&aside.replace("[radio]", &format!("{table}\n[radio]")));
    let target = |motion: &str| format!("[[world.targets]]\nname = \"thief\"\nmotion.{motion}");
    for table in [
        "[[interferers]]\nname = \"oven\"\nposition_m = [5, 30]\npower_dbm = 10\nchannel = 11".to_owned(),
        target("waypoints = { places_m = [[3, 20], [9, 40]], speed_m_per_s = 1.0 }"),
        target(
            "random_walk = { start_m = [5, 12], straight.mean_m = 3.0, region.rectangle = { min_m = [0, 10], max_m = [10, 30] }, speed_m_per_s = 1.0 }",
        ),
    ] {
        assert_eq!(with(&table), "", "{table}");
    }
    // Those that are elsewhere change nothing.
    let elsewhere = target("waypoints = { places_m = [[3, -20]], speed_m_per_s = 1.0 }");
    assert!(with(&elsewhere).contains("blocks nothing"));
}
