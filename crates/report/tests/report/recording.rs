//! The document of a recording.

use sextant::{RunRecorder, Scenario, Summary, Unwatched};
use sextant_recording::FileRecorder;
use sextant_report::{Report, ReportError};

use super::{document, floats, folder, recorded, root};

/// Seven digits of a float.
const ROUNDED: f64 = 1e-6;

#[test]
fn each_instant_of_a_map_is_kept() {
    let folder = folder();
    let report = Report::of_recording(&recorded(&folder)).expect("a sound recording");
    let world = report.world.expect("a world");
    let [map] = &world.maps[..] else { panic!("one map") };
    let times: Vec<_> = map.snapshots.iter().map(|snapshot| snapshot.time_s).collect();
    assert_eq!(times, [2.0, 5.0]);
    let nodes: Vec<_> = map.snapshots.iter().map(|snapshot| snapshot.nodes.to_vec()).collect();
    assert_eq!(nodes, [vec![0.0], vec![0.0, 2.0]]);
    assert_eq!(map.snapshots[1].places_m.to_vec(), [0.5, 0.0, 0.0, 0.0, 3.0, 0.0]);
    let errors = map.errors_m.as_ref().expect("the truth is known").to_vec();
    assert!(errors[1].is_nan(), "node 1 is not mapped");
    assert_eq!(vec![errors[0], errors[2]], [0.5, 1.5]);
}

#[test]
fn receptions_are_those_of_the_log() {
    let folder = folder();
    let report = Report::of_recording(&recorded(&folder)).expect("a sound recording");
    let world = report.world.expect("a world");
    let [survey] = &world.surveys[..] else { panic!("one survey") };
    assert_eq!(survey.stops.times_s.to_vec(), [0.0, 5.0]);
    assert_eq!(survey.receptions.first.to_vec(), [0.0, 2.0, 2.0, 3.0]);
    assert_eq!(survey.receptions.stops.to_vec(), [0.0, 1.0, 1.0]);
    assert_eq!(survey.receptions.received.as_ref().expect("two of three").to_vec(), [2.0; 3]);
    assert_eq!(survey.receptions.rssi_dbm.as_ref().expect("strengths").to_vec(), [-70.5; 3]);
    assert_eq!(world.robots[0].way.times_s.as_ref().expect("times").to_vec(), [0.0, 5.0]);
}

#[test]
fn the_same_recording_gives_the_same_bytes() {
    let folder = folder();
    let path = recorded(&folder);
    let report = Report::of_recording(&path).expect("a sound recording");
    assert_eq!(report.summary.as_deref(), Some(super::SUMMARY));
    assert_eq!(report.to_html(), Report::of_recording(&path).expect("a sound recording").to_html());
}

#[test]
fn the_errors_of_a_run_have_the_mean_of_its_summary() {
    let folder = folder();
    let path = folder.path().join("smoke.mcap");
    let scenario = Scenario::load(root().join("scenarios/smoke.toml")).expect("a shipped scenario");
    let run = sextant::run(&scenario, &mut RunRecorder::new(&path), &Unwatched).expect("a run");
    let html = Report::of_recording(&path).expect("a sound recording").to_html();
    assert!(html.len() < 1_000_000, "{} octets", html.len());
    let document = document(&html);
    let text = Summary { timing: None, ..run.summary().clone() }.to_json();
    assert_eq!(document["summary"], text, "each number with all its digits");
    let summary = serde_json::to_value(run.summary()).expect("JSON");
    let errors = floats(&document["world"]["maps"][0]["errors_m"]);
    let mean = errors.iter().sum::<f64>() / errors.len() as f64;
    let expected = summary["maps"][0]["position_error_m"]["mean"].as_f64().expect("a mean");
    assert!((mean - expected).abs() < ROUNDED, "{mean} and {expected}");
    let truth = floats(&document["world"]["truth_m"]);
    let snapshots = document["world"]["maps"][0]["snapshots"].as_array().expect("an array");
    let snapshot = snapshots.last().expect("the map at the end");
    let places = floats(&snapshot["places_m"]);
    let farthest = truth.iter().zip(&places).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let most = summary["maps"][0]["position_error_m"]["max"].as_f64().expect("a maximum");
    assert!(farthest <= most + ROUNDED, "{farthest} and {most}");
}

