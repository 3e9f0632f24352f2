//! A first guess: each node in the middle of where it was heard.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

/// Receptions a node, on average, that a curve needs; with fewer each node could lie on the stop that heard it, and the
/// likeliest curve would fall to nothing right there.
const LEAST_RECEPTIONS: f64 = 6.0;

/// The first guess.
#[derive(Clone, Debug)]
pub(super) struct Start {
    /// Nodes that were heard, and the middle of the stops that heard each [m].
    pub(super) nodes: Vec<(NodeId, Position)>,
    /// The median, over the nodes, of the distance to the farthest stop that heard it; above 0 [m].
    pub(super) range_m: f64,
    /// Whether the log is rich enough to tell a curve.
    pub(super) is_rich: bool,
}

impl Start {
    /// `None` if no node was heard.
    pub(super) fn of(log: &ReceptionLog) -> Option<Self> {
        let mut nodes = Vec::new();
        let mut farthest_m = Vec::new();
        let mut heard_at = 0_u32;
        for node in (0..log.node_count()).map(NodeId::from_index) {
            let heard = || {
                let receptions = log.of(node).iter().filter(|reception| reception.received > 0);
                receptions.map(|reception| (log.stops()[reception.stop as usize].position, reception.received))
            };
            let packets: f64 = heard().map(|(_, packets)| f64::from(packets)).sum();
            if packets > 0.0 {
                let sum = heard().fold(Position::ORIGIN, |sum, (place, packets)| sum + place * f64::from(packets));
                let middle = sum * (1.0 / packets);
                farthest_m.push(heard().map(|(place, _)| place.distance_m(middle)).fold(0.0, f64::max));
                nodes.push((node, middle));
                heard_at = heard_at.saturating_add(u32::try_from(heard().count()).unwrap_or(u32::MAX));
            }
        }
        if nodes.is_empty() {
            return None;
        }
        #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
        let is_rich = f64::from(heard_at) >= LEAST_RECEPTIONS * nodes.len() as f64;
        let range_m = median(&mut farthest_m);
        let range_m = if range_m > 0.0 { range_m } else { gap_m(log).unwrap_or(1.0) };
        Some(Self { nodes, range_m, is_rich })
    }
}

/// The median distance from a stop of a robot to its next one, of those that differ [m]; `None` if no robot moved.
pub(super) fn gap_m(log: &ReceptionLog) -> Option<f64> {
    let mut gaps: Vec<f64> = log.drives().map(|drive| drive.length_m()).filter(|&gap| gap > 0.0).collect();
    if gaps.is_empty() { None } else { Some(median(&mut gaps)) }
}

fn median(values: &mut [f64]) -> f64 {
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
