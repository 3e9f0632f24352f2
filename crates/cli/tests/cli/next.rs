//! `sextant next`: where to drive next.

#![expect(clippy::unwrap_used, reason = "a test fails at the first error")]

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Output;

use super::program::{Said, sextant};

/// A log in `folder`: a way along y = 0 with a stop each 2 m, and nodes beside it that are heard less the farther they are.
fn write_log(folder: &Path, stops: usize) {
    fs::create_dir_all(folder).unwrap();
    let mut stop_rows = String::from("stop,t_s,x_m,y_m,z_m\n");
    let mut rows = String::from("node,stop,received,sent\n");
    for stop in 0..stops {
        let x = 2.0 * stop as f64;
        writeln!(stop_rows, "s{stop},{},{x},0,0", 10 * stop).unwrap();
        for node in 0..6_u32 {
            let (node_x, node_y) = (3.0 + 4.0 * f64::from(node), [3.0, -2.0, 5.0][node as usize % 3]);
            let share = (1.2 - f64::hypot(x - node_x, node_y) / 9.0).clamp(0.0, 1.0);
            writeln!(rows, "n{node},s{stop},{},10", (10.0 * share).round()).unwrap();
        }
    }
    fs::write(folder.join("stops.csv"), stop_rows).unwrap();
    fs::write(folder.join("receptions.csv"), rows).unwrap();
}

fn next(folder: &Path, words: &[&str]) -> Output {
    sextant().arg("next").args(words).current_dir(folder).output().unwrap()
}

fn found(folder: &Path, words: &[&str]) -> serde_json::Value {
    next(folder, &[words, &["--format", "json", "--quiet"]].concat()).json()
}

fn places(found: &serde_json::Value) -> Vec<[f64; 2]> {
    let stops = found["stops"].as_array().unwrap();
    stops.iter().map(|stop| ["x_m", "y_m"].map(|key| stop[key].as_f64().unwrap())).collect()
}

#[test]
fn stops_are_beside_the_way_and_within_the_area() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_log(&path.join("log"), 14);
    let words = ["log", "--algorithm", "link-model", "--area", "0,-6,26,8", "--stops", "4"];
    let json = found(path, &words);
    let stops = places(&json);
    assert!((1..=4).contains(&stops.len()), "{json}");
    assert!(stops.iter().all(|[x, y]| (0.0..=26.0).contains(x) && (-6.0..=8.0).contains(y)), "{stops:?}");
    // On the way nothing tells the side; beside it, it is told.
    assert!(stops.iter().any(|[_, y]| y.abs() > 1.0), "{stops:?}");
    let number = |key: &str| json[key].as_f64().unwrap();
    let falls = json["stops"].as_array().unwrap().iter().map(|stop| stop["error_fall_m"].as_f64().unwrap());
    assert!((number("error_m") - falls.sum::<f64>() - number("error_after_m")).abs() < 1e-9);
    // 2 m in 10 s, and no two lengths of way that tell listening apart.
    assert!((json["pace"]["speed_m_per_s"].as_f64().unwrap() - 0.2).abs() < 1e-9);
    let table = next(path, &[&words[..], &["--out", "next.csv"]].concat());
    let text = String::from_utf8_lossy(&table.stdout);
    assert!(text.contains("nodes that gain") && text.contains("the expected error falls from"), "{text}");
    let csv = fs::read_to_string(path.join("next.csv")).unwrap();
    assert!(csv.starts_with("stop,t_s,x_m,y_m,z_m\nnext1,") && csv.lines().count() == stops.len() + 1, "{csv}");
    let drawn = next(path, &[&words[..], &["--figure", "pictures"]].concat());
    assert!(String::from_utf8_lossy(&drawn.stdout).ends_with("pictures/next.svg\n"), "{drawn:?}");
    let picture = fs::read_to_string(path.join("pictures/next.svg")).unwrap();
    assert!(picture.contains("next1") && picture.contains("the expected error falls from"), "{picture}");
    let again = next(path, &[&words[..], &["--out", "next.csv"]].concat());
    assert_eq!(again.status.code(), Some(2), "a plan is not replaced without --force");
}

#[test]
fn no_stop_is_behind_a_wall_without_a_door() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_log(&path.join("log"), 14);
    let wall = "[[world.walls]]\npoints_m = [[-9.0, 1.0], [40.0, 1.0]]\nthickness_m = 0.2\nheight_m = 3.0\nmaterial = \"brick\"\n";
    fs::write(path.join("walls.toml"), wall).unwrap();
    let words =
        ["log", "--algorithm", "link-model", "--area", "0,-6,26,8", "--stops", "3", "--floorplan", "walls.toml"];
    let stops = places(&found(path, &words));
    assert!(!stops.is_empty() && stops.iter().all(|[_, y]| *y < 0.7), "{stops:?}");
}

