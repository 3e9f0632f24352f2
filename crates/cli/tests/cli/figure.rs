//! `sextant figure`: figures of a recording.

use std::fs;
use std::path::{Path, PathBuf};

use sextant_channel::{Contact, Obstacle, ObstacleConfig, Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, RobotId, SimTime};
use sextant_recording::{FileRecorder, GridPlane, Origin, PlacedNode, Solid};
use tempfile::TempDir;

const NODES: u32 = 40;
/// Number of nodes that are missing in the second map.
const UNMAPPED: u32 = 3;
const STOPS: u32 = 12;

/// Whether nodes have heights.
#[derive(Clone, Copy, PartialEq)]
enum World {
    Flat,
    Spatial,
}

/// The maps of a recording.
#[derive(Clone, Copy, PartialEq)]
enum Maps {
    None,
    Two,
}

fn truth(world: World) -> Vec<PlacedNode> {
    let place = |i: u32| {
        let (x, y) = (f64::from(i % 8) * 1.5, f64::from(i / 8) * 1.5);
        let z = if world == World::Spatial { f64::from(i % 3) * 1.2 } else { 0.0 };
        PlacedNode { node: NodeId(i), position: Position::new(x, y, z), error_m: None }
    };
    (0..NODES).map(place).collect()
}

fn log() -> ReceptionLog {
    let names = (0..NODES).map(|i| format!("n{i}")).collect();
    let stop = |i: u32| Stop {
        time: SimTime::from_nanos(u64::from(i) * 1_000_000_000),
        ..Stop::at(Position::new(f64::from(i), -1.0, 0.0))
    };
    let stops = (0..STOPS).map(stop).collect();
    let heard = |node: u32| {
        let reception = move |stop: u32| Reception::heard(NodeId(node), stop, 1, 2);
        (0..STOPS).filter(move |stop| (node + stop).is_multiple_of(3)).map(reception)
    };
    let receptions = (0..NODES).flat_map(heard).collect();
    let contact = Contact { robot: RobotId(0), time: SimTime::ZERO, position: Position::new(3.5, 2.0, 0.0) };
    ReceptionLog::new(names, stops, receptions, vec![contact]).expect("a sound log")
}

