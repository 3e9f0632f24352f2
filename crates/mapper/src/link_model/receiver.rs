//! How strong a link is: what its strength tells of its margin.

use super::links::HeardLink;
use super::losses::Losses;
use super::tables::{LOWEST, TABLES};
use crate::numerics::normal::{below, density};

/// Above this margin a link loses no packet because of its power, and a strength tells the margin as it is.
const STRONG: f64 = 8.0;

/// A normal approximation of what a link says of its margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Site {
    pub(super) margin: f64,
    pub(super) variance: f64,
}

/// How a receiver turns margins into strengths.
///
/// A packet is received if its strength, with its fading, is above the threshold. So the mean strength of the packets that
/// were received is that of a normal distribution that is cut off from below (censored as in Tobin 1958).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Receiver {
    /// The strength at which half of the packets are received (dBm).
    pub threshold_dbm: f64,
    /// Standard deviation of the strength over the packets of a link (dB).
    pub fading_db: f64,
    /// Error of a mean strength beyond the fading: offsets of receivers, quantisation (dB).
    pub error_db: f64,
}

impl Receiver {
    /// Logarithm of the density of the strength of `link` at margin `i` of the tables.
    pub(super) fn log_density(&self, link: &HeardLink, i: usize) -> f64 {
        let tables = &*TABLES;
        let Some(rssi_dbm) = link.rssi_dbm else { return 0.0 };
        let mean = self.threshold_dbm + self.fading_db * tables.excess[i];
        let variance = self.variance_db2(link, tables.variance[i]);
        let error = rssi_dbm - mean;
        -0.5 * (error * error / variance + libm::log(variance))
    }

    /// What a strength tells of the margin of `link` if it is so great that no packet is lost for want of power.
    pub(super) fn strong(&self, link: &HeardLink, rssi_dbm: f64) -> Option<Site> {
        let margin = (rssi_dbm - self.threshold_dbm) / self.fading_db;
        let variance = self.variance_db2(link, 1.0) / (self.fading_db * self.fading_db);
        (margin > STRONG).then_some(Site { margin, variance })
    }

    /// Variance of the mean strength of the packets received, of which each has `share` of the variance of the fading (dB²).
    fn variance_db2(&self, link: &HeardLink, share: f64) -> f64 {
        let packets = f64::from(link.received.max(1));
        self.error_db * self.error_db + self.fading_db * self.fading_db * share / packets
    }

    /// Density of the mean strength of the packets of a link that was received (1/dB), given their number, if its margin is
    /// normally distributed.
    pub(super) fn density(&self, losses: Losses, link: &HeardLink, mean: f64, deviation: f64) -> f64 {
        const POINTS: u32 = 96;
        let Some(rssi_dbm) = link.rssi_dbm else { return 1.0 };
        let arrivals = losses.arrivals();
        let logs = (0..=POINTS).map(|point| {
            let at = 10.0 * f64::from(point) / f64::from(POINTS) - 5.0;
            let margin = mean + deviation * at;
            let count = arrivals.log_probability(link.received, link.sent, below(margin)) - 0.5 * at * at;
            let mills = density(margin) / below(margin).max(1e-300);
            let excess = if margin < LOWEST { 0.0 } else { margin + mills };
            let share = if margin < LOWEST { 0.02 } else { (1.0 - mills * (margin + mills)).max(0.02) };
            let variance = self.variance_db2(link, share);
            let error = rssi_dbm - self.threshold_dbm - self.fading_db * excess;
            let strength = -0.5 * (error * error / variance + libm::log(std::f64::consts::TAU * variance));
            (count, count + strength)
        });
        let logs: Vec<(f64, f64)> = logs.collect();
        let highest = logs.iter().map(|&(count, _)| count).fold(f64::NEG_INFINITY, f64::max);
        let sums = logs.iter().fold((0.0, 0.0), |(counts, both), &(count, joint)| {
            (counts + libm::exp(count - highest), both + libm::exp(joint - highest))
        });
        sums.1 / sums.0.max(1e-300)
    }
}
