//! How accurate any map of a log can be.

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{Interrupted, NodeId, Watch, Work};

use crate::heights::Heights;
use crate::local_posterior::local_posterior;
use crate::node_evidence::NodeEvidence;

/// What is true of a simulated survey: what the bound is computed from.
#[derive(Clone, Copy, Debug)]
pub struct TrueModel<'a, P> {
    /// Probability that a node at the place, if it sends once, is heard at the stop of the index: `|stop, place|`.
    pub probability: P,
    /// A place near which each node is known to be (m): where its posterior is looked for.
    pub near: &'a [Position],
    /// Distance from a stop beyond which the probability is the same everywhere, or zero (m).
    pub reach_m: f64,
    /// Lowest and highest height of a node (m); the same for a planar network.
    pub z_range_m: [f64; 2],
}

/// Nodes that are looked at, at most.
const MOST_NODES: usize = 1000;
/// First guess of how far a posterior spreads (m).
const SPREAD_M: f64 = 0.15;
/// Vertices of the grids of a node, about.
const VERTICES: f64 = 300.0;
/// Least step of the grid (m).
const LEAST_STEP_M: f64 = 0.01;

/// The mean over the heard nodes of the expected distance between a node and the mean of its posterior under the true
/// model, for a uniform prior (m): no estimator that starts from the same log has a smaller mean squared error. `None` if no
/// node was heard. Each posterior is computed on a grid of its own, in steps of about half its spread, round the place near
/// which the node is; probability elsewhere is left out. Of more than a thousand nodes, only so many are looked at, evenly
/// chosen. The same bits for any number of threads.
///
/// # Errors
/// If `watch` ends the work.
pub fn posterior_bound_m<P: Fn(u32, Position) -> f64 + Sync>(
    log: &ReceptionLog,
    model: &TrueModel<'_, P>,
    watch: &dyn Watch,
) -> Result<Option<f64>, Interrupted> {
    let nodes: Vec<usize> = (0..log.node_count()).step_by(log.node_count().div_ceil(MOST_NODES).max(1)).collect();
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let operations = nodes.len() as f64 * VERTICES * log.stops().len() as f64;
    watch.begin(Work { name: "posterior bound", unit: "node", steps: nodes.len() as u64, operations });
    let errors: Result<Vec<Option<f64>>, Interrupted> = nodes
        .into_par_iter()
        .map(|node| {
            watch.check()?;
            let error = node_bound_m(log, model, NodeId::from_index(node), watch);
            watch.check()?;
            watch.advance(1);
            Ok(error)
        })
        .collect();
    let (mut sum, mut count) = (0.0, 0_u32);
    for error in errors?.into_iter().flatten() {
        sum += error;
        count += 1;
    }
    Ok((count > 0).then(|| sum / f64::from(count)))
}

/// The expected error of a node; anything if the work was ended meanwhile.
fn node_bound_m<P: Fn(u32, Position) -> f64 + Sync>(
    log: &ReceptionLog,
    model: &TrueModel<'_, P>,
    node: NodeId,
    watch: &dyn Watch,
) -> Option<f64> {
    let near = *model.near.get(node.index())?;
    let evidence = NodeEvidence::near(log, node, near, model.reach_m)?;
    let log_likelihood = |place: Position| {
        if watch.is_stopped() {
            return f64::NEG_INFINITY;
        }
        evidence.log_likelihood(|stop| (model.probability)(stop, place))
    };
    let [low, high] = model.z_range_m;
    let heights = if high > low { Heights::Between(low, high) } else { Heights::Level(low) };
    let posterior = local_posterior(heights, near, [SPREAD_M; 3], LEAST_STEP_M, &log_likelihood)?;
    let mean = posterior.mean;
    let (mut sum, mut weight) = (0.0, 0.0);
    for (place, probability) in posterior.places {
        sum += probability * place.distance_m(mean);
        weight += probability;
    }
    Some(sum / weight)
}
