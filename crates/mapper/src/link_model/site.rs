//! What a link says of its margin, as a normal distribution.

use std::ops::Range;

use sextant_kernel::maths::{exp, exp_each, ln_each};

use super::hearing::{Hearing, MeasuredStrength};
use super::links::HeardLink;
use super::losses::CountTable;
pub(super) use super::receiver::Site;
use super::tables::{LOWEST, MARGINS, STEP, TABLES};
use crate::numerics::normal::index;

/// Distance of margins beyond the tables, and how far from a prediction they go, in its deviations.
const BEYOND: f64 = 0.25;
const FAR: f64 = 5.0;
/// A margin is never known better than this: the fading of a link is not quite that of another.
const LEAST_SPREAD: f64 = 0.15;
/// Margins that are so much less probable than the most probable one do not count (nats).
const NEGLIGIBLE: f64 = 30.0;
/// Sums over silence take every so many margins of the tables, as far from a prediction, in its deviations.
const EVERY: usize = 3;
const WIDTH: f64 = 5.5;
/// Silence that is less probable is told by margins farther off.
const LIKELY_ENOUGH: f64 = 1e-3;
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
        let counts = hearing.counts.table(link);
        if link.received == 0 {
            let silent = MarginMoments::of_silence(&counts, predicted, spread).or_dead(link.outage, spread);
            if silent.total > LIKELY_ENOUGH {
                return silent.site(predicted, spread);
            }
        }
        let strength = hearing.strength(link);
        let evidence = MarginEvidence { link, counts: &counts, strength: strength.as_ref() };
        let precision = 1.0 / (spread * spread);
        let prior = |margin: f64| -0.5 * precision * (margin - predicted) * (margin - predicted);
        let possible = evidence.possible(predicted, spread);
        let margins = &TABLES.margin[possible.clone()];
        let mut logs = [0.0; MARGINS];
        let logs = &mut logs[..possible.len()];
        evidence.log_likelihoods(possible, logs);
        logs.iter_mut().zip(margins).for_each(|(log, &margin)| *log += prior(margin));
        let mut highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Beyond the tables, packets say no more.
        let mut beyond: Vec<(f64, f64)> = Vec::new();
        if strength.is_none() {
            for (end, side) in [(0, -1.0), (MARGINS - 1, 1.0)] {
                let mut margin = TABLES.margin[end] + side * BEYOND;
                if side * (predicted - margin) > -FAR * spread {
                    let log = evidence.log_likelihood(end) + libm::log(BEYOND / STEP);
                    while side * (predicted - margin) > -FAR * spread {
                        beyond.push((margin, log + prior(margin)));
                        margin += side * BEYOND;
                    }
                }
            }
            highest = beyond.iter().map(|&(_, log)| log).fold(highest, f64::max);
        }
        let is_telling = |log: &f64| *log > highest - NEGLIGIBLE;
        let first = logs.iter().position(is_telling).unwrap_or(0);
        let last = logs.iter().rposition(is_telling).map_or(first, |last| last + 1);
        let (shares, margins) = (&mut logs[first..last], &margins[first..last]);
        shares.iter_mut().for_each(|share| *share -= highest);
        exp_each(shares);
        let mut sums = MarginMoments::default();
        shares.iter().zip(margins).for_each(|(share, margin)| sums.take(*share, margin - predicted));
        for (margin, log) in beyond.iter().filter(|(_, log)| is_telling(log)) {
            sums.take(exp(log - highest), margin - predicted);
        }
        sums.site(predicted, spread)
    }
}

/// Sums over margins: of their shares, and of the shares times powers of what they are above a prediction.
#[derive(Default)]
struct MarginMoments {
    total: f64,
    first: f64,
    second: f64,
}

impl MarginMoments {
    /// Of the probability that all packets are lost, which is that of the table of silence, with margins normally distributed
    /// round a prediction: the rule of trapezia, whose weights are a product each of the one before.
    fn of_silence(silence: &CountTable, predicted: f64, spread: f64) -> Self {
        let step = EVERY as f64 * STEP;
        let nearest = ((predicted - LOWEST) / step).round();
        let reach = (WIDTH * spread / step).ceil();
        let precision = 1.0 / (spread * spread);
        let mut above = LOWEST + step * (nearest - reach) - predicted;
        let mut weight = exp(-0.5 * precision * above * above);
        let mut growth = exp(-precision * step * (above + 0.5 * step));
        let slowing = exp(-precision * step * step);
        let (mut sums, mut total) = (Self::default(), 0.0);
        let mut take = |lost: f64| {
            sums.take(weight * lost, above);
            total += weight;
            weight *= growth;
            growth *= slowing;
            above += step;
        };
        // Below the tables every packet is lost, above them none for want of power.
        let points = index(2.0 * reach) + 1;
        let before = index((reach - nearest).max(0.0)).min(points);
        let first = index((nearest - reach).max(0.0));
        let within = silence.likelihoods.iter().step_by(EVERY).skip(first).take(points - before);
        (0..before).for_each(|_| take(1.0));
        let after = points - before - within.len();
        within.for_each(|&lost| take(lost));
        (0..after).for_each(|_| take(silence.likelihoods[MARGINS - 1]));
        Self { total: sums.total / total, first: sums.first / total, second: sums.second / total }
    }

    /// The same of a link that is dead with a probability, which says nothing of its margin.
    fn or_dead(self, outage: f64, spread: f64) -> Self {
        let alive = 1.0 - outage;
        Self {
            total: outage + alive * self.total,
            first: alive * self.first,
            second: outage * spread * spread + alive * self.second,
        }
    }

