//! What a link says of its margin, as a normal distribution.

use super::hearing::Hearing;
use super::links::HeardLink;
pub(super) use super::receiver::Site;
use super::tables::{LOWEST, MARGINS, STEP, TABLES};
use crate::numerics::normal::{below, density};

/// Distance of margins beyond the tables, and how far from a prediction they go, in its deviations.
const BEYOND: f64 = 0.25;
const FAR: f64 = 5.0;
/// A margin is never known better than this: the fading of a link is not quite that of another.
const LEAST_SPREAD: f64 = 0.15;
/// Information on a margin that a site has at least.
const LEAST_PRECISION: f64 = 1e-3;

impl Site {
    /// The approximation round a prediction of the margin: mean and variance of likelihood times prediction, without the
    /// prediction (a step of expectation propagation; Minka 2001).
    pub(super) fn of(link: &HeardLink, hearing: &Hearing, predicted: f64, spread: f64) -> Self {
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
pub(super) fn silence_of_living(link: &HeardLink, hearing: &Hearing, predicted: f64, spread: f64) -> f64 {
    let counts = hearing.counts.log_likelihoods(&HeardLink { received: 0, ..*link });
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
    use super::super::losses::{CountTables, Losses};
    use super::super::receiver::Receiver;
    use super::*;

    fn hearing(losses: Losses, receiver: Option<Receiver>) -> Hearing {
        Hearing { receiver, counts: CountTables::new(losses) }
    }

    fn link(received: u32, sent: u32) -> HeardLink {
        HeardLink { place: 0, received, sent, rssi_dbm: None, outage: 0.0 }
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
            let site = Site::of(&link(1, 1), &hearing(Losses::NONE, None), mean, spread);
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
        let cases =
            [(0.3, 0.0, Losses::NONE), (-1.0, 2.0, Losses { lapse: 0.3, scatter: 1.2 }), (4.0, 0.5, Losses::NONE)];
        for (mean, deviation, losses) in cases {
            let total: f64 = (0..=7).map(|received| losses.probability(&link(received, 7), mean, deviation)).sum();
            assert!((total - 1.0).abs() < 1e-9, "{total}");
        }
        // A margin without an error is a binomial distribution, here of half.
        assert!((Losses::NONE.probability(&link(1, 2), 0.0, 0.0) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn strengths_that_are_cut_off_at_the_threshold_tell_the_margin_below_them() {
        let receiver = Receiver { threshold_dbm: -90.0, fading_db: 4.0, error_db: 0.5 };
        // At a margin of -1, 16 % of the packets arrive, at a mean of -90 + 4 * (φ(1)/Φ(-1) - 1) dBm.
        let mills = density(1.0) / below(-1.0);
        let weak = HeardLink { rssi_dbm: Some(-90.0 + 4.0 * (mills - 1.0)), ..link(16, 100) };
        let site = Site::of(&weak, &hearing(Losses::NONE, Some(receiver)), 0.0, 3.0);
        assert!((site.margin + 1.0).abs() < 0.1, "{site:?}");
        // Of a link that is always received, only the strength tells how strong it is.
        let strong = HeardLink { rssi_dbm: Some(-70.0), ..link(100, 100) };
        let site = Site::of(&strong, &hearing(Losses::NONE, Some(receiver)), 0.0, 3.0);
        assert!((site.margin - 5.0).abs() < 0.1, "{site:?}");
    }

    #[test]
    fn losses_that_power_does_not_cause_do_not_make_a_strong_link_weak() {
        let receiver = Receiver { threshold_dbm: -90.0, fading_db: 4.0, error_db: 0.5 };
        let strong = HeardLink { rssi_dbm: Some(-66.0), ..link(6, 10) };
        let misled = Site::of(&strong, &hearing(Losses::NONE, Some(receiver)), 0.0, 3.0);
        let told = Site::of(&strong, &hearing(Losses { lapse: 0.4, scatter: 0.5 }, Some(receiver)), 0.0, 3.0);
        assert!((told.margin - 6.0).abs() < 0.2, "{told:?}");
        assert!(misled.margin < 5.0, "{misled:?}");
    }

    #[test]
    fn silence_of_a_link_that_may_be_dead_says_little() {
        let silent = link(0, 10);
        let sure = Site::of(&silent, &hearing(Losses::NONE, None), 4.0, 1.0);
        let doubted = Site::of(&HeardLink { outage: 0.3, ..silent }, &hearing(Losses::NONE, None), 4.0, 1.0);
        assert!(doubted.variance > 20.0 * sure.variance, "{doubted:?} {sure:?}");
    }

    #[test]
    fn a_prediction_far_beyond_the_tables_is_not_pulled_back_by_them() {
        // Nothing that a silent link far away says moves a margin that is below all tables already.
        let site = Site::of(&link(0, 3), &hearing(Losses::NONE, None), -25.0, 4.0);
        assert!(site.variance > 100.0, "{site:?}");
        let site = Site::of(&link(3, 3), &hearing(Losses::NONE, None), 30.0, 4.0);
        assert!(site.variance > 100.0, "{site:?}");
    }
}
