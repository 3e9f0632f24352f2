//! A search on a grid that keeps within a box, and notices whether the box cuts the posterior off.

use sextant_channel::Position;

use crate::grid_ml::solver::Sink;
use crate::lattice::Lattice;
use crate::log_facts::search_box::SearchBox;
use crate::posterior::{Concern, LIKELY, Verdict};

/// Passes on the vertices in a box, of which it wants to see all likely ones.
#[derive(Debug)]
pub(crate) struct BoundedSink<'a, S> {
    pub(crate) inner: S,
    within: &'a SearchBox,
    lattice: &'a Lattice,
    /// The highest log-likelihood of the vertices at a guessed end of the box.
    highest_at_edge: f64,
    verdict: Verdict,
}

impl<'a, S: Sink> BoundedSink<'a, S> {
    /// How far below the highest log-likelihood vertices are wanted.
    pub(crate) const MARGIN: f64 = LIKELY;

    /// The sink for vertices of `lattice`.
    pub(crate) fn new(inner: S, within: &'a SearchBox, lattice: &'a Lattice) -> Self {
        Self { inner, within, lattice, highest_at_edge: f64::NEG_INFINITY, verdict: Verdict::default() }
    }

    /// What the box says of the posterior.
    pub(crate) fn concern(&self) -> Option<Concern> {
        let count = |axis: usize| self.lattice.span(axis, self.within.low[axis], self.within.high[axis]).0.len();
        let vertices: f64 = (0..3).map(|axis| count(axis) as f64).product();
        self.verdict.among(vertices).concern(self.verdict.highest() - self.highest_at_edge)
    }
}

impl<S: Sink> Sink for BoundedSink<'_, S> {
    const WANTS_FEW: bool = S::WANTS_FEW;

    fn take(&mut self, index: u64, place: Position, value: f64) {
        if !self.within.contains(place) {
            return;
        }
        self.verdict.take(value);
        if value > self.highest_at_edge && self.within.is_at_edge(place, self.lattice.step_m()) {
            self.highest_at_edge = value;
        }
        self.inner.take(index, place, value);
    }

    fn least(&self) -> f64 {
        self.inner.least().min(self.verdict.highest() - LIKELY)
    }
}

#[cfg(test)]
mod tests {
    use sextant_channel::Stop;
    use sextant_kernel::{RobotId, SimTime};

    use super::*;
    use crate::grid_ml::solver::Peak;

    fn stop([x_m, y_m]: [f64; 2]) -> Stop {
        Stop { robot: RobotId(0), time: SimTime::ZERO, position: Position::new(x_m, y_m, 0.0), heading_rad: None }
    }

    /// The concern about a posterior on a lattice of 21 by 21 vertices, in a box that holds `-reach_m` to `reach_m`.
    fn concern(reach_m: f64, log_likelihood: impl Fn(f64, f64) -> f64) -> (Option<Concern>, Option<u64>) {
        let within = SearchBox {
            low: [-reach_m, -reach_m, 0.0],
            high: [reach_m, reach_m, 0.0],
            is_guessed: [true, true, false],
        };
        let stops = [stop([-10.0; 2]), stop([10.0; 2])];
        let lattice = Lattice::covering(&stops, 1.0, 1.0, Some([0.0; 2]), 1 << 30).unwrap();
        let mut sink = BoundedSink::new(Peak::default(), &within, &lattice);
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
}
