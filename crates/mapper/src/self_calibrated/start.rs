//! A first estimate: each node is at the middle of the stops that heard it.

use sextant_channel::ReceptionLog;

use crate::log_facts::reach::{HeardNode, gap_m, heard_nodes, median};

/// Least mean number of receptions per node for estimating a curve. With fewer, each node could be at the stop that
/// heard it, and the likeliest curve would fall to 0 right there.
const LEAST_RECEPTIONS: f64 = 6.0;

/// The first estimate.
#[derive(Clone, Debug)]
pub(super) struct Start {
    /// The nodes that were heard.
    pub(super) nodes: Vec<HeardNode>,
    /// The median, over the nodes, of the distance to the farthest stop that heard it; above 0 (m).
    pub(super) range_m: f64,
    /// Whether the log has enough receptions to estimate a curve.
    pub(super) is_rich: bool,
}

impl Start {
    /// `None` if no node was heard.
    pub(super) fn of(log: &ReceptionLog) -> Option<Self> {
        let nodes = heard_nodes(log);
        if nodes.is_empty() {
            return None;
        }
        let heard_at: f64 = nodes.iter().map(|heard| f64::from(heard.stops)).sum();
        let is_rich = heard_at >= LEAST_RECEPTIONS * nodes.len() as f64;
        let mut farthest_m: Vec<f64> = nodes.iter().map(|heard| heard.farthest_m).collect();
        let range_m = median(&mut farthest_m);
        let range_m = if range_m > 0.0 { range_m } else { gap_m(log).unwrap_or(1.0) };
        Some(Self { nodes, range_m, is_rich })
    }
}
