//! The likelihood of a node's strengths and silences under a channel that also loses packets for other reasons.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::fitted_channel::FittedChannel;
use crate::numerics::normal::index;

/// Least probability of what a stop heard.
const LEAST: f64 = 1e-6;
/// A logarithm of a probability this near to 0 is 0.
const CERTAIN: f64 = 1e-12;
/// Below this distance the strength is constant (m).
pub(super) const LEAST_M: f64 = 0.1;

/// What the stops heard of one node.
#[derive(Clone, Debug, Default)]
pub(super) struct HeardByStops {
    /// Stops that heard it with a strength (dBm), and the share of the packets that they received.
    pub(super) heard: Vec<(Position, f64, f64)>,
    /// Stops that heard it without one, and this share.
    pub(super) unmeasured: Vec<(Position, f64)>,
    /// Stops that missed packets, and their share: the strengths of these packets are only known to be low.
    pub(super) silent: Vec<(Position, f64)>,
}

impl HeardByStops {
    pub(super) fn of(log: &ReceptionLog, node: NodeId) -> Self {
        let mut links = Self::default();
        let mut entries = log.of(node).iter().peekable();
        for (index, stop) in (0_u32..).zip(log.stops()) {
            let entry = entries.next_if(|entry| entry.stop == index);
            let (received, sent) = entry.as_ref().map_or((0, 1), |entry| (entry.received, entry.sent));
            if sent == 0 {
                continue;
            }
            // The packets of a link share most of what weakens them, so they count as one.
            let share = f64::from(received) / f64::from(sent);
            if received < sent {
                links.silent.push((stop.position, 1.0 - share));
            }
            match entry.and_then(|entry| entry.rssi_dbm) {
                _ if received == 0 => {}
                Some(rssi_dbm) => links.heard.push((stop.position, rssi_dbm, share)),
                None => links.unmeasured.push((stop.position, share)),
            }
        }
        links
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

    /// The links of a node without the silent stops that tell nothing of places in the box with these corners.
    pub(super) fn near(&self, links: &HeardByStops, low: [f64; 3], high: [f64; 3]) -> HeardByStops {
        let least_m = |stop: Position| {
            let along: [f64; 3] = stop.into();
            let outside = [0, 1, 2].map(|axis| (low[axis] - along[axis]).max(along[axis] - high[axis]).max(0.0));
            outside.iter().map(|way| way * way).sum::<f64>().sqrt()
        };
        let silent = links.silent.iter().copied().filter(|&(stop, _)| least_m(stop) < self.certain_m).collect();
        HeardByStops { silent, ..links.clone() }
    }

    /// Log-likelihood of a place, up to a constant.
    pub(super) fn log_likelihood(&self, links: &HeardByStops, place: Position) -> f64 {
        let mut sum = 0.0;
        for &(stop, rssi_dbm, share) in &links.heard {
            let misfit = rssi_dbm * self.per_sigma - self.at(&self.mean, place.distance_m(stop));
            sum -= 0.5 * share * misfit * misfit;
        }
        for &(stop, share) in &links.unmeasured {
            sum += share * self.at(&self.ln_heard, place.distance_m(stop));
        }
        for &(stop, share) in &links.silent {
            sum += share * self.at(&self.ln_silent, place.distance_m(stop));
        }
        sum
    }

    #[inline]
    fn at(&self, table: &[f64], distance_m: f64) -> f64 {
        let along = distance_m * self.per_m;
        let cell = index(along).min(CELLS);
        table[cell] + (along - cell as f64).min(1.0) * (table[cell + 1] - table[cell])
    }
}

/// The standard normal distribution function.
pub(super) fn below(x: f64) -> f64 {
    0.5 * libm::erfc(-x * std::f64::consts::FRAC_1_SQRT_2)
}
