//! The likelihood of a node's strengths and silences under a channel that also loses packets for other reasons.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::fitted_channel::FittedChannel;
use crate::numerics::normal::index;

/// Least probability of what a stop heard.
const LEAST: f64 = 1e-6;
/// Silence whose log-probability is this near to 0 is certain. A thousand such stops do not move a place.
const CERTAIN: f64 = 1e-7;
/// Below this distance the strength is constant (m).
pub(super) const LEAST_M: f64 = 0.1;

/// What the stops heard of one node; all others were silent.
#[derive(Clone, Debug, Default)]
pub(super) struct HeardByStops {
    /// Stops that heard it with a strength (dBm), and the share of the packets that they received. The strengths of packets that
    /// they missed are only known to be low.
    pub(super) heard: Vec<(Position, f64, f64)>,
    /// Stops that heard it without one, and this share.
    pub(super) unmeasured: Vec<(Position, f64)>,
    /// Stops that could not have heard it.
    pub(super) deaf: Vec<Position>,
}

impl HeardByStops {
    pub(super) fn of(log: &ReceptionLog, node: NodeId) -> Self {
        let mut links = Self::default();
        for entry in &log.of(node) {
            let stop = log.stops()[entry.stop as usize].position;
            if entry.sent == 0 {
                links.deaf.push(stop);
                continue;
            }
            // The packets of a link share most of what weakens them, so they count as one.
            let share = f64::from(entry.received) / f64::from(entry.sent);
            match entry.rssi_dbm {
                _ if entry.received == 0 => {}
                Some(rssi_dbm) => links.heard.push((stop, rssi_dbm, share)),
                None => links.unmeasured.push((stop, share)),
            }
        }
        links
    }

    /// The stops that were not silent, and the share of the packets that they received; deaf ones as if they had received all.
    pub(super) fn not_silent(&self) -> impl Iterator<Item = (Position, f64)> {
        let heard = self.heard.iter().map(|&(stop, _, share)| (stop, share));
        heard.chain(self.unmeasured.iter().copied()).chain(self.deaf.iter().map(|&stop| (stop, 1.0)))
    }
}

/// Cells of the tables over distance.
const CELLS: usize = 4096;

/// A channel, ready to compute likelihoods: tables over distance.
#[derive(Clone, Debug)]
pub(super) struct StrengthEvidence {
    per_m: f64,
    /// Mean strength, in standard deviations.
    mean: Vec<f64>,
    /// Log-probabilities that a packet is received, and that it is not.
    ln_heard: Vec<f64>,
    ln_silent: Vec<f64>,
    per_sigma: f64,
    /// Beyond this distance silence is certain (m).
    certain_m: f64,
}

impl StrengthEvidence {
    /// The tables of a channel for distances up to `longest_m`.
    pub(super) fn new(channel: FittedChannel, longest_m: f64) -> Self {
        let per_m = CELLS as f64 / longest_m.max(LEAST_M);
        let per_sigma = 1.0 / channel.sigma_db;
        let mean = |cell: usize| {
            let distance_m = (cell as f64 / per_m).max(LEAST_M);
            let decades = libm::log10(distance_m / channel.reference_distance_m);
            (channel.tx_power_dbm - 10.0 * channel.exponent * decades) * per_sigma
        };
        let mean: Vec<f64> = (0..CELLS + 2).map(mean).collect();
        let kept = 1.0 - channel.loss;
        let heard = |mean: &f64| kept * below(mean - channel.sensitivity_dbm * per_sigma);
        let ln = |p: f64| libm::log(p.max(LEAST));
        let ln_heard = mean.iter().map(|mean| ln(heard(mean))).collect();
        let ln_silent: Vec<f64> = mean.iter().map(|mean| ln(1.0 - heard(mean))).collect();
        let certain = ln_silent.iter().rposition(|&ln| ln < -CERTAIN).map_or(0, |last| last + 1);
        let certain_m = if certain > CELLS { f64::INFINITY } else { certain as f64 / per_m };
        Self { per_m, mean, ln_heard, ln_silent, per_sigma, certain_m }
    }

    /// The stops whose silence tells something of places in the box with these corners.
    pub(super) fn near(&self, stops: &[Position], low: Position, high: Position) -> Vec<Position> {
        let (low, high): ([f64; 3], [f64; 3]) = (low.into(), high.into());
        let least_m = |stop: &Position| {
            let along: [f64; 3] = (*stop).into();
            let outside = [0, 1, 2].map(|axis| (low[axis] - along[axis]).max(along[axis] - high[axis]).max(0.0));
            outside.iter().map(|way| way * way).sum::<f64>().sqrt()
        };
        stops.iter().copied().filter(|stop| least_m(stop) < self.certain_m).collect()
    }

    /// Log-probability that none of `stops` hears a node at a place.
    pub(super) fn ln_silence(&self, stops: &[Position], place: Position) -> f64 {
        stops.iter().map(|&stop| Cell::at(self, place.distance_m(stop)).of(&self.ln_silent)).sum()
    }

    /// Log-likelihood of a place, up to a constant, where the log-probability that all stops are silent is `ln_silence`.
    pub(super) fn log_likelihood(&self, links: &HeardByStops, place: Position, ln_silence: f64) -> f64 {
        let mut sum = ln_silence;
        for &(stop, rssi_dbm, share) in &links.heard {
            let cell = Cell::at(self, place.distance_m(stop));
            let misfit = rssi_dbm * self.per_sigma - cell.of(&self.mean);
            sum -= share * (0.5 * misfit * misfit + cell.of(&self.ln_silent));
        }
        for &(stop, share) in &links.unmeasured {
            let cell = Cell::at(self, place.distance_m(stop));
            sum += share * (cell.of(&self.ln_heard) - cell.of(&self.ln_silent));
        }
        for &stop in &links.deaf {
            sum -= Cell::at(self, place.distance_m(stop)).of(&self.ln_silent);
        }
        sum
    }
}

/// Where a distance lies in the tables.
#[derive(Clone, Copy)]
struct Cell {
    first: usize,
    within: f64,
}

impl Cell {
    #[inline]
    fn at(evidence: &StrengthEvidence, distance_m: f64) -> Self {
        let along = distance_m * evidence.per_m;
        let first = index(along).min(CELLS);
        Self { first, within: (along - first as f64).min(1.0) }
    }

    #[inline]
    fn of(self, table: &[f64]) -> f64 {
        let Self { first, within } = self;
        table[first] + within * (table[first + 1] - table[first])
    }
}

/// The standard normal distribution function.
pub(super) fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}
