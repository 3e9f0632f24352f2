//! A bound of the accuracy of any map of a log.

use rayon::prelude::*;
use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{Interrupted, NodeId, Watch, Work};

use crate::log_facts::heights::Heights;
use crate::posterior::NodeEvidence;
use crate::posterior::local_posterior;

/// The true model of a simulated survey, from which the bound is computed.
#[derive(Clone, Copy, Debug)]
pub struct TrueModel<'a, P> {
    /// Probability that one packet from a node at `place` is received at the stop with the index `stop`:
    /// `|stop, place|`.
    pub probability: P,
    /// A place near each node (m). Its posterior is computed round this place.
    pub near: &'a [Position],
    /// Distance from a stop beyond which the probability is constant or zero (m).
    pub reach_m: f64,
    /// Lowest and highest height of a node (m). Both are equal for a planar network.
    pub z_range_m: [f64; 2],
}

/// Maximum number of nodes that are evaluated.
const MOST_NODES: usize = 1000;
/// First guess of how far a posterior spreads (m).
const SPREAD_M: f64 = 0.15;
/// Approximate number of grid vertices of a node.
const VERTICES: f64 = 300.0;
/// Least step of the grid (m).
const LEAST_STEP_M: f64 = 0.01;

/// The expected distance between a node and its posterior mean under the true model with a uniform prior, averaged
/// over the heard nodes (m). No estimator from the same log has a smaller mean squared error than the posterior mean.
/// `None` if no node was heard. Each posterior is computed on a separate grid round the given place, in steps of
/// about half its spread; probability elsewhere is left out. If there are more than a thousand nodes, at most a
/// thousand of them are evaluated, evenly chosen. The result is bit-identical for any number of threads.
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

/// The expected error of a node. If the work was ended meanwhile, the result means nothing.
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
