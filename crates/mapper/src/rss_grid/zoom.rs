//! The posterior of one node on grids that zoom in: from its whole box to the part of it where it is likely.

use sextant_channel::Position;

use super::evidence::HeardByStops;
use super::silent_field::{GridPart, SilentField};
use crate::log_facts::search_box::SearchBox;
use crate::posterior::{Cell, Concern, Estimate, EstimateKind, Verdict};

/// Steps along each axis of the last grids at most, in the plane and in space.
const FINE: [u32; 2] = [48, 16];
/// The same for the first one, and for all while the channel is estimated.
const COARSE: [u32; 2] = [24, 10];
/// The next grid holds the vertices whose log-likelihood is at most this much below the highest.
const KEPT: f64 = 12.0;
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
    /// The posterior of a node in its box, on grids of `field` down to the finest that its posterior needs.
    pub(super) fn of(
        links: &HeardByStops,
        field: &SilentField<'_>,
        within: &SearchBox,
        detail: PosteriorDetail,
    ) -> Self {
        let space = usize::from(!within.is_level());
        let most = if detail == PosteriorDetail::Fine { FINE[space] } else { COARSE[space] };
        let mut part = field.part(within, COARSE[space], None);
        let mut found = places(links, field, &part);
        let concern = of_box(&found, within, part.steps_m());
        let mut vertices = found.len() as u64;
        loop {
            let best = likeliest(&found, within);
            // The cells of the places that are likely enough.
            let steps_m = part.steps_m();
            let mut kept = SearchBox { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3], ..*within };
            for (place, _) in found.iter().filter(|(_, value)| *value >= best.1 - KEPT) {
                for (axis, along) in <[f64; 3]>::from(*place).into_iter().enumerate() {
                    kept.low[axis] = kept.low[axis].min(along - steps_m[axis]).max(within.low[axis]);
                    kept.high[axis] = kept.high[axis].max(along + steps_m[axis]).min(within.high[axis]);
                }
            }
            let next = field.part(&kept, most, Some(&part));
            if next.is_as_fine_as(&part) {
                return Self { concern, vertices, ..Self::on(&found, best, Cell::new(steps_m)) };
            }
            found = places(links, field, &next);
            vertices += found.len() as u64;
            part = next;
        }
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

/// The places of a part of the grid, with their log-likelihoods.
fn places(links: &HeardByStops, field: &SilentField<'_>, part: &GridPart) -> Vec<(Position, f64)> {
    let mut found = Vec::with_capacity(part.len());
    field.each(part, |place, ln_silence| {
        found.push((place, field.evidence.log_likelihood(links, place, ln_silence)));
    });
    found
}

/// The likeliest place and its log-likelihood; the middle of the box if no place is likely at all.
fn likeliest(found: &[(Position, f64)], within: &SearchBox) -> (Position, f64) {
    let middle = (within.nearest(within.middle()), f64::NEG_INFINITY);
    found.iter().fold(middle, |best, &found| if found.1 > best.1 { found } else { best })
}

/// What the grid over the whole box says of the posterior.
fn of_box(found: &[(Position, f64)], within: &SearchBox, steps: [f64; 3]) -> Option<Concern> {
    let mut verdict = Verdict::default();
    found.iter().for_each(|&(_, value)| verdict.take(value));
    let at_edge = found.iter().filter(|(place, _)| within.is_in_outer_cells(*place, steps));
    verdict.concern(verdict.highest() - at_edge.map(|&(_, value)| value).fold(f64::NEG_INFINITY, f64::max))
}
