//! How strong a link is: the margin of the signal over what the receiver needs, in standard deviations of the fading.

use std::sync::LazyLock;

use super::hearing::Hearing;
use super::links::Link;
use super::losses::Losses;
use crate::normal::{below, density};

/// Margins for which likelihoods are computed: the lowest, the distance between two, and their number.
const LOWEST: f64 = -8.0;
pub(super) const STEP: f64 = 0.1;
const MARGINS: usize = 281;
/// Above this margin a link loses no packet because of its power, and a strength tells the margin as it is.
const STRONG: f64 = 8.0;
/// Distance of margins beyond the tables, and how far from a prediction they go, in its deviations.
const BEYOND: f64 = 0.25;
const FAR: f64 = 5.0;
/// A margin is never known better than this: the fading of a link is not quite that of another.
const LEAST_SPREAD: f64 = 0.15;
/// Information on a margin that a site has at least.
const LEAST_PRECISION: f64 = 1e-3;

/// Functions of a margin m: the mean strength of what is received in excess of the threshold, and its variance, both in
/// units of the fading.
pub(super) struct Tables {
    pub(super) margin: [f64; MARGINS],
    excess: [f64; MARGINS],
    variance: [f64; MARGINS],
}

pub(super) static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let margin = std::array::from_fn(|i| LOWEST + STEP * i as f64);
    // Moments of a normal variable that is cut off from below (the inverse Mills ratio).
    let mills = margin.map(|m| density(m) / below(m).max(1e-300));
    let excess = std::array::from_fn(|i| margin[i] + mills[i]);
    let variance = std::array::from_fn(|i| (1.0 - mills[i] * (margin[i] + mills[i])).max(0.02));
    Tables { margin, excess, variance }
});

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
    pub(super) fn log_density(&self, link: &Link, i: usize) -> f64 {
        let tables = &*TABLES;
        let Some(rssi_dbm) = link.rssi_dbm else { return 0.0 };
        let mean = self.threshold_dbm + self.fading_db * tables.excess[i];
        let variance = self.variance_db2(link, tables.variance[i]);
        let error = rssi_dbm - mean;
        -0.5 * (error * error / variance + libm::log(variance))
    }

    /// What a strength tells of the margin of `link` if it is so great that no packet is lost for want of power.
    pub(super) fn strong(&self, link: &Link, rssi_dbm: f64) -> Option<Site> {
        let margin = (rssi_dbm - self.threshold_dbm) / self.fading_db;
        let variance = self.variance_db2(link, 1.0) / (self.fading_db * self.fading_db);
        (margin > STRONG).then_some(Site { margin, variance })
    }

    /// Variance of the mean strength of the packets received, of which each has `share` of the variance of the fading (dB²).
    fn variance_db2(&self, link: &Link, share: f64) -> f64 {
        let packets = f64::from(link.received.max(1));
        self.error_db * self.error_db + self.fading_db * self.fading_db * share / packets
    }
}

/// The probability of the packets of a link if its margin is normally distributed, unless it is dead.
pub(super) fn probability(losses: Losses, link: &Link, mean: f64, deviation: f64) -> f64 {
    const POINTS: u32 = 48;
    let (received, sent) = (f64::from(link.received), f64::from(link.sent));
    let ways = libm::lgamma(sent + 1.0) - libm::lgamma(received + 1.0) - libm::lgamma(sent - received + 1.0);
    let (mut sum, mut total) = (0.0, 0.0);
    for point in 0..=POINTS {
        let at = 8.0 * f64::from(point) / f64::from(POINTS) - 4.0;
        let log = losses.log_probability(link.received, link.sent, below(mean + deviation * at));
        let weight = density(at);
        total += weight;
        sum += weight * libm::exp(ways + log);
    }
    let alive = (sum / total).min(1.0);
    if link.received == 0 { link.outage + (1.0 - link.outage) * alive } else { (1.0 - link.outage) * alive }
}

