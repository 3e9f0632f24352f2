//! `sextant map` with the true positions of some nodes, and what it says of a log.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::program::{Said, call};

/// Places of the nodes of [`survey`]; the last one was never heard.
const NODES: [(&str, f64, f64); 7] = [
    ("a", 1.0, 1.0),
    ("b", 5.0, 1.0),
    ("c", 2.0, 4.0),
    ("d", 6.0, 4.0),
    ("e", 3.0, 1.5),
    ("f", 7.0, 2.0),
    ("far", 90.0, 90.0),
];

/// A log of three lanes; a node is heard at the stops within 2 m.
fn survey() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("there is room");
    let (mut stops, mut receptions) = ("stop,t_s,x_m,y_m\n".to_owned(), "node,stop,received,sent\n".to_owned());
    for stop in 0..27_u8 {
        let (x_m, y_m) = (f64::from(stop % 9), 2.5 * f64::from(stop / 9));
        writeln!(stops, "{stop},{stop},{x_m},{y_m}").expect("a string grows");
        for (name, node_x_m, node_y_m) in NODES {
            let received = u8::from(f64::hypot(x_m - node_x_m, y_m - node_y_m) <= 2.0);
            writeln!(receptions, "{name},{stop},{received},1").expect("a string grows");
        }
    }
    write(folder.path(), "stops.csv", &stops);
    write(folder.path(), "receptions.csv", &receptions);
    folder
}

fn write(folder: &Path, name: &str, text: &str) {
    std::fs::write(folder.join(name), text).expect("there is room");
}

/// Writes the true positions of the nodes with these names.
fn write_truth(folder: &Path, names: &[&str]) {
    let mut truth = "node,x_m,y_m\n".to_owned();
    for (name, x_m, y_m) in NODES.iter().filter(|node| names.contains(&node.0)) {
        writeln!(truth, "{name},{x_m},{y_m}").expect("a string grows");
    }
    write(folder, "nodes.csv", &truth);
}

/// Standard output and standard error of `sextant map . --truth nodes.csv WORDS` in `folder`.
fn map(folder: &Path, words: &[&str]) -> (String, String) {
    let always = ["map", ".", "--profile", "p0=0.9,plateau_m=1,range_m=3", "--truth", "nodes.csv"];
    let (code, printed, message) = call(folder, &[&always, words].concat()).all();
    assert_eq!(code, 0, "{message}");
    (printed, message)
}

fn json(folder: &Path) -> (Value, String) {
    let (stdout, stderr) = map(folder, &["--format", "json", "--out", "map.csv"]);
    (serde_json::from_str(&stdout).expect("the output is JSON"), stderr)
}

/// The distance of each mapped node of `map.csv` from its place in [`NODES`].
fn errors_m(folder: &Path) -> BTreeMap<String, f64> {
    let text = std::fs::read_to_string(folder.join("map.csv")).expect("a map");
    let mut errors_m = BTreeMap::new();
    for line in text.lines().skip(1) {
        let cells: Vec<&str> = line.split(',').collect();
        let (Ok(x_m), Ok(y_m)) = (cells[1].parse::<f64>(), cells[2].parse::<f64>()) else { continue };
        let truth = NODES.iter().find(|node| node.0 == cells[0]).expect("a node of the log");
        errors_m.insert(cells[0].to_owned(), f64::hypot(x_m - truth.1, y_m - truth.2));
    }
    errors_m
}

#[test]
fn nodes_whose_true_positions_are_known_are_measured() {
    let folder = survey();
    let known = ["a", "c", "d", "f"];
    write_truth(folder.path(), &known);
    let (summary, stderr) = json(folder.path());
    let found = &summary["maps"][0];
    assert_eq!((&found["mapped"], &found["measured"]), (&6.into(), &4.into()), "{found:#}");
    let errors_m = errors_m(folder.path());
    let mean_m = known.iter().map(|name| errors_m[*name]).sum::<f64>() / 4.0;
    let max_m = known.iter().map(|name| errors_m[*name]).fold(0.0, f64::max);
    let told = |key: &str| found["position_error_m"][key].as_f64().expect("an error");
    assert!((told("mean") - mean_m).abs() < 1e-6 && (told("max") - max_m).abs() < 1e-6, "{found:#}");
    // Four nodes suffice for the other measures.
    assert!(found["aligned_error_m"]["mean"].as_f64().expect("an error") <= told("mean") + 1e-9);
    assert_eq!(
        found["position_error_cdf"][14],
        serde_json::json!([20.0, 1.0]),
        "only these four are sought: {found:#}"
    );
    assert!(found["connectivity_errors"].is_array(), "{found:#}");
    let note = "the true positions of 3 of 7 nodes are unknown (b, e, far): only the other 4 are measured";
    assert!(stderr.contains(note), "{stderr}");
    let notes = summary["notes"].as_array().expect("a list");
    assert!(notes.iter().any(|told| told == note), "{notes:?}");
    let (text, _) = map(folder.path(), &[]);
    assert!(text.contains("errors of 4 of 6 mapped nodes: those whose true positions are known"), "{text}");
}

#[test]
fn the_same_truth_of_all_nodes_counts_no_measured_nodes() {
    let folder = survey();
    write_truth(folder.path(), &NODES.map(|node| node.0));
    let (summary, _) = json(folder.path());
    let map = &summary["maps"][0];
    assert_eq!(map.get("measured"), None, "{map:#}");
    let errors_m = errors_m(folder.path());
    let mean_m = errors_m.values().sum::<f64>() / 6.0;
    assert!((map["position_error_m"]["mean"].as_f64().expect("an error") - mean_m).abs() < 1e-6);
    // The node that was never heard counts as infinitely far.
    assert!((map["position_error_cdf"][14][1].as_f64().expect("a share") - 6.0 / 7.0).abs() < 1e-12);
}

#[test]
fn true_positions_of_strangers_and_nodes_that_were_never_heard_are_told() {
    let folder = survey();
    write(folder.path(), "nodes.csv", "node,x_m,y_m\na,1,1\nghost,3,3\nlamp,4,4\n");
    let (summary, stderr) = json(folder.path());
    assert_eq!(summary["maps"][0]["measured"], 1);
    for note in [
        "2 nodes with a true position are not in the log, so they are not measured: ghost, lamp",
        "only the other node is measured",
        "1 of 7 nodes was never heard by a robot: far",
    ] {
        assert!(stderr.contains(note), "{stderr}");
        let notes = summary["notes"].as_array().expect("a list");
        assert!(notes.iter().any(|told| told.as_str().is_some_and(|told| told.contains(note))), "{notes:?}");
    }
    write(folder.path(), "nodes.csv", "node,x_m,y_m\nghost,3,3\n");
    let (summary, stderr) = json(folder.path());
    assert_eq!(summary["maps"][0].get("position_error_m"), None);
    assert!(stderr.contains("the true positions of 7 of 7 nodes are unknown"), "{stderr}");
}