/// A box and a cylinder.
fn solids() -> Vec<Solid> {
    let shapes = [
        r#"{"box": {"center_m": [4.4, 2.3, 0.0], "size_m": [1.0, 0.8, 3.0], "yaw_deg": 20.0}}"#,
        r#"{"cylinder": {"base_m": [8.0, 5.0, 0.0], "radius_m": 0.6, "height_m": 2.0}}"#,
    ];
    let solid = |(i, shape): (usize, &str)| {
        let json = format!(r#"{{"absorption_per_m": 1.0, "shape": {shape}}}"#);
        let config: ObstacleConfig = serde_json::from_str(&json).expect("an obstacle");
        Solid::of(&Obstacle::try_from(config).expect("a sound obstacle"), i)
    };
    shapes.into_iter().enumerate().map(solid).collect()
}

fn record(path: &Path, world: World, maps: Maps) {
    let mut recorder = FileRecorder::create(path).expect("a folder");
    recorder.origin(Origin { scenario: "sample", seed: 1, version: "1.2.3" }).expect("room");
    recorder.obstacles(SimTime::ZERO, &solids()).expect("room");
    let truth = truth(world);
    recorder.world_nodes(SimTime::ZERO, &truth).expect("room");
    let log = log();
    recorder.log(&log).expect("room");
    let places: Vec<_> = log.stops().iter().map(|stop| stop.position).collect();
    recorder.path(SimTime::ZERO, "surveyor", &places).expect("room");
    if maps == Maps::Two {
        let end = SimTime::from_nanos(1);
        let shifted = |by: f64| {
            let place = move |node: &PlacedNode| {
                let error_m = by * f64::from(node.node.0) / f64::from(NODES);
                let position = node.position + Position::new(error_m, 0.0, 0.0);
                PlacedNode { position, error_m: Some(error_m), ..*node }
            };
            truth.iter().map(place).collect::<Vec<_>>()
        };
        recorder.map(end, "ml-tm", &shifted(1.0)).expect("room");
        recorder.map(end, "dv-hop", &shifted(3.0)[UNMAPPED as usize..]).expect("room");
        let log_likelihood = (0..400_u32).map(|i| {
            let (x, y) = (f64::from(i % 20) - 12.0, f64::from(i / 20) - 7.0);
            if x * x + y * y > 150.0 { f64::NEG_INFINITY } else { -0.2 * (x * x + y * y) }
        });
        let first = Position::new(0.0, 0.0, 0.0);
        let plane = GridPlane { first, step_m: 0.25, columns: 20, values: log_likelihood.collect() };
        recorder.likelihood(end, "ml-tm", "n10", &plane).expect("room");
    }
    recorder.finish().expect("room");
}

/// A recording in a temporary folder.
fn recording(world: World, maps: Maps) -> (TempDir, PathBuf) {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    record(&path, world, maps);
    (folder, path)
}

fn sextant(arguments: &[&Path]) -> assert_cmd::assert::Assert {
    assert_cmd::cargo::cargo_bin_cmd!("sextant").arg("figure").args(arguments).assert()
}

/// The lines that a command printed.
fn lines(output: &[u8]) -> Vec<PathBuf> {
    String::from_utf8_lossy(output).lines().map(PathBuf::from).collect()
}

fn text(path: &Path) -> String {
    fs::read_to_string(path).expect("a figure")
}

fn count(svg: &str, tag: &str) -> usize {
    svg.matches(tag).count()
}

#[test]
fn every_figure_is_written_and_printed() {
    let (folder, path) = recording(World::Flat, Maps::Two);
    let drawn = sextant(&[&path]).success();
    let figures = folder.path().join("run.figures");
    let names = ["network", "map-ml-tm", "map-dv-hop", "error-cdf", "connectivity-cdf", "likelihood-ml-tm-n10"];
    let expected: Vec<_> = names.iter().map(|name| figures.join(format!("{name}.svg"))).collect();
    assert_eq!(lines(&drawn.get_output().stdout), expected);
    let mut found: Vec<_> = fs::read_dir(&figures).expect("a folder").map(|entry| entry.expect("").path()).collect();
    found.sort();
    let mut expected = expected;
    expected.sort();
    assert_eq!(found, expected, "nothing else is left in the folder");
}

#[test]
fn a_picture_has_a_circle_for_each_node_and_one_in_the_legend() {
    let (folder, path) = recording(World::Flat, Maps::Two);
    sextant(&[&path, "--out".as_ref(), folder.path()]).success();
    let circles = |name: &str| count(&text(&folder.path().join(name)), "<circle");
    assert_eq!(circles("network.svg"), NODES as usize + 1);
    assert_eq!(circles("map-ml-tm.svg"), NODES as usize + 1);
    assert_eq!(circles("map-dv-hop.svg"), (NODES - UNMAPPED) as usize + 1);
    // A median for each map.
    assert_eq!(circles("error-cdf.svg"), 2);
    assert_eq!(circles("connectivity-cdf.svg"), 2);
}

#[test]
fn titles_give_the_number_of_mapped_nodes_and_the_error() {
    let (folder, path) = recording(World::Flat, Maps::Two);
    sextant(&[&path, "--out".as_ref(), folder.path()]).success();
    // The error of node i of 40 is i / 40 m, so the mean is 39 / 80 m.
    assert!(text(&folder.path().join("map-ml-tm.svg")).contains("ml-tm: 40 of 40 nodes mapped, mean error 0.49 m"));
    let lacking = text(&folder.path().join("map-dv-hop.svg"));
    assert!(lacking.contains("dv-hop: 37 of 40 nodes mapped") && lacking.contains("node that is not mapped"));
    let distribution = text(&folder.path().join("error-cdf.svg"));
    assert!(distribution.contains("ml-tm: median 0.49 m") && distribution.contains("37 of 40 nodes"));
}

#[test]
fn the_same_recording_gives_the_same_bytes_and_a_png_has_twice_the_pixels_of_its_svg_in_each_direction() {
    let (folder, path) = recording(World::Spatial, Maps::Two);
    for format in ["svg", "png"] {
        let [first, second] = ["first", "second"].map(|name| folder.path().join(name));
        for out in [&first, &second] {
            sextant(&[&path, "--out".as_ref(), out, "--format".as_ref(), format.as_ref()]).success();
        }
        for name in ["network", "map-ml-tm", "map-dv-hop", "error-cdf", "connectivity-cdf", "likelihood-ml-tm-n10"] {
            let file = format!("{name}.{format}");
            let [a, b] = [&first, &second].map(|out| fs::read(out.join(&file)).expect("a figure"));
            assert!(a == b && !a.is_empty(), "{file}");
        }
    }
    let first = folder.path().join("first");
    let png = fs::read(first.join("network.png")).expect("a figure");
    assert_eq!(png[..8], *b"\x89PNG\r\n\x1a\n");
    assert_eq!(png[12..16], *b"IHDR");
    assert_eq!(png[png.len() - 8..png.len() - 4], *b"IEND");
    let number = |at: usize| u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]);
    let size = format!("width=\"{}\" height=\"{}\"", number(16) / 2, number(20) / 2);
    let svg = text(&first.join("network.svg"));
    assert!(svg.starts_with(&format!("<svg {size} ")), "{size} {}", &svg[..100]);
}

