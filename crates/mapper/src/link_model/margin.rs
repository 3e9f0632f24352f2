//! How strong a link is: the margin of the signal over what the receiver needs, in standard deviations of the fading.

use std::sync::LazyLock;

use super::links::{Link, Links};
use crate::normal::{below, density};

/// Margins for which likelihoods are computed: the lowest, the distance between two, and their number.
const LOWEST: f64 = -8.0;
const STEP: f64 = 0.1;
const MARGINS: usize = 281;
/// A margin is never known better than this: the fading of a link is not quite that of another.
const LEAST_SPREAD: f64 = 0.15;
/// Information on a margin that a site has at least.
const LEAST_PRECISION: f64 = 1e-3;
/// The receiver is estimated from at most so many links.
const ENOUGH_LINKS: usize = 500;
/// Fewer links with a strength than this say nothing of the receiver.
const LEAST_LINKS: usize = 12;

/// Functions of a margin m: ln Φ(m), ln Φ(−m), the mean strength of what is received in excess of the threshold, and its
/// variance, both in units of the fading.
struct Tables {
    margin: [f64; MARGINS],
    received: [f64; MARGINS],
    lost: [f64; MARGINS],
    excess: [f64; MARGINS],
    variance: [f64; MARGINS],
}

static TABLES: LazyLock<Tables> = LazyLock::new(|| {
    let margin = std::array::from_fn(|i| LOWEST + STEP * i as f64);
    let received = margin.map(|m| libm::log(below(m).max(1e-300)));
    let lost = margin.map(|m: f64| libm::log(below(-m).max(1e-300)));
    // Moments of a normal variable that is cut off from below (the inverse Mills ratio).
    let mills = margin.map(|m| density(m) / below(m).max(1e-300));
    let excess = std::array::from_fn(|i| margin[i] + mills[i]);
    let variance = std::array::from_fn(|i| (1.0 - mills[i] * (margin[i] + mills[i])).max(0.02));
    Tables { margin, received, lost, excess, variance }
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
    /// The receiver that explains shares and strengths best; `None` if too few links have a strength, or all the same.
    pub(super) fn of(links: &Links) -> Option<Self> {
        let measured: Vec<Link> =
            links.nodes.iter().flat_map(|node| &node.links).copied().filter(is_measured).collect();
        let sample: Vec<Link> = measured.iter().copied().step_by((measured.len() / ENOUGH_LINKS).max(1)).collect();
        let mut strengths: Vec<f64> = sample.iter().filter_map(|link| link.rssi_dbm).collect();
        strengths.sort_by(f64::total_cmp);
        let (Some(&low), Some(&high)) = (strengths.first(), strengths.last()) else { return None };
        if measured.len() < LEAST_LINKS || high - low < 1.0 {
            return None;
        }
        let weak = strengths[strengths.len() / 50];
        // Only every third margin: the search needs no more.
        let sample: Vec<(Link, Vec<f64>)> = sample.iter().map(|link| (*link, counts_only(link))).collect();
        let usual = usual(&sample);
        let score = |receiver: &Self| -> f64 {
            sample.iter().map(|(link, counts)| receiver.plausibility(link, counts, &usual)).sum()
        };
        let mut best = (f64::NEG_INFINITY, Self { threshold_dbm: weak, fading_db: 3.0, error_db: 1.0 });
        for below_db in [6.0, 4.0, 2.0, 1.0, 0.0, -2.0, -4.0] {
            for fading_db in [0.5, 1.0, 2.0, 3.0, 4.5, 6.5] {
                for error_db in [0.5, 1.0, 2.0, 3.0] {
                    let receiver = Self { threshold_dbm: weak - below_db, fading_db, error_db };
                    let score = score(&receiver);
                    if score > best.0 {
                        best = (score, receiver);
                    }
                }
            }
        }
        for step in [1.0, 0.5, 0.25] {
            for _ in 0..8 {
                let from = best;
                for (by_db, fading, error) in [
                    (1.5, 0.0, 0.0),
                    (-1.5, 0.0, 0.0),
                    (0.0, 0.3, 0.0),
                    (0.0, -0.3, 0.0),
                    (0.0, 0.0, 0.3),
                    (0.0, 0.0, -0.3),
                ] {
                    let receiver = Self {
                        threshold_dbm: best.1.threshold_dbm + by_db * step,
                        fading_db: (best.1.fading_db * libm::exp(fading * step)).clamp(0.3, 12.0),
                        error_db: (best.1.error_db * libm::exp(error * step)).clamp(0.3, 12.0),
                    };
                    let score = score(&receiver);
                    if score > best.0 + 1e-6 {
                        best = (score, receiver);
                    }
                }
                if best.0 <= from.0 {
                    break;
                }
            }
        }
        Some(best.1)
    }

    /// Logarithm of the probability of share and strength of a link whose margin is one of the `usual` ones.
    fn plausibility(&self, link: &Link, counts: &[f64], usual: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (third, (count, usual)) in counts.iter().zip(usual).enumerate() {
            if count * usual > 1e-12 {
                sum += count * usual * libm::exp(self.strength(link, 3 * third));
            }
        }
        libm::log(sum.max(1e-300))
    }

    /// Logarithm of the density of the strength of `link` at margin `i`.
    fn strength(&self, link: &Link, i: usize) -> f64 {
        let tables = &*TABLES;
        let Some(rssi_dbm) = link.rssi_dbm else { return 0.0 };
        let mean = self.threshold_dbm + self.fading_db * tables.excess[i];
        let packets = f64::from(link.received.max(1));
        let variance = self.error_db * self.error_db + self.fading_db * self.fading_db * tables.variance[i] / packets;
        let error = rssi_dbm - mean;
        -0.5 * (error * error / variance + libm::log(variance))
    }
}

/// The density of the margins of links with these likelihoods of packets, at every third margin: the normal distribution of
/// highest likelihood, by expectation maximisation.
fn usual(sample: &[(Link, Vec<f64>)]) -> Vec<f64> {
    let margins: Vec<f64> = TABLES.margin.iter().copied().step_by(3).collect();
    let (mut mean, mut deviation) = (0.0, 3.0);
    let densities = |mean: f64, deviation: f64| -> Vec<f64> {
        let at = |margin: &f64| density((margin - mean) / deviation) / deviation;
        margins.iter().map(at).collect()
    };
    for _ in 0..30 {
        let usual = densities(mean, deviation);
        let (mut first, mut second) = (0.0, 0.0);
        for (_, counts) in sample {
            let shares =
                || counts.iter().zip(&usual).zip(&margins).map(|((count, usual), margin)| (count * usual, margin));
            let total: f64 = shares().map(|(share, _)| share).sum::<f64>().max(1e-300);
            first += shares().map(|(share, margin)| share * margin).sum::<f64>() / total;
            second += shares().map(|(share, margin)| share * margin * margin).sum::<f64>() / total;
        }
        let count = sample.len().max(1) as f64;
        mean = (first / count).clamp(-3.0, 3.0);
        deviation = (second / count - mean * mean).max(0.0).sqrt().clamp(0.7, 3.0);
    }
    densities(mean, deviation)
}

fn is_measured(link: &Link) -> bool {
    link.received > 0 && link.rssi_dbm.is_some_and(f64::is_finite)
}

/// The likelihood of the packets of `link` at every third margin, at most 1.
fn counts_only(link: &Link) -> Vec<f64> {
    let logs: Vec<f64> = (0..MARGINS).step_by(3).map(|i| counts(link, i)).collect();
    let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    logs.iter().map(|log| libm::exp(log - highest)).collect()
}

/// Logarithm of the likelihood of the packets of `link` at margin `i`, up to a constant.
fn counts(link: &Link, i: usize) -> f64 {
    let tables = &*TABLES;
    f64::from(link.received) * tables.received[i] + f64::from(link.sent - link.received) * tables.lost[i]
}

/// The probability of the packets of `link` if its margin is normally distributed.
pub(super) fn probability(link: &Link, mean: f64, deviation: f64) -> f64 {
    const POINTS: u32 = 48;
    let (received, sent) = (f64::from(link.received), f64::from(link.sent));
    let ways = libm::lgamma(sent + 1.0) - libm::lgamma(received + 1.0) - libm::lgamma(sent - received + 1.0);
    let (mut sum, mut total) = (0.0, 0.0);
    for point in 0..=POINTS {
        let at = 8.0 * f64::from(point) / f64::from(POINTS) - 4.0;
        let margin = mean + deviation * at;
        let logs = received * libm::log(below(margin).max(1e-300))
            + (sent - received) * libm::log(below(-margin).max(1e-300));
        let weight = density(at);
        total += weight;
        sum += weight * libm::exp(ways + logs);
    }
    (sum / total).min(1.0)
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
    pub(super) fn of(link: &Link, receiver: Option<&Receiver>, predicted: f64, spread: f64) -> Self {
        let tables = &*TABLES;
        let precision = 1.0 / (spread * spread);
        let mut logs = [0.0; MARGINS];
        let mut highest = f64::NEG_INFINITY;
        for (i, log) in logs.iter_mut().enumerate() {
            let error = tables.margin[i] - predicted;
            *log = counts(link, i) - 0.5 * precision * error * error;
            if let Some(receiver) = receiver {
                *log += receiver.strength(link, i);
            }
            highest = highest.max(*log);
        }
        let (mut total, mut first, mut second) = (0.0, 0.0, 0.0);
        for (log, margin) in logs.iter().zip(&tables.margin) {
            if *log > highest - 30.0 {
                let share = libm::exp(log - highest);
                total += share;
                first += share * margin;
                second += share * margin * margin;
            }
        }
        let mean = first / total;
        let variance = (second / total - mean * mean).max(1e-6);
        let own = (1.0 / variance - precision).max(LEAST_PRECISION);
        let margin = (mean / variance - predicted * precision) / own;
        // A site that says next to nothing may lie anywhere; keep it near.
        let margin = margin.clamp(predicted.min(mean) - 30.0, predicted.max(mean) + 30.0);
        Self { margin, variance: 1.0 / own + LEAST_SPREAD * LEAST_SPREAD }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(received: u32, sent: u32) -> Link {
        Link { place: 0, received, sent, rssi_dbm: None }
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
