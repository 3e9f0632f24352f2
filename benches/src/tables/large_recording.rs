//! Writes the recording of a large survey, to see how much time and memory the commands need that read it.
//!
//! Usage: `large-recording OUT.mcap [NODES] [full|compact] [SPACING_M]`, by default 35 000 nodes, of which 10⁷ receptions are
//! recorded, a compact recording, and a stop each metre. It has the true places of the nodes and a map with errors drawn
//! at random.

use sextant_benches::workload::{self, Workload};
use sextant_channel::{Position, Reception, ReceptionLogBuilder};
use sextant_kernel::{NodeId, Purpose, Seed, SimTime};
use sextant_recording::{FileRecorder, Origin, PlacedNode};

use crate::tables::{Outcome, Words};

/// Standard deviation of the places on the map along each axis (m).
const ERROR_M: f64 = 0.5;
/// Standard deviation of signal strengths (dB), and their mean (dBm).
const STRENGTH: (f64, f64) = (6.0, -75.0);

pub(crate) fn print(mut words: Words) -> Outcome<()> {
    let path = words.next().ok_or("usage: large-recording OUT.mcap [NODES] [full|compact] [SPACING_M]")?;
    let nodes = words.next().map_or(Ok(35_000), |nodes| nodes.parse())?;
    let is_compact = words.next().is_none_or(|detail| detail == "compact");
    let spacing_m = words.next().map_or(Ok(1.0), |spacing_m| spacing_m.parse())?;
    let seed = Seed(6);
    let Workload { log, places, .. } = workload::field_with_stops(nodes, spacing_m);
    let mut measured = ReceptionLogBuilder::default();
    measured.extend(log.receptions().iter().map(|reception| {
        let draw = seed.normal(Purpose::new(1), [reception.node.0.into(), reception.stop.into(), 0]);
        Reception { rssi_dbm: Some(STRENGTH.1 + STRENGTH.0 * draw), ..reception }
    }));
    let log = measured.build(log.names().to_vec(), log.stops().to_vec(), Vec::new())?;
    let mut recorder = FileRecorder::create(path.as_ref())?;
    recorder.origin(Origin { scenario: "field", seed: 6, version: "benchmark" })?;
    if is_compact {
        recorder.make_compact("one message for all receptions of a stop", "full")?;
    }
    recorder.world_nodes(SimTime::ZERO, &placed(&places, |_, place| place))?;
    recorder.log(&log)?;
    let path: Vec<Position> = log.stops().iter().map(|stop| stop.position).collect();
    recorder.path(SimTime::ZERO, "robot-0", &path)?;
    let error_m = |node: u64, axis| ERROR_M * seed.normal(Purpose::new(2), [node, axis, 0]);
    let mapped = |node, place| place + Position::new(error_m(node, 0), error_m(node, 1), 0.0);
    recorder.map(SimTime::ZERO, "ml-tm", &placed(&places, mapped))?;
    recorder.finish()?;
    eprintln!("{} receptions at {} stops", log.receptions().len(), log.stops().len());
    Ok(())
}

/// The nodes where `at` puts them, with their errors.
fn placed(places: &[Position], at: impl Fn(u64, Position) -> Position) -> Vec<PlacedNode> {
    let node = |(node, &place): (u64, &Position)| {
        let position = at(node, place);
        let node = NodeId(u32::try_from(node).expect("fewer than 2^32 nodes"));
        PlacedNode { node, position, error_m: Some(position.distance_m(place)) }
    };
    (0..).zip(places).map(node).collect()
}