#[test]
fn a_world_with_heights_is_drawn_from_above_and_from_the_side() {
    let (folder, path) = recording(World::Spatial, Maps::Two);
    sextant(&[&path, "--out".as_ref(), folder.path()]).success();
    for name in ["network.svg", "map-ml-tm.svg"] {
        let svg = text(&folder.path().join(name));
        assert_eq!(count(&svg, "<circle"), 2 * NODES as usize + 1, "{name}");
        assert!(svg.contains("y [m]") && svg.contains("z [m]"), "{name}");
    }
    let flat = recording(World::Flat, Maps::Two);
    sextant(&[&flat.1, "--out".as_ref(), flat.0.path()]).success();
    assert!(!text(&flat.0.path().join("network.svg")).contains("z [m]"));
}

#[test]
fn a_recording_without_maps_shows_the_survey() {
    let (folder, path) = recording(World::Flat, Maps::None);
    sextant(&[&path]).success();
    let figures: Vec<_> = std::fs::read_dir(folder.path().join("run.figures"))
        .expect("the folder of figures")
        .map(|entry| entry.expect("a figure").file_name())
        .collect();
    assert_eq!(figures, ["network.svg"]);
}

#[test]
fn a_file_that_is_not_a_recording_is_rejected() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("run.mcap");
    sextant(&[&path]).code(2);
    fs::write(&path, "name = \"circular\"\n").expect("room");
    let refused = sextant(&[&path]).code(2);
    let message = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert!(message.contains("is not an MCAP file"), "{message}");
}

#[test]
fn a_folder_that_cannot_be_created_is_an_error() {
    let (folder, path) = recording(World::Flat, Maps::Two);
    let file = folder.path().join("file");
    fs::write(&file, "").expect("room");
    for format in ["svg", "png"] {
        let out = file.join("figures");
        let failed = sextant(&[&path, "--out".as_ref(), &out, "--format".as_ref(), format.as_ref()]).code(1);
        let message = String::from_utf8_lossy(&failed.get_output().stderr).into_owned();
        assert!(message.contains("cannot be") && message.contains("written"), "{message}");
    }
}
