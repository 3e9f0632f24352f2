//! The height of a tag: one for all times, or one that wanders.

use nalgebra::{DVector, Vector4};
use sextant_channel::Position;

use crate::joint_path::chain::{ChainSystem, Factor};

/// A height that wanders has knots at least this far apart (s), and at most so many.
const KNOT_S: f64 = 1.0;
const MOST_KNOTS: f64 = 1000.0;
/// How far a height that wanders is usually from its middle (m), and for how long it is remembered (s).
pub(super) const WANDERS: [(f64, f64); 2] = [(1.0, 10.0), (1.0, 60.0)];
/// Receivers whose heights differ by less tell no height (m).
const LEVEL_M: f64 = 1e-3;
/// A tag is seldom farther below or above all receivers (m).
const FAR_M: f64 = 3.0;
/// A height that is given, or taken from receivers on one level, is known to this (m).
const GIVEN_M: f64 = 1e-4;

/// Where the heights of a tag that climbs are: between two knots, linear in time.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Knots {
    /// For each epoch the knot before it, and the share of the way to the next one.
    at: Vec<(usize, f64)>,
    /// The epoch of each knot.
    epochs: Vec<usize>,
    /// Times between knots (s).
    spans_s: Vec<f64>,
}

impl Knots {
    /// The knots of epochs at these times (s).
    pub(super) fn of(times_s: &[f64]) -> Self {
        let (Some(&first_s), Some(&last_s)) = (times_s.first(), times_s.last()) else { return Self::default() };
        let apart_s = KNOT_S.max((last_s - first_s) / MOST_KNOTS);
        let mut epochs = vec![0];
        for (epoch, &time_s) in times_s.iter().enumerate() {
            if time_s - times_s[epochs[epochs.len() - 1]] >= apart_s || (epoch > 0 && epoch + 1 == times_s.len()) {
                epochs.push(epoch);
            }
        }
        let spans_s: Vec<f64> =
            epochs.windows(2).map(|pair| (times_s[pair[1]] - times_s[pair[0]]).max(1e-3)).collect();
        let share = |(epoch, &time_s): (usize, &f64)| {
            let after = epochs.partition_point(|&knot| knot <= epoch).clamp(1, epochs.len().max(2) - 1);
            let before_s = times_s[epochs[after - 1]];
            (after - 1, spans_s.get(after - 1).map_or(0.0, |span_s| (time_s - before_s) / span_s))
        };
        let at = times_s.iter().enumerate().map(share).collect();
        Self { at, epochs, spans_s }
    }

    pub(super) fn count(&self) -> usize {
        self.epochs.len()
    }
}

/// The prior of the height.
#[derive(Clone, Copy, Debug)]
pub(super) enum Heights<'a> {
    /// One for all times, in the last of the entries of the border that are the height.
    Constant,
    /// Ornstein and Uhlenbeck's process about that entry; those before it are the heights at the knots.
    Wandering { knots: &'a Knots, deviation_m: f64, memory_s: f64 },
}

