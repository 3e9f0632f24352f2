//! The files that a scenario names: tables of traffic and of nodes, and meshes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::Arc;

use sextant_channel::{MeshConfig, ObstacleField, Position, Shape, ShapeConfig};
use sextant_kernel::{Files, NodeId, Seed, SimTime};
use sextant_sim::layout::{CsvConfig, NodesConfig, PlacedNode};
use sextant_sim::{Next, TraceConfig, TrafficConfig, TrafficPlan};

/// The first octet tells which kind of file the rest is.
pub(crate) fn check(octets: &[u8]) {
    let Some((&kind, content)) = octets.split_first() else { return };
    let file = PathBuf::from("file");
    let files = Files::Attached(Arc::new(BTreeMap::from([(file.clone(), content.to_vec())])));
    match kind {
        b'n' => nodes(file, &files),
        b'm' => mesh(file, &files),
        _ => traffic(file, &files),
    }
}

/// The frames of a node come in the order of time, each once, to the end.
fn traffic(file: PathBuf, files: &Files) {
    let node = |name: &str| PlacedNode { name: name.into(), position: Position::ORIGIN };
    let nodes = ["a", "b", "n0"].map(node);
    let config = TrafficConfig::Trace(TraceConfig { file, acknowledged: false, to: None });
    let Ok(plan) = TrafficPlan::new(&config, &nodes, files) else { return };
    for index in 0..nodes.len() {
        let node = NodeId::from_index(index);
        let Some(traffic) = plan.of(node) else { continue };
        let (mut last, mut count) = (SimTime::ZERO, 0);
        while let Next::At(time, mpdu_octets) = traffic.next(Seed(1), node, count, last) {
            assert!(time >= last, "frame {count} of node {index} is before the one before it");
            assert!((11..=127).contains(&mpdu_octets), "a frame of {mpdu_octets} octets");
            last = time;
            count += 1;
            assert!(count < 4096, "a trace without end");
        }
    }
}

/// The nodes have finite places and names of their own.
fn nodes(file: PathBuf, files: &Files) {
    let none = ObstacleField::new(Vec::new());
    let Ok(nodes) = NodesConfig::Csv(CsvConfig { file }).place(&none, Seed(1), files) else { return };
    assert!(!nodes.is_empty(), "a table without nodes is accepted");
    assert!(nodes.iter().all(|node| node.position.is_finite() && !node.name.is_empty()));
}

/// A way has no more length inside the body than it is long.
fn mesh(file: PathBuf, files: &Files) {
    let config = ShapeConfig::Mesh(MeshConfig { file: Some(file), ..MeshConfig::default() });
    let Ok(shape) = Shape::read(config, files) else { return };
    let (from, to) = (Position::new(-9.0, -8.0, -7.0), Position::new(9.1, 8.2, 7.3));
    let inside_m = shape.length_inside_m(from, to);
    assert!((0.0..=from.distance_m(to) + 1e-6).contains(&inside_m), "{inside_m} m inside");
    assert!(shape.distance_m(from) >= 0.0, "a negative distance");
    let bounds = shape.bounds();
    assert!(bounds.min.is_finite() && bounds.max.is_finite(), "a body without bounds");
}
