//! A search on a grid that keeps within a box, and notices whether the box cuts the posterior off.

use sextant_channel::Position;

use crate::Concern;
use crate::grid_ml::solver::Sink;
use crate::log_facts::search_box::SearchBox;

/// The 95 % region holds places whose log-likelihood is at most this much below the highest: half the quantile of the
/// chi-squared law with two degrees of freedom.
const LIKELY: f64 = 3.0;
/// A posterior is flat if its variance along each axis is at least this share of that of the places searched.
const FLAT: f64 = 0.8;

/// Passes on the vertices in a box.
#[derive(Debug)]
pub(crate) struct BoundedSink<'a, S> {
    pub(crate) inner: S,
    within: &'a SearchBox,
    step_m: f64,
    /// The highest log-likelihood of all, and of the vertices at a guessed end of the box.
    highest: f64,
    highest_at_edge: f64,
    places: Spread,
    posterior: Spread,
}

/// Sums of weights, and of coordinates and their squares relative to the first place.
#[derive(Debug, Default)]
struct Spread {
    first: Option<Position>,
    weight: f64,
    sum: [f64; 3],
    squares: [f64; 3],
}

impl Spread {
    fn take(&mut self, place: Position, weight: f64) {
        let apart: [f64; 3] = (place - *self.first.get_or_insert(place)).into();
        self.weight += weight;
        for (axis, along) in apart.into_iter().enumerate() {
            self.sum[axis] += weight * along;
            self.squares[axis] += weight * along * along;
        }
    }

    fn fade(&mut self, factor: f64) {
        self.weight *= factor;
        self.sum = self.sum.map(|sum| sum * factor);
        self.squares = self.squares.map(|sum| sum * factor);
    }

    fn variance(&self, axis: usize) -> f64 {
        let mean = self.sum[axis] / self.weight;
        (self.squares[axis] / self.weight - mean * mean).max(0.0)
    }
}

impl<'a, S: Sink> BoundedSink<'a, S> {
    /// The sink for vertices `step_m` apart.
    pub(crate) fn new(inner: S, within: &'a SearchBox, step_m: f64) -> Self {
        Self {
            inner,
            within,
            step_m,
            highest: f64::NEG_INFINITY,
            highest_at_edge: f64::NEG_INFINITY,
            places: Spread::default(),
            posterior: Spread::default(),
        }
    }

    /// Whether any vertex was in the box.
    pub(crate) fn has_any(&self) -> bool {
        self.places.first.is_some()
    }

    /// What the box says of the posterior.
    pub(crate) fn concern(&self) -> Option<Concern> {
        if self.highest_at_edge < self.highest - LIKELY || !self.has_any() {
            return None;
        }
        let is_flat = (0..3).all(|axis| self.posterior.variance(axis) >= FLAT * self.places.variance(axis));
        Some(if is_flat { Concern::NoEvidence } else { Concern::AtEdge })
    }
}

impl<S: Sink> Sink for BoundedSink<'_, S> {
    const WANTS_FEW: bool = S::WANTS_FEW;

    fn take(&mut self, index: u64, place: Position, value: f64) {
        if !self.within.contains(place) {
            return;
        }
        if value > self.highest {
            self.posterior.fade(libm::exp(self.highest - value));
            self.highest = value;
        }
        self.places.take(place, 1.0);
        self.posterior.take(place, libm::exp(value - self.highest));
        if value > self.highest_at_edge && self.within.is_at_edge(place, self.step_m) {
            self.highest_at_edge = value;
        }
        self.inner.take(index, place, value);
    }

    fn least(&self) -> f64 {
        self.inner.least()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid_ml::solver::Peak;

    /// The concern about a posterior on a lattice of 21 by 21 vertices, in a box that holds `-reach_m` to `reach_m`.
    fn concern(reach_m: f64, log_likelihood: impl Fn(f64, f64) -> f64) -> (Option<Concern>, Option<u64>) {
        let within = SearchBox {
            low: [-reach_m, -reach_m, 0.0],
            high: [reach_m, reach_m, 0.0],
            is_guessed: [true, true, false],
        };
        let mut sink = BoundedSink::new(Peak::default(), &within, 1.0);
        for (index, (i, j)) in (0..).zip((-10..=10).flat_map(|j| (-10..=10).map(move |i| (i, j)))) {
            let (x_m, y_m) = (f64::from(i), f64::from(j));
            sink.take(index, Position::new(x_m, y_m, 0.0), log_likelihood(x_m, y_m));
        }
        (sink.concern(), sink.inner.vertices().first().map(|&(index, _)| index))
    }

    #[test]
    fn a_posterior_within_the_box_is_sound_and_one_that_the_box_cuts_off_is_at_the_edge() {
        let at = |x_m: f64| move |x: f64, y: f64| -0.5 * ((x - x_m).powi(2) + y * y);
        assert_eq!(concern(6.5, at(0.0)), (None, Some(220)));
        // Beyond the box the likelihood is higher, but no vertex beyond is taken: the best is 6 m east of the middle.
        assert_eq!(concern(6.5, at(9.0)), (Some(Concern::AtEdge), Some(226)));
    }

    #[test]
    fn equal_likelihoods_everywhere_are_no_evidence() {
        assert_eq!(concern(6.5, |_, _| -7.0).0, Some(Concern::NoEvidence));
        assert_eq!(concern(6.5, |x, _| 0.01 * x).0, Some(Concern::NoEvidence));
        assert_eq!(concern(6.5, |x, _| x).0, Some(Concern::AtEdge));
    }
}
