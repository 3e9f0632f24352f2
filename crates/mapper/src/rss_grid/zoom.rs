//! The posterior of one node on grids that zoom in: from its whole box to the part of it where it is likely.

use sextant_channel::Position;

use super::evidence::{HeardByStops, StrengthEvidence};
use crate::log_facts::search_box::SearchBox;
use crate::posterior::{Cell, Concern, Estimate, EstimateKind, Verdict};

/// Vertices along each axis, in the plane and in space.
const FINE: [u32; 2] = [48, 16];
/// The same while the channel is estimated.
const COARSE: [u32; 2] = [24, 10];
/// The next grid holds the vertices whose log-likelihood is at most this much below the highest.
const KEPT: f64 = 12.0;
/// Most grids for a node.
const MOST_GRIDS: usize = 12;
/// Places with a lower probability do not count.
const SLIGHT: f64 = 1e-4;

/// How finely a posterior is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PosteriorDetail {
    Coarse,
    Fine,
}

/// Places with their probabilities, which sum to 1.
#[derive(Clone, Debug)]
pub(super) struct WeighedPlaces {
    pub(super) places: Vec<(Position, f64)>,
    pub(super) mean: Position,
    /// The likeliest place, and its log-likelihood.
    best: (Position, f64),
    concern: Option<Concern>,
    cell: Cell,
    pub(super) vertices: u64,
}

impl WeighedPlaces {
    /// The posterior of a node in its box, on grids whose last step is about `step_m`.
    pub(super) fn of(
        links: &HeardByStops,
        evidence: &StrengthEvidence,
        within: &SearchBox,
        step_m: f64,
        detail: PosteriorDetail,
    ) -> Self {
        let counts = match detail {
            PosteriorDetail::Coarse => COARSE,
            PosteriorDetail::Fine => FINE,
        }[usize::from(!within.is_level())];
        let (mut low, mut high) = (within.low, within.high);
        let (mut concern, mut vertices) = (None, 0);
        for grid in 0.. {
            let steps = [0, 1, 2].map(|axis| (high[axis] - low[axis]) / f64::from(counts));
            let mut found: Vec<(Position, f64)> = Vec::new();
            let near = evidence.near(links, low, high);
            each(low, steps, counts, |place| found.push((place, evidence.log_likelihood(&near, place))));
            vertices += found.len() as u64;
            let best =
                found.iter().fold((within.nearest(within.middle()), f64::NEG_INFINITY), |best, &(place, value)| {
                    if value > best.1 { (place, value) } else { best }
                });
            if grid == 0 {
                concern = of_box(&found, within, steps);
            }
            let is_last = steps.iter().all(|&step| step <= step_m) || grid + 1 == MOST_GRIDS;
            let before = [low, high];
            if !is_last {
                (low, high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
                for (place, _) in found.iter().filter(|(_, value)| *value >= best.1 - KEPT) {
                    for (axis, along) in <[f64; 3]>::from(*place).into_iter().enumerate() {
                        low[axis] = low[axis].min(along - steps[axis]).max(before[0][axis]);
                        high[axis] = high[axis].max(along + steps[axis]).min(before[1][axis]);
                    }
                }
                let shrinks = (0..3).any(|axis| high[axis] - low[axis] < 0.8 * (before[1][axis] - before[0][axis]));
                if shrinks {
                    continue;
                }
            }
            return Self { concern, vertices, ..Self::on(&found, best, Cell::new(steps)) };
        }
        unreachable!("the last grid returns")
    }

    /// The posterior of places that stand for such cells.
    fn on(found: &[(Position, f64)], best: (Position, f64), cell: Cell) -> Self {
        let total: f64 = found.iter().map(|(_, value)| libm::exp(value - best.1)).sum();
        let mut places: Vec<(Position, f64)> = found
            .iter()
            .map(|&(place, value)| (place, libm::exp(value - best.1) / total))
            .filter(|&(_, probability)| probability > SLIGHT)
            .collect();
        if places.is_empty() {
            places.push((best.0, 1.0));
        }
        let kept: f64 = places.iter().map(|&(_, probability)| probability).sum();
        places.iter_mut().for_each(|(_, probability)| *probability /= kept);
        let offset = |sum: Position, &(place, probability): &(Position, f64)| sum + (place - best.0) * probability;
        let mean = best.0 + places.iter().fold(Position::ORIGIN, offset);
        Self { places, mean, best, concern: None, cell, vertices: 0 }
    }

    /// The estimate.
    pub(super) fn estimate(&self, kind: EstimateKind) -> Estimate {
        let estimate = Estimate::of_places(kind, &self.places, self.cell, self.mean, self.best);
        Estimate { concern: self.concern, ..estimate }
    }
}

/// Calls `visit` with the middle of each cell of a grid with its first corner at `low`.
fn each(low: [f64; 3], steps: [f64; 3], count: u32, mut visit: impl FnMut(Position)) {
    let along = |axis: usize, i: u32| low[axis] + (f64::from(i) + 0.5) * steps[axis];
    let count = |axis: usize| if steps[axis] > 0.0 { count } else { 1 };
    for k in 0..count(2) {
        for j in 0..count(1) {
            for i in 0..count(0) {
                visit(Position::new(along(0, i), along(1, j), along(2, k)));
            }
        }
    }
}

/// What the grid over the whole box says of the posterior.
fn of_box(found: &[(Position, f64)], within: &SearchBox, steps: [f64; 3]) -> Option<Concern> {
    let mut verdict = Verdict::default();
    found.iter().for_each(|&(_, value)| verdict.take(value));
    let widest_m = steps.into_iter().fold(0.0, f64::max);
    let at_edge = found.iter().filter(|(place, _)| within.is_at_edge(*place, 0.6 * widest_m));
    verdict.concern(verdict.highest() - at_edge.map(|&(_, value)| value).fold(f64::NEG_INFINITY, f64::max))
}