impl Heights<'_> {
    /// How many knots it has.
    pub(super) fn knots(self) -> usize {
        match self {
            Self::Constant => 0,
            Self::Wandering { knots, .. } => knots.count(),
        }
    }

    /// The entries of the border that make the height at an epoch, with their weights; `middle` is that of the middle height, and
    /// entries of no weight may be among them.
    pub(super) fn entries(self, epoch: usize, middle: usize) -> [(usize, f64); 2] {
        match self {
            Self::Constant => [(middle, 1.0), (middle, 0.0)],
            Self::Wandering { knots, .. } => {
                let (knot, share) = knots.at[epoch];
                [(knot, 1.0 - share), ((knot + 1).min(knots.count() - 1), share)]
            }
        }
    }

    /// The residuals of the prior: the knots before and at it, how much of the former is remembered, and the variance (m²).
    fn steps(self) -> Vec<(Option<usize>, usize, f64, f64)> {
        let Self::Wandering { knots, deviation_m, memory_s } = self else { return Vec::new() };
        let variance = deviation_m * deviation_m;
        let step = |(knot, &span_s): (usize, &f64)| {
            let kept = libm::exp(-span_s / memory_s);
            (Some(knot), knot + 1, kept, variance * (1.0 - kept * kept))
        };
        std::iter::once((None, 0, 0.0, variance)).chain(knots.spans_s.iter().enumerate().map(step)).collect()
    }

    /// The logarithm of the prior, but for a constant.
    pub(super) fn value(self, border: &DVector<f64>, middle: usize) -> f64 {
        let residual = |(before, at, kept, variance): (Option<usize>, usize, f64, f64)| {
            let before_m = before.map_or(0.0, |before| border[before] - border[middle]);
            (border[at] - border[middle] - kept * before_m).powi(2) / variance
        };
        -0.5 * self.steps().into_iter().map(residual).sum::<f64>()
    }

    /// Adds the slope and the curvature of the prior.
    pub(super) fn add(self, system: &mut ChainSystem, border: &DVector<f64>, middle: usize) {
        let Self::Wandering { knots, .. } = self else { return };
        for (before, at, kept, variance) in self.steps() {
            let before_m = before.map_or(0.0, |before| border[before] - border[middle]);
            let residual = border[at] - border[middle] - kept * before_m;
            let rows =
                [(at, 1.0), (middle, kept - 1.0), (before.unwrap_or(at), if before.is_some() { -kept } else { 0.0 })];
            // The state at the knot before touches all of them.
            system.add(
                knots.epochs[at.saturating_sub(1)],
                Vector4::zeros(),
                None,
                &rows,
                1.0 / variance,
                -residual / variance,
            );
        }
    }

    /// What the widths of the prior add to the logarithm of the marginal likelihood.
    pub(super) fn log_widths(self) -> f64 {
        -0.5 * self.steps().into_iter().map(|(.., variance)| libm::log(variance)).sum::<f64>()
    }

    /// The variance of the height at each epoch (m²).
    pub(super) fn variances(self, factor: &Factor, epochs: usize, middle: usize) -> Vec<f64> {
        let of = |entry: usize| factor.covariance_of_border(entry, entry);
        match self {
            Self::Constant => vec![of(middle); epochs],
            Self::Wandering { knots, .. } => {
                let of_knots: Vec<f64> = (0..knots.count()).map(of).collect();
                let between = |epoch: usize| {
                    self.entries(epoch, middle).into_iter().map(|(knot, share)| share * of_knots[knot]).sum()
                };
                (0..epochs).map(between).collect()
            }
        }
    }
}

/// What is known of the height of the tag before its readings: its mean and standard deviation (m).
pub(super) fn prior_m(receivers: &[Position], given_m: Option<f64>) -> [f64; 2] {
    let [low, high] = levels_m(receivers);
    match given_m {
        Some(height_m) => [height_m, GIVEN_M],
        None => [0.5 * (low + high), if high - low > LEVEL_M { 1.0 } else { GIVEN_M }],
    }
}

/// Whether the receivers tell a height.
pub(super) fn tell_height(receivers: &[Position]) -> bool {
    let [low, high] = levels_m(receivers);
    high - low > LEVEL_M
}

/// Whether a height (m) is so far below or above all receivers that tags seldom are there.
pub(super) fn is_far(receivers: &[Position], height_m: f64) -> bool {
    let [low, high] = levels_m(receivers);
    height_m < low - FAR_M || height_m > high + FAR_M
}

/// The lowest and the highest of the receivers (m).
fn levels_m(receivers: &[Position]) -> [f64; 2] {
    let levels = receivers.iter().map(|receiver| receiver.z_m);
    [levels.clone().fold(f64::INFINITY, f64::min), levels.fold(f64::NEG_INFINITY, f64::max)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knots_are_at_epochs_a_second_apart_and_epochs_are_between_them() {
        let times_s = [0.0, 0.5, 1.2, 1.4, 9.0, 9.1];
        let knots = Knots::of(&times_s);
        assert_eq!(knots.epochs, [0, 2, 4, 5]);
        let heights = Heights::Wandering { knots: &knots, deviation_m: 1.0, memory_s: 10.0 };
        for (epoch, time_s) in times_s.into_iter().enumerate() {
            let found: f64 =
                heights.entries(epoch, 4).into_iter().map(|(knot, share)| share * times_s[knots.epochs[knot]]).sum();
            assert!((found - time_s).abs() < 1e-12, "{epoch}: {found}");
        }
        assert_eq!(Knots::of(&[3.0]).at, [(0, 0.0)]);
    }
}
