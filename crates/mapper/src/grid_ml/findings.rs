//! What a search finds on a node, and the estimate from it.

use sextant_channel::Position;

use crate::grid_ml::solver::{Moments, Peak, Sink};
use crate::lattice::Lattice;
use crate::posterior::{Cell, Estimate, EstimateKind, TieRule};

/// The vertices of highest likelihood, and the moments if the mean is wanted.
#[derive(Debug)]
pub(crate) struct Findings {
    pub(crate) peak: Peak,
    pub(crate) moments: Option<Moments>,
}

impl Findings {
    pub(crate) fn new(kind: EstimateKind, lattice: &Lattice) -> Self {
        let moments = match kind {
            EstimateKind::Argmax => None,
            EstimateKind::PosteriorMean => Some(Moments::new(lattice)),
        };
        Self { peak: Peak::default(), moments }
    }

    /// Takes the log-likelihood of a vertex.
    pub(crate) fn take(&mut self, index: u64, place: Position, value: f64) {
        self.peak.take(index, place, value);
        if let Some(moments) = &mut self.moments {
            moments.take(index, place, value);
        }
    }

    /// The estimate; `None` if no vertex was taken.
    pub(crate) fn estimate(&self, lattice: &Lattice, ties: TieRule, infeasible: bool) -> Option<Estimate> {
        let Self { peak, moments } = self;
        peak.vertices().first().map(|&(first, _)| Estimate {
            position: match moments {
                Some(moments) => moments.mean(),
                None => place(lattice, ties, peak, first),
            },
            log_likelihood: Some(peak.highest()),
            ties: u32::try_from(peak.vertices().len()).unwrap_or(u32::MAX),
            covariance: moments.as_ref().map(|moments| Cell::of(lattice).spread(moments.covariance())),
            infeasible,
            concern: None,
        })
    }
}

/// The place for several vertices of highest likelihood; `first` is the one with the lowest index.
fn place(lattice: &Lattice, ties: TieRule, peak: &Peak, first: u64) -> Position {
    let place = |index| lattice.position(lattice.vertex(index));
    let vertices = peak.vertices();
    if ties == TieRule::First || vertices.len() == 1 {
        return place(first);
    }
    let share = 1.0 / vertices.len() as f64;
    let offset = vertices.iter().fold(Position::ORIGIN, |sum, &(index, _)| sum + (place(index) - place(first)));
    let mean = place(first) + offset * share;
    let half_step_m = 0.5 * lattice.step_m() * (1.0 + 1e-9);
    let mut nearest = (first, f64::INFINITY);
    let mut is_one_of_them = false;
    for &(index, _) in vertices {
        let offset: [f64; 3] = (place(index) - mean).into();
        is_one_of_them |= offset.iter().all(|along| along.abs() <= half_step_m);
        let distance_m = place(index).distance_m(mean);
        if distance_m < nearest.1 - 1e-9 * lattice.step_m() {
            nearest = (index, distance_m);
        }
    }
    if is_one_of_them { mean } else { place(nearest.0) }
}
