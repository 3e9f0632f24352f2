//! How strong a link is: what its strength tells of its margin.

use std::ops::Range;

use sextant_kernel::maths::{exp_each, ln_each};

use super::links::HeardLink;
use super::losses::Losses;
use super::tables::{LOWEST, TABLES};
use crate::numerics::normal::{below, densities};

/// Above this margin a link loses no packet because of its power, and a strength tells the margin as it is.
const STRONG: f64 = 8.0;
/// A strength is far off a mean if it differs by so many standard deviations.
const FAR: f64 = 6.0;
/// Number of margins beside those near a strength.
const BESIDE: usize = 2;

/// A normal approximation of what a link says of its margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Site {
    pub(super) margin: f64,
    pub(super) variance: f64,
}

/// What strengths say of margins if they are means over some number of packets: their density is that of a normal distribution at
/// each margin of the tables.
#[derive(Clone, Debug)]
pub(super) struct StrengthTable {
    /// Minus one half of one over the variance (1/dB²).
    pub(super) precisions: Vec<f64>,
    /// Logarithm of one over the standard deviation.
    pub(super) logs: Vec<f64>,
    /// The highest of the logarithms.
    pub(super) highest: f64,
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
    /// Mean strength of the packets received over a link that are in excess of the threshold by so many deviations of the fading
    /// (dBm).
    pub(super) fn mean_dbm(&self, excess: f64) -> f64 {
        self.threshold_dbm + self.fading_db * excess
    }

    /// What the strength of `link` says at each margin of the tables.
    pub(super) fn table(&self, link: &HeardLink) -> StrengthTable {
        let variances = TABLES.variance.iter().map(|&share| self.variance_db2(link, share));
        let mut logs: Vec<f64> = variances.collect();
        let precisions = logs.iter().map(|variance| -0.5 / variance).collect();
        ln_each(&mut logs);
        logs.iter_mut().for_each(|log| *log *= -0.5);
        let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        StrengthTable { precisions, logs, highest }
    }

    /// The margins that a strength leaves possible, as numbers of a table, which has the `excess` of each: those at which the mean
    /// strength is not far off, and some on both sides.
    pub(super) fn margins_near(&self, link: &HeardLink, rssi_dbm: f64, excess: &[f64]) -> Range<usize> {
        let most = FAR * self.variance_db2(link, 1.0).sqrt();
        let below = |dbm: f64| excess.partition_point(|&excess| self.mean_dbm(excess) < dbm);
        let (first, last) = (below(rssi_dbm - most), below(rssi_dbm + most));
        // A strength below all of them is nowhere usual.
        if last == 0 { 0..excess.len() } else { first.saturating_sub(BESIDE)..(last + BESIDE).min(excess.len()) }
    }

    /// What a strength tells of the margin of `link` if it is so great that no packet is lost for want of power.
    pub(super) fn strong(&self, link: &HeardLink, rssi_dbm: f64) -> Option<Site> {
        let margin = (rssi_dbm - self.threshold_dbm) / self.fading_db;
        let variance = self.variance_db2(link, 1.0) / (self.fading_db * self.fading_db);
        (margin > STRONG).then_some(Site { margin, variance })
    }

    /// Variance of the mean strength of the packets received, of which each has `share` of the variance of the fading (dB²).
    pub(super) fn variance_db2(&self, link: &HeardLink, share: f64) -> f64 {
        let packets = f64::from(link.received.max(1));
        self.error_db * self.error_db + self.fading_db * self.fading_db * share / packets
    }

    /// Density of the mean strength of the packets of a link that was received (1/dB), given their number, if its margin is
    /// normally distributed.
    pub(super) fn density(&self, losses: Losses, link: &HeardLink, mean: f64, deviation: f64) -> f64 {
        const POINTS: u32 = 96;
        let Some(rssi_dbm) = link.rssi_dbm else { return 1.0 };
        let at: [f64; POINTS as usize + 1] =
            std::array::from_fn(|point| 10.0 * point as f64 / f64::from(POINTS) - 5.0);
        let margins = at.map(|at| mean + deviation * at);
        let reached = margins.map(below);
        let densities = densities(margins);
        let mut counts = losses.arrivals().log_likelihoods(link.received, link.sent, &reached);
        let mut variances = [0.0; POINTS as usize + 1];
        let mut both = [0.0; POINTS as usize + 1];
        for point in 0..at.len() {
            let margin = margins[point];
            let mills = densities[point] / reached[point].max(1e-300);
            let excess = if margin < LOWEST { 0.0 } else { margin + mills };
            let share = if margin < LOWEST { 0.02 } else { (1.0 - mills * (margin + mills)).max(0.02) };
            variances[point] = self.variance_db2(link, share);
            let error = rssi_dbm - self.mean_dbm(excess);
            counts[point] -= 0.5 * at[point] * at[point];
            both[point] = counts[point] - 0.5 * error * error / variances[point];
        }
        let highest = counts.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        counts.iter_mut().chain(&mut both).for_each(|log| *log -= highest);
        exp_each(&mut counts);
        exp_each(&mut both);
        let joint =
            both.iter().zip(&variances).map(|(both, variance)| both / (std::f64::consts::TAU * variance).sqrt());
        joint.sum::<f64>() / counts.iter().sum::<f64>().max(1e-300)
    }
}