/// Density of the mean strength of the packets of a link that was received (1/dB), given their number, if its margin is
/// normally distributed.
pub(super) fn strength_density(losses: Losses, receiver: &Receiver, link: &Link, mean: f64, deviation: f64) -> f64 {
    const POINTS: u32 = 96;
    let Some(rssi_dbm) = link.rssi_dbm else { return 1.0 };
    let logs = (0..=POINTS).map(|point| {
        let at = 10.0 * f64::from(point) / f64::from(POINTS) - 5.0;
        let margin = mean + deviation * at;
        let count = losses.log_probability(link.received, link.sent, below(margin)) - 0.5 * at * at;
        let mills = density(margin) / below(margin).max(1e-300);
        let excess = if margin < LOWEST { 0.0 } else { margin + mills };
        let share = if margin < LOWEST { 0.02 } else { (1.0 - mills * (margin + mills)).max(0.02) };
        let variance = receiver.variance_db2(link, share);
        let error = rssi_dbm - receiver.threshold_dbm - receiver.fading_db * excess;
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

/// A normal approximation of what a link says of its margin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Site {
    pub(super) margin: f64,
    pub(super) variance: f64,
}

impl Site {
    /// The approximation round a prediction of the margin: mean and variance of likelihood times prediction, without the
    /// prediction (a step of expectation propagation; Minka 2001).
    pub(super) fn of(link: &Link, hearing: &Hearing, predicted: f64, spread: f64) -> Self {
        let receiver = hearing.receiver.as_ref();
        if let Some(Self { margin, variance }) =
            receiver.zip(link.rssi_dbm).and_then(|(receiver, rssi_dbm)| receiver.strong(link, rssi_dbm))
        {
            return Self { margin, variance: variance + LEAST_SPREAD * LEAST_SPREAD };
        }
        let tables = &*TABLES;
        let counts = hearing.counts.log_likelihoods(link);
        let precision = 1.0 / (spread * spread);
        let mut logs: Vec<(f64, f64)> = Vec::with_capacity(MARGINS);
        let prior = |margin: f64| -0.5 * precision * (margin - predicted) * (margin - predicted);
        for (i, (&margin, &count)) in tables.margin.iter().zip(counts.iter()).enumerate() {
            let count = if link.received == 0 { silence(count, link.outage) } else { count };
            let strength = receiver.map_or(0.0, |receiver| receiver.log_density(link, i));
            logs.push((margin, count + strength + prior(margin)));
        }
        // Beyond the tables, packets say no more.
        if receiver.is_none() || link.rssi_dbm.is_none() {
            let (lowest, highest) = (logs[0], logs[MARGINS - 1]);
            let ends = [(lowest, -1.0), (highest, 1.0)];
            for ((end, log), side) in ends {
                let mut margin = end + side * BEYOND;
                while side * (predicted - margin) > -FAR * spread {
                    logs.push((margin, log - prior(end) + prior(margin) + libm::log(BEYOND / STEP)));
                    margin += side * BEYOND;
                }
            }
        }
        let highest = logs.iter().map(|&(_, log)| log).fold(f64::NEG_INFINITY, f64::max);
        let (mut total, mut first, mut second) = (0.0, 0.0, 0.0);
        for &(margin, log) in &logs {
            if log > highest - 30.0 {
                let (share, above) = (libm::exp(log - highest), margin - predicted);
                total += share;
                first += share * above;
                second += share * above * above;
            }
        }
        let above = first / total;
        let variance = (second / total - above * above).max(1e-6);
        let mean = predicted + above;
        let own = (1.0 / variance - precision).max(LEAST_PRECISION);
        let margin = (mean / variance - predicted * precision) / own;
        // A site that says next to nothing may lie anywhere; keep it near.
        let margin = margin.clamp(predicted.min(mean) - 30.0, predicted.max(mean) + 30.0);
        Self { margin, variance: 1.0 / own + LEAST_SPREAD * LEAST_SPREAD }
    }
}

/// Logarithm of the probability that nothing is heard of a link: it is dead, or all packets are lost, which has the
/// logarithm `lost`.
fn silence(lost: f64, outage: f64) -> f64 {
    libm::log(outage + (1.0 - outage) * libm::exp(lost))
}

/// The probability that nothing is heard of `link` if it is not dead, and its margin is normally distributed round a
/// prediction.
pub(super) fn silence_of_living(link: &Link, hearing: &Hearing, predicted: f64, spread: f64) -> f64 {
    let counts = hearing.counts.log_likelihoods(&Link { received: 0, ..*link });
    let (mut sum, mut total) = (0.0, 0.0);
    for (count, margin) in counts.iter().zip(&TABLES.margin).step_by(3) {
        let weight = density((margin - predicted) / spread);
        total += weight;
        sum += weight * libm::exp(*count);
    }
    // Below the tables every packet is lost, above them none for want of power.
    let width = 3.0 * STEP / spread;
    let lower = below((LOWEST - predicted) / spread);
    let upper = below((predicted - TABLES.margin[MARGINS - 1]) / spread);
    let most = libm::exp(counts.last().copied().unwrap_or(0.0));
    ((sum * width + lower + upper * most) / (total * width + lower + upper).max(1e-12)).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(received: u32, sent: u32) -> Link {
        Link { place: 0, received, sent, rssi_dbm: None, outage: 0.0 }
    }

    #[test]
    fn the_site_of_one_packet_has_the_moments_of_the_probit_model() {
        // Closed form: for Φ(m) under N(μ, σ²), with z = μ / √(1 + σ²) and h = φ(z) / Φ(z), the mean is
        // μ + σ² h / √(1 + σ²) and the variance σ² − σ⁴ h (z + h) / (1 + σ²).
        for (mean, spread) in [(0.0, 1.0), (1.3, 0.7), (-2.0, 1.5)] {
            let variance: f64 = spread * spread;
            let root = (1.0 + variance).sqrt();
            let z: f64 = mean / root;
            let h = density(z) / below(z);
            let expected =
                (mean + variance * h / root, variance - variance * variance * h * (z + h) / (1.0 + variance));
            let site = Site::of(&link(1, 1), None, mean, spread);
            let own = site.variance - LEAST_SPREAD * LEAST_SPREAD;
            let precision = 1.0 / own + 1.0 / variance;
            let found = ((site.margin / own + mean / variance) / precision, 1.0 / precision);
            assert!(
                (found.0 - expected.0).abs() < 2e-3 && (found.1 - expected.1).abs() < 2e-3,
                "{found:?} {expected:?}"
            );
        }
    }

    #[test]
    fn probabilities_of_all_counts_add_up_to_one() {
        for (mean, deviation) in [(0.3, 0.0), (-1.0, 2.0), (4.0, 0.5)] {
            let total: f64 = (0..=7).map(|received| probability(&link(received, 7), mean, deviation)).sum();
            assert!((total - 1.0).abs() < 1e-9, "{total}");
        }
        // A margin without an error is a binomial distribution, here of half.
        assert!((probability(&link(1, 2), 0.0, 0.0) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn strengths_that_are_cut_off_at_the_threshold_tell_the_margin_below_them() {
        let receiver = Receiver { threshold_dbm: -90.0, fading_db: 4.0, error_db: 0.5 };
        // At a margin of -1, 16 % of the packets arrive, at a mean of -90 + 4 * (φ(1)/Φ(-1) - 1) dBm.
        let mills = density(1.0) / below(-1.0);
        let weak = Link { place: 0, received: 16, sent: 100, rssi_dbm: Some(-90.0 + 4.0 * (mills - 1.0)) };
        let site = Site::of(&weak, Some(&receiver), 0.0, 3.0);
        assert!((site.margin + 1.0).abs() < 0.1, "{site:?}");
        // Of a link that is always received, only the strength tells how strong it is.
        let strong = Link { place: 0, received: 100, sent: 100, rssi_dbm: Some(-70.0) };
        let site = Site::of(&strong, Some(&receiver), 0.0, 3.0);
        assert!((site.margin - 5.0).abs() < 0.1, "{site:?}");
    }
}
