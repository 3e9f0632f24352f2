//! The posteriors of the nodes, given the curve.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::{NodeId, Watch};

use super::belief::FittedBelief;
use super::curve::{CurveCounts, FittedCurve};
use crate::grid_ml::directions::{Directions, covers};
use crate::log_facts::heights::Heights;
use crate::log_facts::search_box::SearchBox;
use crate::numerics::normal::index;
use crate::posterior::{LocalPosterior, local_posterior};

/// Smallest step of a grid, in bins of the curve.
const LEAST_STEP: f64 = 0.5;
/// Places with a lower weight are not counted.
const SLIGHT: f64 = 5e-4;
/// A reception is an outlier if it is this many standard deviations beyond the range.
const SURE: f64 = 3.0;

/// One round: its first curve, and the stops that are used.
pub(super) struct Round<'a> {
    pub(super) log: &'a ReceptionLog,
    pub(super) heights: Heights,
    pub(super) directions: Option<&'a Directions>,
    pub(super) curve: &'a FittedCurve,
    pub(super) is_dead: &'a [bool],
    pub(super) watch: &'a dyn Watch,
}

/// The contribution of one node to a round.
pub(super) struct ExpectedCounts {
    pub(super) belief: FittedBelief,
    pub(super) counts: CurveCounts,
    /// Stops that did not hear the node, each with the logarithm of the probability of this silence.
    pub(super) silent: Vec<(u32, f64)>,
}

/// A stop near a node.
#[derive(Clone, Copy)]
struct NearStop {
    stop: u32,
    place: Position,
    received: f64,
    missed: f64,
    /// The sector of a reception.
    sector: Option<u8>,
}

impl Round<'_> {
    /// The posterior of a node and what it says of the curve. If the work was ended meanwhile, the result means
    /// nothing.
    pub(super) fn expect(&self, node: NodeId, within: &SearchBox, belief: &FittedBelief) -> ExpectedCounts {
        let (listeners, far) = self.listeners(node, belief);
        let posterior = self.posterior(belief, within, &listeners);
        let mut counts = CurveCounts::new(self.curve.bins());
        let last = counts.bins.len() - 1;
        counts.bins[last] = far;
        let (belief, places) = match posterior {
            Some(found) => (FittedBelief { mean: found.mean, spread_m: found.spread_m }, found.places),
            None => (belief.clone(), vec![(belief.mean, 1.0)]),
        };
        let mut silent: Vec<(u32, f64)> = Vec::new();
        let mut likely = places;
        likely.retain(|&(_, weight)| weight > SLIGHT);
        let kept: f64 = likely.iter().map(|&(_, weight)| weight).sum();
        for NearStop { stop, place, received, missed, .. } in &listeners {
            let mut ln_missed = 0.0;
            for &(vertex, weight) in &likely {
                if *received <= 0.0 && !covers(self.directions, vertex - *place) {
                    continue;
                }
                let weight = weight / kept;
                let bin = self.curve.bin(vertex.distance_m(*place));
                if !self.is_dead[*stop as usize] {
                    counts.bins[bin][0] += weight * (received + missed);
                    counts.bins[bin][1] += weight * received;
                }
                ln_missed += weight * missed * self.curve.logarithms()[bin].missed;
            }
            if *received <= 0.0 {
                silent.push((*stop, ln_missed));
            }
        }
        ExpectedCounts { belief, counts, silent }
    }

    /// Receptions of a node from far beyond the range. Empty if the work was ended.
    pub(super) fn outliers(&self, node: NodeId, within: &SearchBox) -> Vec<(NodeId, u32)> {
        if self.watch.is_stopped() {
            return Vec::new();
        }
        let belief = FittedBelief::first(self.log, node, within);
        let (listeners, _) = self.listeners(node, &belief);
        let Some(LocalPosterior { mean, spread_m, .. }) = self.posterior(&belief, within, &listeners) else {
            return Vec::new();
        };
        let sure_m = self.curve.range_m() + SURE * spread_m.iter().fold(self.curve.bin_m(), |most, &s| most.max(s));
        let entries = self.log.of(node).iter().filter(|entry| entry.received > 0);
        let far = entries.filter(|entry| self.log.stops()[entry.stop as usize].position.distance_m(mean) > sure_m);
        far.map(|entry| (node, entry.stop)).collect()
    }

    /// The stops whose receptions depend on the place of the node, dead ones included, and the packets sent and
    /// received over all larger distances.
    fn listeners(&self, node: NodeId, belief: &FittedBelief) -> (Vec<NearStop>, [f64; 2]) {
        let spread_m = belief.spread_m.iter().map(|spread| spread * spread).sum::<f64>().sqrt();
        let near_m = self.curve.reach_m().min(1.2 * self.curve.range_m()) + 4.0 * spread_m + 4.0 * self.curve.bin_m();
        let mut listeners = Vec::new();
        let mut far = [0.0; 2];
        let mut entries = self.log.of(node).iter().peekable();
        for (index, stop) in (0_u32..).zip(self.log.stops()) {
            let entry = entries.next_if(|entry| entry.stop == index);
            let (received, sent) = entry.map_or((0, 1), |entry| (entry.received, entry.sent));
            let (received, missed) = (f64::from(received), f64::from(sent - received));
            let sector = entry.and_then(|entry| entry.sector).filter(|_| received > 0.0);
            if stop.position.distance_m(belief.mean) <= near_m {
                listeners.push(NearStop { stop: index, place: stop.position, received, missed, sector });
            } else if !self.is_dead[index as usize]
                && (received > 0.0 || covers(self.directions, belief.mean - stop.position))
            {
                far[0] += received + missed;
                far[1] += received;
            }
        }
        (listeners, far)
    }

    fn posterior(&self, belief: &FittedBelief, within: &SearchBox, listeners: &[NearStop]) -> Option<LocalPosterior> {
        let logarithms = self.curve.logarithms();
        let last = logarithms.len() - 1;
        let per_m = 1.0 / self.curve.bin_m();
        let live: Vec<NearStop> =
            listeners.iter().filter(|listener| !self.is_dead[listener.stop as usize]).copied().collect();
        let log_likelihood = |vertex: Position| {
            if !within.contains(vertex) || self.watch.is_stopped() {
                return f64::NEG_INFINITY;
            }
            let mut sum = 0.0;
            for listener in &live {
                let apart = vertex - listener.place;
                if let Some(directions) = self.directions {
                    if listener.received > 0.0 {
                        sum += libm::log(directions.factor(listener.sector, apart));
                    } else if !directions.covers(apart) {
                        continue;
                    }
                }
                let along = apart.dot(apart).sqrt() * per_m;
                let below = index(along).min(last);
                let share = (along - below as f64).min(1.0);
                sum += logarithms[below].at(share, listener.received, listener.missed);
            }
            sum
        };
        let least_step_m = LEAST_STEP * self.curve.bin_m();
        let spread_m = belief.spread_m.map(|spread| spread.max(2.0 * least_step_m));
        local_posterior(self.heights, belief.mean, spread_m, least_step_m, &log_likelihood)
    }
}
