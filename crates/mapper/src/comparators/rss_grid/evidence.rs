//! The likelihood of a node's strengths and silences under a channel that also loses packets for other reasons.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::channel::FittedChannel;
use crate::normal::Normal;

/// Below this distance the strength is constant (m).
pub(super) const LEAST_M: f64 = 0.1;

/// What the stops heard of one node.
#[derive(Clone, Debug, Default)]
pub(super) struct Links {
    /// Stops that heard it with a strength (dBm).
    pub(super) heard: Vec<(Position, f64)>,
    /// Stops that heard it without one.
    pub(super) unmeasured: Vec<Position>,
    /// Stops that listened and heard nothing.
    pub(super) silent: Vec<Position>,
}

impl Links {
    pub(super) fn of(log: &ReceptionLog, node: NodeId) -> Self {
        let mut links = Self::default();
        let mut entries = log.of(node).iter().peekable();
        for (index, stop) in (0_u32..).zip(log.stops()) {
            let entry = entries.next_if(|entry| entry.stop == index);
            let (received, sent) = entry.as_ref().map_or((0, 1), |entry| (entry.received, entry.sent));
            match (received, entry.and_then(|entry| entry.rssi_dbm)) {
                (0, _) if sent == 0 => {}
                (0, _) => links.silent.push(stop.position),
                (_, Some(rssi_dbm)) => links.heard.push((stop.position, rssi_dbm)),
                (_, None) => links.unmeasured.push(stop.position),
            }
        }
        links
    }
}

/// A channel, ready to compute likelihoods.
#[derive(Clone, Debug)]
pub(super) struct Evidence {
    channel: FittedChannel,
    /// Decibels over a factor of e in squared distance.
    slope: f64,
    per_sigma: f64,
    normal: Normal,
}

impl Evidence {
    pub(super) fn new(channel: FittedChannel) -> Self {
        let slope = 5.0 * channel.exponent / std::f64::consts::LN_10;
        Self { slope, per_sigma: 1.0 / channel.sigma_db, normal: Normal::new(), channel }
    }

    /// Mean strength over the way `apart` (dBm).
    #[inline]
    fn mean_dbm(&self, apart: Position) -> f64 {
        let square = apart.dot(apart).max(LEAST_M * LEAST_M);
        let reference_m = self.channel.reference_distance_m;
        self.channel.tx_power_dbm - self.slope * libm::log(square / (reference_m * reference_m))
    }

    /// Probability that the strength over the way `apart` is above the sensitivity.
    #[inline]
    fn audible(&self, apart: Position) -> f64 {
        self.normal.below((self.mean_dbm(apart) - self.channel.sensitivity_dbm) * self.per_sigma)
    }

    /// Log-likelihood of a place, up to a constant.
    pub(super) fn log_likelihood(&self, links: &Links, place: Position) -> f64 {
        let kept = 1.0 - self.channel.loss;
        let mut sum = 0.0;
        for &(stop, rssi_dbm) in &links.heard {
            let misfit = (rssi_dbm - self.mean_dbm(place - stop)) * self.per_sigma;
            sum -= 0.5 * misfit * misfit;
        }
        let (mut product, mut factors) = (1.0, 0);
        let mut multiply = |factor: f64| {
            product *= factor;
            factors += 1;
            if factors == 32 {
                sum += libm::log(product);
                (product, factors) = (1.0, 0);
            }
        };
        links.unmeasured.iter().for_each(|&stop| multiply((kept * self.audible(place - stop)).max(1e-6)));
        links.silent.iter().for_each(|&stop| multiply((1.0 - kept * self.audible(place - stop)).max(1e-6)));
        sum + libm::log(product)
    }
}
