//! Whether nodes are rather above or below a level path: heights that are left out look like a bias and a scale.

use sextant_kernel::{Interrupted, Watch};

use super::Settings;
use super::fit::fitted;
use super::groups::RangeGroups;
use super::problem::{HeightPrior, Problem};
use super::solution::{ErrorShares, NODE_BIAS_M, by_least_squares};
use crate::numerics::median;

/// The standard deviation of heights that are sought (m), and where the search begins.
const DEVIATION_M: f64 = 3.0;
const START_M: f64 = 1.5;
/// Heights are told if they are more probable by so much (nats).
const CLEAR: f64 = 10.0;

/// How far nodes usually are above or below the path (m), if that is clearly more probable than that they are at its height.
pub(super) fn higher(
    settings: &Settings,
    groups: &RangeGroups,
    level: HeightPrior,
    watch: &dyn Watch,
) -> Result<Option<f64>, Interrupted> {
    let prior = settings.prior(ErrorShares::ALL);
    let free = HeightPrior { deviation_m: DEVIATION_M, ..level };
    let flat = Problem { groups, prior, heights: level, node_bias_m: NODE_BIAS_M, worth: 1.0 };
    let free = Problem { heights: free, ..flat };
    let start = by_least_squares(&flat, prior.mean);
    let Some(at_level) = fitted(&flat, start.clone(), watch)? else { return Ok(None) };
    let mut raised = start;
    raised.nodes.iter_mut().for_each(|node| node[2] = level.mean_m + START_M);
    let Some(above) = fitted(&free, raised, watch)? else { return Ok(None) };
    // The prior of the heights.
    let log_evidence = above.log_evidence - above.point.nodes.len() as f64 * libm::log(DEVIATION_M);
    let heights = above.point.nodes.iter().map(|node| (node[2] - level.mean_m).abs());
    let usual_m = median(&mut heights.collect::<Vec<_>>());
    Ok((log_evidence > at_level.log_evidence + CLEAR).then_some(usual_m))
}
