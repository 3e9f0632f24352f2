//! What a posterior says of the area in which its node was searched for: whether it leaves most of the area, and whether
//! the end of the area cuts it off. All estimators judge by this file.

use sextant_kernel::maths::exp;

use crate::posterior::concern::Concern;

/// The 95 % region holds places whose log-density is at most this much below the highest: half the quantile of the
/// chi-squared law with two degrees of freedom.
pub(crate) const LIKELY: f64 = 3.0;
/// A posterior that leaves at least this share of the area is no evidence.
const LEFT: f64 = 0.8;

/// How much of the area in which a node was searched for its posterior leaves, gathered place by place.
///
/// The share is `exp(−D)` with D the divergence of the posterior from what was assumed before anything was heard
/// (Kullback and Leibler 1951): 1 if the two are the same, 1/2 if the node is equally likely in half of the area.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Verdict {
    /// Highest logarithm of a density, not normalised.
    highest: f64,
    /// Sum of the densities before anything was heard.
    before: f64,
    /// Sum of the densities after, and of their products with the log-likelihoods, relative to the highest.
    after: f64,
    log_likelihood: f64,
}

impl Default for Verdict {
    fn default() -> Self {
        Self { highest: f64::NEG_INFINITY, before: 0.0, after: 0.0, log_likelihood: 0.0 }
    }
}

impl Verdict {
    /// Takes the log-likelihood of a place. All places stand for cells of one size, and are equally likely before anything
    /// was heard.
    pub(crate) fn take(&mut self, log_likelihood: f64) {
        self.take_dense(0.0, log_likelihood);
    }

    /// The same for a place that has the logarithm of a density before anything was heard.
    pub(crate) fn take_dense(&mut self, log_density: f64, log_likelihood: f64) {
        self.before += exp(log_density);
        let value = log_density + log_likelihood;
        if value == f64::NEG_INFINITY {
            return;
        }
        if value > self.highest {
            let fade = exp(self.highest - value);
            self.after *= fade;
            self.log_likelihood *= fade;
            self.highest = value;
        }
        let weight = exp(value - self.highest);
        self.after += weight;
        self.log_likelihood += weight * log_likelihood;
    }

    /// Highest logarithm of a density.
    pub(crate) fn highest(&self) -> f64 {
        self.highest
    }

    /// Counts places of the area that were not looked at, because they are not likely: there are `places` in all.
    pub(crate) fn among(self, places: f64) -> Self {
        Self { before: self.before.max(places), ..self }
    }

    /// The share of the area that the posterior leaves.
    fn left(&self) -> f64 {
        let log_evidence = libm::log(self.after) + self.highest - libm::log(self.before);
        exp(log_evidence - self.log_likelihood / self.after)
    }

    /// The concern about a posterior whose highest logarithm of a density, at those ends of the area that are guessed, is
    /// `edge_below` less than the highest of all; infinite where no end is near.
    pub(crate) fn concern(&self, edge_below: f64) -> Option<Concern> {
        if self.after <= 0.0 {
            None
        } else if self.left() >= LEFT {
            Some(Concern::NoEvidence)
        } else {
            (edge_below <= LIKELY).then_some(Concern::AtEdge)
        }
    }
}

/// What is known of the fit of the model under which the nodes of a log are placed.
#[derive(Clone, Copy, Debug)]
pub(crate) struct FitState {
    /// Whether the log tells how far nodes are heard.
    pub(crate) is_reach_known: bool,
    /// Whether more rounds would change nothing.
    pub(crate) is_settled: bool,
}

impl FitState {
    /// The concern about a node of the fit whose posterior has `concern`.
    pub(crate) fn concern(self, concern: Option<Concern>) -> Option<Concern> {
        match concern {
            _ if !self.is_reach_known => Some(Concern::NoEvidence),
            None if !self.is_settled => Some(Concern::Unsettled),
            concern => concern,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The verdict on 21 by 21 places a metre apart, and the highest log-likelihood at their ends.
    fn concern(log_likelihood: impl Fn(f64, f64) -> f64) -> Option<Concern> {
        let (mut verdict, mut edge) = (Verdict::default(), f64::NEG_INFINITY);
        for (i, j) in (-10..=10).flat_map(|j: i32| (-10..=10).map(move |i: i32| (i, j))) {
            let value = log_likelihood(f64::from(i), f64::from(j));
            verdict.take(value);
            if i.abs().max(j.abs()) == 10 {
                edge = edge.max(value);
            }
        }
        verdict.concern(verdict.highest() - edge)
    }

    #[test]
    fn equal_likelihoods_everywhere_are_no_evidence() {
        assert_eq!(concern(|_, _| -7.0), Some(Concern::NoEvidence));
        assert_eq!(concern(|x, _| 0.01 * x), Some(Concern::NoEvidence));
        assert_eq!(concern(|x, _| x), Some(Concern::AtEdge));
    }

    #[test]
    fn a_ring_and_two_places_far_apart_are_evidence_although_they_spread_as_far_as_the_area() {
        assert_eq!(concern(|x, y| -0.5 * (x.hypot(y) - 7.5).powi(2) / 0.04), None);
        assert_eq!(concern(|x, y| -0.5 * ((x.abs() - 6.0).powi(2) + (x * y.signum() - y).powi(2))), None);
    }

    #[test]
    fn the_share_that_is_left_is_that_of_the_places_that_are_possible() {
        for (possible, expected) in [(100, 1.0), (80, 0.8), (50, 0.5), (1, 0.01)] {
            let mut verdict = Verdict::default();
            (0..100).for_each(|i| verdict.take(if i < possible { -1e4 } else { f64::NEG_INFINITY }));
            assert!((verdict.left() - expected).abs() < 1e-9, "{possible}: {}", verdict.left());
            let seen = (0..possible).fold(Verdict::default(), |mut seen, _| {
                seen.take(3.0);
                seen
            });
            assert!((seen.among(100.0).left() - expected).abs() < 1e-12, "{possible}");
        }
    }

    #[test]
    fn a_posterior_that_repeats_what_was_assumed_is_no_evidence_whatever_was_assumed() {
        let mut verdict = Verdict::default();
        (0..100).for_each(|i| verdict.take_dense(-0.3 * f64::from(i), -5.0));
        assert!((verdict.left() - 1.0).abs() < 1e-12);
        assert_eq!(verdict.concern(f64::INFINITY), Some(Concern::NoEvidence));
    }

    #[test]
    fn a_fit_without_a_known_reach_is_no_evidence_and_one_that_did_not_settle_is_named_last() {
        let state = |is_reach_known, is_settled| FitState { is_reach_known, is_settled };
        assert_eq!(state(false, true).concern(None), Some(Concern::NoEvidence));
        assert_eq!(state(true, false).concern(None), Some(Concern::Unsettled));
        assert_eq!(state(true, false).concern(Some(Concern::AtEdge)), Some(Concern::AtEdge));
        assert_eq!(state(true, true).concern(None), None);
    }
}
