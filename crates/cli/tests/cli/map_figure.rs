//! `sextant map --figure`: the pictures of maps that were computed from a log.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use assert_cmd::cargo::cargo_bin_cmd;

use crate::program::{Said, call, scenario};

/// The colour of the outlines of 95 % regions in SVG files.
const REGION: &str = "#8FB8D8";
/// The nodes of [`survey`]; one was never heard.
const NODES: [(&str, f64, f64); 5] =
    [("hall", 1.0, 1.0), ("oven", 5.0, 1.0), ("lamp", 2.0, 4.0), ("a<b&c", 6.0, 4.0), ("mute", 50.0, 50.0)];

/// A log of three lanes at these heights; a node is heard with more packets the nearer the stop is.
fn survey(heights_m: [f64; 3]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("there is room");
    let (mut stops, mut receptions) = ("stop,t_s,x_m,y_m,z_m\n".to_owned(), "node,stop,received,sent\n".to_owned());
    for stop in 0..27_u8 {
        let (x_m, y_m, z_m) = (f64::from(stop % 9), 2.5 * f64::from(stop / 9), heights_m[usize::from(stop / 9)]);
        writeln!(stops, "{stop},{stop},{x_m},{y_m},{z_m}").expect("a string grows");
        for (name, node_x_m, node_y_m) in NODES {
            let received = (10.0 - 3.0 * f64::hypot(x_m - node_x_m, y_m - node_y_m)).max(0.0).round();
            writeln!(receptions, "{name},{stop},{received},10").expect("a string grows");
        }
    }
    let truth = "node,x_m,y_m\nhall,1,1\noven,5,1\nlamp,2,4\nmute,50,50\n".to_owned();
    for (name, text) in [("stops.csv", stops), ("receptions.csv", receptions), ("nodes.csv", truth)] {
        fs::write(folder.path().join(name), text).expect("there is room");
    }
    folder
}

/// Exit code, standard output and standard error of `sextant map WORDS` in `folder`.
fn map(folder: &Path, words: &[&str]) -> Output {
    call(folder, &[&["map"], words].concat())
}

/// The figures that are in `folder`, sorted.
fn files(folder: &Path) -> Vec<String> {
    let name = |entry: fs::DirEntry| entry.file_name().into_string().expect("a plain name");
    let mut files: Vec<_> =
        fs::read_dir(folder).expect("a folder").map(|entry| name(entry.expect("a file"))).collect();
    files.sort();
    files
}

/// The texts of an SVG file, which must be well-formed: tags are closed in the order in which they were opened.
fn texts(path: &Path) -> Vec<String> {
    let svg = fs::read_to_string(path).expect("a figure");
    let (mut open, mut texts) = (Vec::new(), Vec::new());
    for piece in svg.split('<').skip(1) {
        let (tag, text) = piece.split_once('>').expect("a tag ends");
        assert!(!tag.contains('&') && text.split('&').skip(1).all(|rest| rest.contains(';')), "{piece}");
        let name = |tag: &str| tag.split_whitespace().next().expect("a tag has a name").to_owned();
        if let Some(closed) = tag.strip_prefix('/') {
            assert_eq!(open.pop(), Some(closed.to_owned()), "{path:?}");
        } else if !tag.ends_with('/') && !tag.starts_with(['?', '!']) {
            open.push(name(tag));
        }
        if !text.trim().is_empty() {
            texts.push(text.trim().to_owned());
        }
    }
    assert!(open.is_empty() && svg.starts_with("<svg"), "{path:?}: {open:?}");
    texts
}

/// Number of outlines of regions, without the one of the legend.
fn regions(path: &Path) -> usize {
    fs::read_to_string(path).expect("a figure").matches(&format!("stroke=\"{REGION}\"")).count() - 1
}

#[test]
fn a_log_is_drawn_with_names_regions_curve_and_residuals() {
    let folder = survey([0.0; 3]);
    let stdout =
        map(folder.path(), &[".", "--algorithm", "ml-tm", "--truth", "nodes.csv", "--figure", "new/figures"])
            .printed();
    let figures = folder.path().join("new/figures");
    let expected = ["connectivity-cdf", "curve-ml-tm", "error-cdf", "map-ml-tm", "network", "residuals-ml-tm"];
    let expected = expected.map(|name| format!("{name}.svg"));
    assert_eq!(files(&figures), expected);
    let mut told: Vec<&Path> = stdout.lines().filter(|line| line.ends_with(".svg")).map(Path::new).collect();
    told.sort();
    assert_eq!(told, expected.iter().map(|name| Path::new("new/figures").join(name)).collect::<Vec<PathBuf>>());
    for file in &expected {
        texts(&figures.join(file));
    }
    let map = texts(&figures.join("map-ml-tm.svg"));
    for name in ["hall", "oven", "lamp", "a&lt;b&amp;c", "its 95 % region", "node without a true position", "x [m]"] {
        assert!(map.iter().any(|text| text == name), "{name}: {map:?}");
    }
    assert!(!map.iter().any(|text| text == "mute"), "it is not on the map");
    assert!(map[0].starts_with("ml-tm: 4 of 5 nodes mapped, mean error"), "{map:?}");
    assert_eq!(regions(&figures.join("map-ml-tm.svg")), 4);
    let curve = texts(&figures.join("curve-ml-tm.svg"));
    assert!(curve.iter().any(|text| text == "fitted curve") && curve.iter().any(|text| text.ends_with("[m]")));
    // Four mapped nodes and 27 stops.
    assert!(curve.iter().any(|text| text.contains("108 pairs")), "{curve:?}");
    let residuals = texts(&figures.join("residuals-ml-tm.svg"));
    for text in ["more than expected (+)", "fewer than expected (\u{2212})"] {
        assert!(residuals.iter().any(|other| other == text), "{residuals:?}");
    }
}