    /// The site of a margin that has these moments above a prediction, without the prediction.
    fn site(self, predicted: f64, spread: f64) -> Site {
        let Self { total, first, second } = self;
        let precision = 1.0 / (spread * spread);
        let above = first / total;
        let variance = (second / total - above * above).max(1e-6);
        let mean = predicted + above;
        let own = (1.0 / variance - precision).max(LEAST_PRECISION);
        let margin = (mean / variance - predicted * precision) / own;
        // A site that says next to nothing may lie anywhere; keep it near.
        let margin = margin.clamp(predicted.min(mean) - 30.0, predicted.max(mean) + 30.0);
        Site { margin, variance: 1.0 / own + LEAST_SPREAD * LEAST_SPREAD }
    }

    fn take(&mut self, share: f64, above: f64) {
        self.total += share;
        self.first += share * above;
        self.second += share * above * above;
    }
}

/// What a link says of its margin.
struct MarginEvidence<'a> {
    link: &'a HeardLink,
    counts: &'a CountTable,
    strength: Option<&'a MeasuredStrength<'a>>,
}

impl MarginEvidence<'_> {
    /// The logarithms of the likelihood at some margins of the tables.
    fn log_likelihoods(&self, margins: Range<usize>, out: &mut [f64]) {
        if self.link.received == 0 {
            let outage = self.link.outage;
            let lost = &self.counts.likelihoods[margins.clone()];
            // It is dead, or all packets are lost.
            out.iter_mut().zip(lost).for_each(|(out, lost)| *out = outage + (1.0 - outage) * lost);
            ln_each(out);
        } else {
            out.copy_from_slice(&self.counts.logs[margins.clone()]);
        }
        if let Some(strength) = self.strength {
            strength.add_to(out, margins);
        }
    }

    /// The logarithm of the likelihood at one margin.
    fn log_likelihood(&self, margin: usize) -> f64 {
        let mut log = [0.0];
        self.log_likelihoods(margin..margin + 1, &mut log);
        log[0]
    }

    /// The margins that may be anything but negligible where one with this spread is predicted: others are so far from the
    /// prediction that no likelihood makes up for it.
    fn possible(&self, predicted: f64, spread: f64) -> Range<usize> {
        let number = |margin: f64| index(((margin - LOWEST) / STEP).max(0.0)).min(MARGINS - 1);
        let nearest = number(predicted + 0.5 * STEP);
        let highest = if self.link.received == 0 { 0.0 } else { self.counts.highest };
        let highest = highest + self.strength.map_or(0.0, MeasuredStrength::highest);
        let nats = highest - self.log_likelihood(nearest) + NEGLIGIBLE;
        let off = TABLES.margin[nearest] - predicted;
        let most = (off * off + 2.0 * nats * spread * spread).sqrt();
        number(predicted - most)..number(predicted + most) + 1
    }
}

/// The probability that nothing is heard of `link` if it is not dead, and its margin is normally distributed round a
/// prediction.
pub(super) fn silence_of_living(link: &HeardLink, hearing: &Hearing, predicted: f64, spread: f64) -> f64 {
    MarginMoments::of_silence(&hearing.counts.silence(link), predicted, spread).total.min(1.0)
}

#[cfg(test)]
mod tests {
    use super::super::losses::Losses;
    use super::super::receiver::Receiver;
    use super::*;
    use crate::numerics::normal::{below, density};

    fn hearing(losses: Losses, receiver: Option<Receiver>) -> Hearing {
        Hearing::without_tables(receiver, losses)
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
    fn what_silence_says_is_the_integral_over_its_margins() {
        for (sent, predicted, spread, outage) in [
            (1, 0.4, 0.3, 0.01),
            (12, -1.0, 2.5, 0.002),
            (48, 3.0, 1.0, 0.2),
            (48, -9.0, 0.7, 0.01),
            (5, 21.0, 3.0, 0.05),
        ] {
            let link = HeardLink { outage, ..link(0, sent) };
            let losses = Losses { lapse: 0.1, scatter: 0.8 };
            let hearing = hearing(losses, None);
            let site = Site::of(&link, &hearing, predicted, spread);
            let (mut sums, mut all, mut lost) = (MarginMoments::default(), 0.0, 0.0);
            for step in -8000..8000 {
                let above = 0.001 * f64::from(step) * spread;
                let weight = density(above / spread);
                let silence =
                    losses.arrivals().log_likelihoods(0, sent, &[below((predicted + above).clamp(-8.0, 20.0))])[0]
                        .exp();
                sums.take(weight * (outage + (1.0 - outage) * silence), above);
                all += weight;
                lost += weight * silence;
            }
            let exact = sums.site(predicted, spread);
            let precision = 1.0 / (spread * spread);
            let mean = |site: Site| {
                let own = 1.0 / (site.variance - LEAST_SPREAD * LEAST_SPREAD);
                ((own * site.margin + precision * predicted) / (own + precision), own)
            };
            let ((found, own), (expected, exact)) = (mean(site), mean(exact));
            assert!((found - expected).abs() < 2e-3 * spread, "{found} instead of {expected}");
            assert!((own - exact).abs() < 5e-3 * precision, "{own} instead of {exact}");
            let silence = silence_of_living(&link, &hearing, predicted, spread);
            assert!((silence - lost / all).abs() < 1e-3, "{silence} instead of {}", lost / all);
        }
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