#[test]
fn walls_of_geojson_are_in_the_unit_that_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_log(&path.join("log"), 14);
    // A wall along y = 1 in metres, which as degrees would be larger than a building.
    let wall = r#"{"type": "LineString", "coordinates": [[-9.0, 1.0], [40.0, 1.0]]}"#;
    fs::write(path.join("walls.geojson"), wall).unwrap();
    let words =
        ["log", "--algorithm", "link-model", "--area", "0,-6,26,8", "--stops", "3", "--floorplan", "walls.geojson"];
    let refused = next(path, &words).refusal();
    assert!(
        refused.contains("49.000 by 0.000 degrees") && refused.contains("`--floorplan-unit` says their unit"),
        "{refused}"
    );
    let stops = places(&found(path, &[&words[..], &["--floorplan-unit", "m"]].concat()));
    assert!(!stops.is_empty() && stops.iter().all(|[_, y]| *y < 0.7), "{stops:?}");
    // The same flag of the other commands that lay a plan under a log.
    for (command, out) in [("map", "map.csv"), ("report", "log.html")] {
        let words = [command, "log", "--algorithm", "packet-centroid", "--floorplan", "walls.geojson", "--out", out];
        let call = |more: &[&str]| sextant().args(words).args(more).current_dir(path).output().unwrap();
        assert_eq!(call(&[]).status.code(), Some(2), "{command}");
        call(&["--floorplan-unit", "m"]).printed();
    }
}

#[test]
fn ranges_alone_do_not_tell_where_to_stop() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_log(&path.join("log"), 5);
    let mut rows = String::from("node,stop,range_m\n");
    for (stop, node) in (0..5).flat_map(|stop| (0..3).map(move |node| (stop, node))) {
        writeln!(rows, "n{node},s{stop},{:.3}", f64::hypot(2.0 * f64::from(stop) - 3.0, f64::from(node) + 2.0))
            .unwrap();
    }
    fs::write(path.join("log/ranges.csv"), rows).unwrap();
    let of_ranges = next(path, &["log", "--algorithm", "range-ml"]).refusal();
    assert!(of_ranges.contains("a map that is made of ranges does not tell these"), "{of_ranges}");
    assert!(of_ranges.contains("`link-model`"), "{of_ranges}");
    fs::remove_file(path.join("log/receptions.csv")).unwrap();
    let alone = next(path, &["log"]).refusal();
    assert!(alone.contains("the log has ranges and no packets") && !alone.contains("auto"), "{alone}");
}

#[test]
fn what_is_missing_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    write_log(&path.join("log"), 14);
    write_log(&path.join("one"), 1);
    write_log(&path.join("silent"), 5);
    fs::write(path.join("silent/receptions.csv"), "node,stop,received,sent\nn0,s0,0,5\n").unwrap();
    write_log(&path.join("fixed"), 2);
    fs::write(path.join("fixed/stops.csv"), "stop,t_s,x_m,y_m,z_m,robot\ns0,0,0,0,0,a\ns1,0,9,0,0,b\n").unwrap();
    fs::write(path.join("hall.dxf"), "0\nSECTION\n2\nENTITIES\n0\nENDSEC\n0\nEOF\n").unwrap();
    for (words, problem) in [
        (&["log", "--area", "900,900,910,910", "--algorithm", "link-model"][..], "no node can be heard in the area"),
        (&["log", "--area", "5,5,1,1"], "allowed: four numbers x0,y0,x1,y1"),
        (&["log", "--stops", "0"], "the number of stops is 0; allowed: 1 and more"),
        (&["log", "--speed", "0"], "the speed (m/s) is 0; allowed: a number above 0"),
        (&["log", "--floorplan", "hall.dxf"], "--floorplan-unit mm if a door is about 900 wide"),
        (&["log", "--robot", "bob"], "the robot `bob` is not in the log"),
        (&["log", "--algorithm", "packet-centroid"], "gives places without their covariance"),
        (&["one"], "the log has 1 stop; at least 2"),
        (&["silent"], "no node was heard"),
        (&["fixed"], "nobody drives in this log: it has 2 receivers without a way"),
    ] {
        let error = next(path, words).refusal();
        assert!(error.contains(problem), "{words:?}: {error}");
    }
}
