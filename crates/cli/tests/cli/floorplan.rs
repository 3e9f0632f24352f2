//! `sextant floorplan`: walls from a plan, and a survey among them.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fs;
use std::path::Path;
use std::process::Output;

use super::program::{Said, call, sextant, unwrapped};

/// A room of 6 by 4 m with walls of 0.2 m and a door of 0.9 m, 5 cm a pixel, as a grey map in text.
fn room() -> String {
    let (width, height) = (140, 100);
    let walls = [[10, 10, 120, 4], [10, 86, 50, 4], [78, 86, 52, 4], [10, 10, 4, 80], [126, 10, 4, 80]]
        .map(|[x, y, w, h]| move |column: i32, row: i32| (x..x + w).contains(&column) && (y..y + h).contains(&row));
    let pixel = |row: i32, column: i32| if walls.iter().any(|is_wall| is_wall(column, row)) { "0" } else { "254" };
    let rows = (0..height).map(|row| (0..width).map(|column| pixel(row, column)).collect::<Vec<_>>().join(" "));
    format!("P2\n{width} {height}\n255\n{}\n", rows.collect::<Vec<_>>().join("\n"))
}

fn floorplan(folder: &Path, words: &[&str]) -> Output {
    sextant().arg("floorplan").args(words).current_dir(folder).output().unwrap()
}

#[test]
fn a_robot_drives_through_the_door_of_a_traced_room() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("room.pgm"), room()).unwrap();
    fs::write(path.join("map.yaml"), "image: room.pgm\nresolution: 0.05\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\n")
        .unwrap();
    let (code, text, notes) = floorplan(path, &["map.yaml", "--material", "concrete"]).all();
    assert!(code == 0 && text.contains("1 wall of 18.") && text.contains("m in all, 0 blocks"), "{text}{notes}");
    assert!(notes.contains("note: the plan is 7.0 by 5.0 m") && notes.contains("% of the dark area"), "{notes}");
    let scenario = "extends = \"walls.toml\"\nname = \"room\"\n\
        [world.nodes.explicit]\nnames = [\"in\"]\npositions_m = [[1.0, 5.0]]\n\
        [radio]\ntx_power_dbm = 0\nsensitivity_dbm = -90\n\
        [channel]\npath_loss.log_distance = { exponent = 2.0, reference_loss_db = 40 }\nshadowing.sigma_db = 0\n\
        [traffic.periodic]\ninterval_s = 1\nmpdu_octets = 20\n\
        [[robots]]\nname = \"r\"\nstart_m = [2.45, 1.5]\nspeed_m_per_s = 1\nlisten_s = 1.5\nradius_m = 0.2\n\
        [robots.controller.waypoints]\nplaces_m = [[1.0, 4.0]]\n";
    fs::write(path.join("room.toml"), scenario).unwrap();
    let run = |words: &[&str]| call(path, words).printed();
    let checked = run(&["check", "room.toml"]);
    assert!(checked.contains("1 node, 0 obstacles, 1 wall"), "{checked}");
    let summary = call(path, &["run", "room.toml", "--quiet", "--format", "json"]).json();
    // Through the door, and not round the walls.
    let length_m = summary["gathering"]["path_length_m"].as_f64().unwrap();
    assert!(length_m > 2.8 && length_m < 3.6, "{length_m}");
    let link = run(&["explain-link", "room.toml", "in", "r"]);
    assert!(link.contains("wall"), "{link}");
}

#[test]
fn plans_that_cannot_be_read_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("room.pgm"), room()).unwrap();
    fs::write(path.join("white.pgm"), "P2 2 2 255 255 255 255 255").unwrap();
    fs::write(path.join("room.bmp"), "BM").unwrap();
    let line = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nwalls\n10\n0\n20\n0\n11\n4000\n21\n0\n0\nENDSEC\n0\nEOF\n";
    fs::write(path.join("hall.dxf"), line).unwrap();
    let text = floorplan(path, &["hall.dxf", "--unit", "mm", "--layers", "walls", "--out", "-"]).printed();
    assert!(text.contains("[[world.walls]]") && text.contains("4.0"), "{text}");
    for (words, problem) in [
        (&["room.pgm"][..], "--scale 0.02 is 2 cm a pixel"),
        (&["room.pgm", "--scale", "0"], "option `scale` is 0; allowed: a number of metres above 0"),
        (&["room.pgm", "--scale", "0.05", "--material", "cheese"], "cheese; allowed: \"concrete\""),
        (&["room.pgm", "--scale", "0.05", "--origin", "1"], "`--origin` has 1 numbers; allowed: two"),
        (
            &["white.pgm", "--scale", "0.05"],
            "pixels darker than 128 of 255 are walls; 0.0 % of the pixels are at 128 to 191",
        ),
        (&["room.bmp"], "is not a floor plan that can be read; allowed: an image (.png, .pgm)"),
        (&["none.png", "--scale", "0.05"], "cannot read `none.png`"),
        (&["hall.dxf"], "does not say the unit of its lengths ($INSUNITS): option `unit` says it"),
        (
            &["hall.dxf", "--unit", "mm", "--layers", "roof"],
            "option `layers` is roof; allowed: layers with lines: walls",
        ),
    ] {
        let (code, _, found) = floorplan(path, words).all();
        assert!(code != 0 && unwrapped(&found).contains(problem), "{words:?}: {found}");
    }
    // A reference system whose unit is not known, until the unit is given.
    let feet =
        r#"{"type": "LineString", "crs": {"properties": {"name": "EPSG:2263"}}, "coordinates": [[0, 0], [100, 0]]}"#;
    fs::write(path.join("feet.geojson"), feet).unwrap();
    let found = floorplan(path, &["feet.geojson"]).refusal();
    assert!(found.contains("EPSG:2263") && found.contains("option `unit`"), "{found}");
    let read = floorplan(path, &["feet.geojson", "--unit", "us-ft", "--out", "-"]).printed();
    assert!(read.contains("30.48"), "{read}");
    // A drawing has no dark walls.
    fs::write(path.join("empty.dxf"), "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n").unwrap();
    let found = floorplan(path, &["empty.dxf", "--unit", "m"]).refusal();
    assert!(found.contains("has no walls") && !found.contains("--thickest"), "{found}");
    // What people changed is not replaced.
    fs::write(path.join("walls.toml"), "# mine\n").unwrap();
    assert!(floorplan(path, &["room.pgm", "--scale", "0.05"]).refusal().contains("walls.toml"));
    assert_eq!(fs::read_to_string(path.join("walls.toml")).unwrap(), "# mine\n");
}