#[test]
fn without_truth_and_in_space_the_map_is_drawn_from_two_sides() {
    let folder = survey([0.0, 2.0, 4.0]);
    let words =
        [".", "--figure", ".", "--figure-format", "svg", "--algorithm", "self-calibrated", "--format", "json"];
    let (code, stdout, stderr) = map(folder.path(), &words).all();
    assert_eq!(code, 0, "{stderr}");
    assert!(stdout.starts_with('{') && stdout.trim_end().ends_with('}'), "standard output is JSON alone: {stdout}");
    assert!(stderr.contains("note: wrote ./map-self-calibrated.svg"), "{stderr}");
    let map = texts(&folder.path().join("map-self-calibrated.svg"));
    for text in ["projection of its 95 % region", "y [m]", "z [m]", "hall"] {
        assert!(map.iter().any(|other| other == text), "{text}: {map:?}");
    }
    assert!(map[1].contains("true positions unknown; seen from above and from the side"), "{map:?}");
    assert!(!folder.path().join("error-cdf.svg").exists());
}

#[test]
fn each_map_of_a_recording_has_its_pictures() {
    let folder = tempfile::tempdir().expect("there is room");
    let smoke = scenario("smoke.toml");
    let text = format!(
        "extends = '{}'\n[[maps]]\nname = \"given\"\n\
         algorithm.ml_tm = {{ grid_step_m = 0.5, profile.trapezoid = {{ p0 = 0.9, plateau_m = 1.0, range_m = 6.0 }} }}\n\
         [[maps]]\nname = \"own\"\nalgorithm.self_calibrated = {{}}\n",
        smoke.display()
    );
    fs::write(folder.path().join("two.toml"), text).expect("there is room");
    let mut run = cargo_bin_cmd!("sextant");
    run.args(["run", "two.toml", "--out", "two.mcap", "--quiet"]).current_dir(folder.path()).assert().success();
    map(folder.path(), &["two.mcap", "--figure", "figs", "--figure-format", "png"]).printed();
    let names = [
        "connectivity-cdf",
        "curve-given",
        "curve-own",
        "error-cdf",
        "map-given",
        "map-own",
        "network",
        "residuals-given",
        "residuals-own",
    ];
    let figures = folder.path().join("figs");
    assert_eq!(files(&figures), names.map(|name| format!("{name}.png")));
    for name in names {
        let png = fs::read(figures.join(format!("{name}.png"))).expect("a figure");
        assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
        assert_eq!(png[png.len() - 8..png.len() - 4], *b"IEND");
    }
}

#[test]
fn obstacles_that_a_map_claims_are_drawn_and_told() {
    let folder = tempfile::tempdir().expect("there is room");
    let mut run = cargo_bin_cmd!("sextant");
    run.arg("run").arg(scenario("ml-tm/circular.toml")).args(["--out", "run.mcap", "--quiet"]);
    run.args(["--set", "maps=[]", "--set", "world.nodes.lattice.spacing_m=2.0"]);
    run.args(["--set", "world.nodes.lattice.count=110", "--set", "robots.0.controller.automated_s.step_m=2.0"]);
    run.current_dir(folder.path()).assert().success();
    let words = ["run.mcap", "--algorithm", "self-calibrated", "--figure", "f", "--summary", "map.json"];
    let table = map(folder.path(), &words).printed();
    let summary = fs::read_to_string(folder.path().join("map.json")).expect("a summary");
    let summary: serde_json::Value = serde_json::from_str(&summary).expect("JSON");
    let area_m2 = summary["maps"][0]["calibration"]["absorbing_m2"].as_f64().expect("an area");
    // Three blocks of concrete with 57.5 m²: what is claimed is of their size, and the table has the same number.
    assert!(area_m2 > 15.0 && area_m2 < 80.0, "{area_m2} m²");
    assert!(table.contains(&format!("{area_m2:.1} m² of obstacles found")), "{table}");
    let figure = texts(&folder.path().join("f/map-self-calibrated.svg"));
    assert!(figure.iter().any(|text| text == "obstacle that the log shows"), "{figure:?}");
}

#[test]
fn a_folder_that_cannot_be_written_is_rejected_before_the_work() {
    let folder = survey([0.0; 3]);
    let (code, stdout, stderr) =
        map(folder.path(), &[".", "--figure", "stops.csv/figures", "--out", "map.csv"]).all();
    assert_eq!((code, stdout.as_str()), (1, ""), "{stderr}");
    assert!(stderr.contains("`stops.csv/figures` cannot be written"), "{stderr}");
    assert!(!folder.path().join("map.csv").exists(), "no map was computed");
    let stderr = map(folder.path(), &[".", "--figure-format", "png"]).refusal();
    assert!(stderr.contains("--figure <DIR>"), "{stderr}");
}
