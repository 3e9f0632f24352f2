//! Nodes that move: what is refused, and where.

use std::fs;

use crate::two_nodes::told_in;

/// Exit code, and standard output and standard error together, of `sextant check` with `more` at the end of the scenario.
fn checked(more: &str) -> (Option<i32>, String) {
    let folder = tempfile::tempdir().expect("there is room");
    fs::write(folder.path().join("ways.csv"), "t_s,node,x_m,y_m\n0,a,1,1\n9,a,2,2\n").expect("there is room");
    told_in(folder.path(), more, &["check", "a.toml"])
}

#[test]
fn wrong_motions_are_refused_with_what_is_allowed() {
    let wanders = |settings: &str| {
        format!(
            "[[world.motions]]\nnodes.count = 1\n[world.motions.motion.random_waypoint]\nmin_m = [0, 0]\nmax_m = [9, 9]\n{settings}"
        )
    };
    let by_file = "[[world.motions]]\nnodes.names = [\"a\"]\nmotion.file = { file = \"ways.csv\" }\n";
    assert_eq!(checked(by_file).0, Some(0));
    for (more, message) in [
        (wanders("speed_m_per_s = [0.0, 2.0]\n"), "speed_m_per_s[0]` is 0; allowed: 0.001 to"),
        (wanders("speed_m_per_s = [2.0, 1.0]\n"), "speed_m_per_s[1]` is 1; allowed: 2 to"),
        (wanders("speed_m_per_s = [1.0, 1.0]\npause_s = -1.0\n"), "pause_s` is -1; allowed: 0 to"),
        (by_file.replace("\"a\"", "\"b\""), "node `b`: no place"),
        (by_file.replace("\"a\"", "\"c\""), "is `c`; allowed: the name of a node"),
        (by_file.replace("ways.csv\"", "ways.csv\", format = \"bonnmotion\""), "line 1: `t_s,node,x_m,y_m`"),
        (format!("{by_file}{by_file}"), "a node that is in no group before"),
        (
            "[[world.motions]]\nnodes.others = {}\nmotion.waypoints = { places_m = [[0, 0], [9, 0]], speed_m_per_s = 1.0, at_end = \"leave\" }\n".to_owned(),
            "`stay` or `loop`",
        ),
    ] {
        let (code, text) = checked(&more);
        assert_eq!(code, Some(2), "{more}: {text}");
        assert!(text.contains(message), "{more}: {text}");
    }
}

#[test]
fn what_takes_nodes_to_stand_is_refused_beside_nodes_that_move() {
    let moves = "[[world.motions]]\nnodes.names = [\"a\"]\nmotion.file = { file = \"ways.csv\" }\n";
    let robot = "[[robots]]\nname = \"rover\"\nstart_m = [1, 1]\n[robots.controller.waypoints]\nplaces_m = [[1, 1], [9, 1]]\n";
    let (code, text) = checked(&format!("{moves}{robot}"));
    assert_eq!(code, Some(2));
    assert!(text.contains("`world.motions`") && text.contains("a robot that surveys"), "{text}");
}
