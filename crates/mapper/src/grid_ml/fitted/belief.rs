//! The estimated place of a node during a fit.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::receivers;
use crate::log_facts::search_box::SearchBox;

/// The estimated place of a node during a fit.
#[derive(Clone, Debug)]
pub(super) struct FittedBelief {
    pub(super) mean: Position,
    pub(super) spread_m: [f64; 3],
}

impl FittedBelief {
    /// The median along each axis of the stops that heard the node. Outliers do not move it much.
    pub(super) fn first(log: &ReceptionLog, node: NodeId, within: &SearchBox) -> Self {
        let (mut mean, mut spread_m) = ([0.0; 3], [0.0; 3]);
        for axis in 0..3 {
            let coordinate = |(place, packets): (Position, u32)| (<[f64; 3]>::from(place)[axis], packets);
            let mut sorted: Vec<(f64, u32)> = receivers(log, node).map(coordinate).collect();
            sorted.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
            mean[axis] = sorted[sorted.len() / 2].0;
            let middle_half = sorted[sorted.len() * 3 / 4].0 - sorted[sorted.len() / 4].0;
            spread_m[axis] = 0.25 * middle_half;
        }
        // If the survey is a straight line, nodes lie beside it.
        let widest = spread_m.iter().fold(0.0_f64, |widest, &spread| widest.max(spread));
        let spread_m = spread_m.map(|spread| spread.max(0.5 * widest));
        Self { mean: within.nearest(mean.into()), spread_m }
    }
}
