//! A bound of the accuracy of any map of a log.

use rayon::prelude::*;
use sextant_channel::{Channel, Db, Dbm, Position, ReceptionLog};
use sextant_kernel::{Interrupted, NodeId, Watch, Work};

use crate::log_facts::heights::Heights;
use crate::posterior::NodeEvidence;
use crate::posterior::local_posterior;
use crate::profile::KnownLink;

/// The true model of a simulated survey, from which the bound is computed.
#[derive(Clone, Copy, Debug)]
pub struct TrueModel<'a> {
    /// The channel between nodes and stops.
    pub channel: &'a Channel,
    /// Transmit power of the nodes.
    pub tx: Dbm,
    /// Least power at which packets are received.
    pub sensitivity: Dbm,
    /// Share of the strong enough packets that survive collisions.
    pub delivery: f64,
    /// Mean number of packets that a node sends while the robot listens at a stop, of which it hears at least one or none.
    pub packets_per_stop: f64,
    /// A place near each node (m). Its posterior is computed round this place.
    pub near: &'a [Position],
    /// Lowest and highest height of a node (m). Both are equal for a planar network.
    pub z_range_m: [f64; 2],
}

/// Maximum number of nodes that are evaluated.
const MOST_NODES: usize = 1000;
/// Places within this distance of the node (m) are most of those that its grids have.
const CLOSE_M: f64 = 1.0;
/// Intervals of the table of the probability without obstacles, and its length in reaches: the error of a probability is
/// about 10⁻⁶ at most, and 10⁻⁵ with a shadowing of 0.1 dB.
const SAMPLES: u32 = 1 << 14;
const REACHES: f64 = 2.0;
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
pub fn posterior_bound_m(
    log: &ReceptionLog,
    model: &TrueModel<'_>,
    watch: &dyn Watch,
) -> Result<Option<f64>, Interrupted> {
    let nodes: Vec<usize> = (0..log.node_count()).step_by(log.node_count().div_ceil(MOST_NODES).max(1)).collect();
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let operations = nodes.len() as f64 * VERTICES * log.stops().len() as f64;
    watch.begin(Work { name: "posterior bound", unit: "node", steps: nodes.len() as u64, operations });
    let links = TrueLinks::new(model);
    let errors: Result<Vec<Option<f64>>, Interrupted> = nodes
        .into_par_iter()
        .map(|node| {
            watch.check()?;
            let error = node_bound_m(log, model, &links, NodeId::from_index(node), watch);
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

/// The probability of a reception over each link.
struct TrueLinks<'a> {
    channel: &'a Channel,
    link: KnownLink,
    /// The probability without obstacles at equal distances from 0 on, up to where it ends or is negligible; nothing without
    /// shadowing.
    clear: Vec<f64>,
    step_m: f64,
}

impl<'a> TrueLinks<'a> {
    fn new(model: &TrueModel<'a>) -> Self {
        let link = KnownLink::new(
            *model.channel.law(),
            [model.tx, model.sensitivity],
            model.delivery,
            model.packets_per_stop,
        );
        let step_m = REACHES * link.reach_m() / f64::from(SAMPLES);
        // Without shadowing the probability jumps from 1 to 0, which no table shows.
        let samples = if model.channel.law().shadowing().sigma_db() > 0.0 { 0..SAMPLES + 1 } else { 0..0 };
        let clear = samples.map(|sample| link.probability(step_m * f64::from(sample), Db(0.0))).collect();
        Self { channel: model.channel, link, clear, step_m }
    }

    fn probability(&self, stop: Position, place: Position) -> f64 {
        let distance_m = place.distance_m(stop);
        if distance_m > self.channel.law().max_range_m() {
            return 0.0;
        }
        let loss = self.channel.obstacle_loss(place, stop);
        let along = distance_m / self.step_m;
        let below = crate::numerics::whole(along);
        match self.clear.get(below..).and_then(<[f64]>::first_chunk) {
            Some(&[near, far]) if loss.0 <= 0.0 => near + (far - near) * (along - below as f64),
            _ => self.link.probability(distance_m, loss),
        }
    }
}

/// The expected error of a node. If the work was ended meanwhile, the result means nothing.
fn node_bound_m(
    log: &ReceptionLog,
    model: &TrueModel<'_>,
    links: &TrueLinks<'_>,
    node: NodeId,
    watch: &dyn Watch,
) -> Option<f64> {
    let near = *model.near.get(node.index())?;
    let evidence = NodeEvidence::near(log, node, near, links.link.reach_m())?;
    // A stop that heard nothing and cannot have heard anything is a factor of 1.
    let stops = log.stops();
    let silent_beyond_m = model.channel.law().max_range_m() + CLOSE_M;
    let close = evidence.of_stops(|stop| stops[stop].position.distance_m(near) <= silent_beyond_m);
    let log_likelihood = |place: Position| {
        if watch.is_stopped() {
            return f64::NEG_INFINITY;
        }
        let evidence = if place.distance_m(near) < CLOSE_M { &close } else { &evidence };
        evidence.log_likelihood(|stop| links.probability(stops[stop as usize].position, place))
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
