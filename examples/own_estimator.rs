//! An estimator of its own on the same log as those of Sextant, and its errors beside theirs.
//!
//! `cargo run --release -p sextant --example own_estimator`

use std::io::Write;

use sextant::channel::{Position, ReceptionLog};
use sextant::kernel::NodeId;
use sextant::mapper::{CoordinateFrame, PositionError, TopologyMap};
use sextant::{Scenario, Unwatched};

/// Each node is where the most of its packets were received; of several such stops, in their middle.
fn best_stops(log: &ReceptionLog) -> TopologyMap {
    let place = |node: NodeId| {
        let most = log.of(node).iter().map(|reception| reception.received).max().filter(|&most| most > 0)?;
        let best = log.of(node).iter().filter(|reception| reception.received == most);
        let places: Vec<Position> = best.map(|reception| log.stops()[reception.stop as usize].position).collect();
        let sum = places.iter().fold(Position::ORIGIN, |sum, &place| sum + place);
        Some(sum * (1.0 / places.len() as f64))
    };
    let places = (0..log.node_count()).map(|node| place(NodeId::from_index(node))).collect();
    TopologyMap::of_places("best-stops", places, CoordinateFrame::World)
}

pub(crate) fn main() -> Result<(), Box<dyn std::error::Error>> {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
    let scenario = Scenario::load(file)?;
    let surveyed = sextant::survey(&scenario, &mut (), &Unwatched)?.ok_or("robots survey")?;
    let log = surveyed.simulated.survey.logs.first();
    let mut maps = vec![("best-stops".to_owned(), best_stops(log))];
    for name in ["packet-centroid", "link-model"] {
        maps.push((name.to_owned(), sextant::map_log(log, name.parse()?, &Unwatched)?.map));
    }
    let mut out = std::io::stdout().lock();
    for (name, map) in &maps {
        let truth = scenario.world().nodes.iter().map(|node| node.position);
        let errors_m: Vec<f64> = map
            .positions()
            .into_iter()
            .zip(truth)
            .filter_map(|(place, truth)| Some(place?.distance_m(truth)))
            .collect();
        let error = PositionError::of(&errors_m).ok_or("nodes were mapped")?;
        writeln!(out, "{name}: {} nodes, {:.2} m mean error", errors_m.len(), error.mean)?;
    }
    Ok(())
}