#[test]
fn a_tree_has_its_parents_one_after_the_other_and_its_deaths() {
    let folder = folder();
    let path = folder.path().join("tree.mcap");
    let scenario = Scenario::load(root().join("scenarios/batteries/dying-tree.toml")).expect("a shipped scenario");
    let run = sextant::run(&scenario, &mut RunRecorder::new(&path), &Unwatched).expect("a run");
    let report = Report::of_recording(&path).expect("a sound recording");
    let world = report.world.expect("a world");
    let tree = world.tree.expect("a tree");
    let chosen = tree.chosen.expect("nodes choose their parents");
    let summary = run.summary();
    let (routing, battery) = (summary.routing.as_ref().expect("hops"), summary.battery.as_ref().expect("batteries"));
    assert_eq!(tree.span_s.map(f64::to_bits), [0.0_f64, 4500.0].map(f64::to_bits));
    // Each node has a first parent, and then its changes; the last one is that of the summary.
    assert_eq!(chosen.nodes.len() as u64, routing.nodes.len() as u64 + routing.parent_changes);
    let (nodes, parents) = (chosen.nodes.to_vec(), chosen.parents.to_vec());
    for (number, node) in routing.nodes.iter().enumerate() {
        let at = nodes.iter().rposition(|&other| (other - number as f64).abs() < 0.5).expect("it has a parent");
        assert_eq!(parents[at].to_bits(), tree.parents.to_vec()[number].to_bits());
        let station = (1..).zip(&world.names).find(|&(number, _)| (parents[at] - f64::from(number)).abs() < 0.5);
        let parent = station.map_or("sink", |(_, name): (u32, _)| name.as_str());
        assert_eq!(node.parent.as_deref(), (parents[at] > 0.5).then_some(parent));
    }
    let deaths = world.deaths.expect("nodes die");
    let of_summary: Vec<f64> = battery.nodes.iter().filter_map(|node| node.depleted_s).collect();
    assert_eq!(deaths.times_s.len(), battery.depleted);
    for (shown, &expected) in deaths.times_s.to_vec().iter().zip(&of_summary) {
        assert!((shown - expected).abs() < 1e-3, "{shown} and {expected}");
    }
    // The table by depth has the batteries of all nodes.
    let dead: usize = routing.by_depth.iter().filter_map(|nodes| nodes.depleted).sum();
    assert_eq!(dead, battery.depleted);
    assert_eq!(routing.by_depth.iter().map(|nodes| nodes.nodes).sum::<usize>(), routing.nodes.len());
    let least = routing.by_depth.iter().filter_map(|nodes| nodes.lifetime_d).map(|lifetime| lifetime.min);
    let shortest = battery.nodes.iter().filter_map(|node| node.lifetime_d);
    let [least, shortest] = [least.fold(f64::INFINITY, f64::min), shortest.fold(f64::INFINITY, f64::min)];
    assert_eq!(least.to_bits(), shortest.to_bits());
}

#[test]
fn a_broken_recording_is_refused_with_its_place() {
    let folder = folder();
    let path = recorded(&folder);
    let mut octets = std::fs::read(&path).expect("a recording");
    octets.truncate(octets.len() / 2);
    std::fs::write(&path, octets).expect("room");
    let error = Report::of_recording(&path).expect_err("it is broken");
    assert!(matches!(error, ReportError::Recording(_)), "{error}");
    assert!(error.to_string().contains("broken at byte"), "{error}");
}

#[test]
fn a_recording_without_anything_to_show_is_refused() {
    let folder = folder();
    let path = folder.path().join("empty.mcap");
    FileRecorder::create(&path).expect("a folder").finish().expect("room");
    let error = Report::of_recording(&path).expect_err("it is empty");
    assert!(error.to_string().contains("nothing to report"), "{error}");
}
