//! Where one node is.

use sextant_channel::Position;

use super::cell::Cell;
use super::covariance::covariance;
use crate::posterior::concern::Concern;
use crate::posterior::estimate_kind::EstimateKind;

/// Where one node is.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The place (m).
    pub position: Position,
    /// Natural logarithm of the highest likelihood on the grid; `None` for an algorithm without a likelihood.
    pub log_likelihood: Option<f64>,
    /// Number of vertices with the highest likelihood (within 10⁻⁹ in its logarithm), 1 if there is only one. Always
    /// 1 for an algorithm without a common grid.
    pub ties: u32,
    /// Posterior covariance of x, y, z (m²): present for a posterior mean. It includes where in its cell of the grid a node may
    /// be. In a plane, the height has no variance.
    pub covariance: Option<[[f64; 3]; 3]>,
    /// Whether no vertex explains all receptions, so that some were treated as outliers.
    pub infeasible: bool,
    /// Why the place is not reliable, if there is a reason.
    pub concern: Option<Concern>,
}

impl Estimate {
    /// A place of which nothing else is known.
    #[must_use]
    pub fn of_place(position: Position) -> Self {
        Self { position, log_likelihood: None, ties: 1, covariance: None, infeasible: false, concern: None }
    }
}

/// The nodes of a Gauss-Hermite rule along an axis, in standard deviations, and their weights.
pub(crate) const POINTS: [(f64, f64); 3] =
    [(-1.732_050_807_568_877_2, 1.0 / 6.0), (0.0, 2.0 / 3.0), (1.732_050_807_568_877_2, 1.0 / 6.0)];

/// Points that stand for a Gaussian with this mean (m) and covariance (m²), with their weights: along each axis of its ellipsoid
/// those of `rule`, in standard deviations.
pub(crate) fn points(mean: Position, covariance: &[[f64; 3]; 3], rule: &[(f64, f64)]) -> Vec<(Position, f64)> {
    let flat = nalgebra::Matrix3::from_fn(|row, column| covariance[row][column]).symmetric_eigen();
    let axis = |k: usize| flat.eigenvectors.column(k) * flat.eigenvalues[k].max(0.0).sqrt();
    let mut points = vec![(mean, 1.0)];
    for axis in [axis(0), axis(1), axis(2)].iter().filter(|axis| axis.norm() > 1e-9) {
        let spread = |&(place, weight): &(Position, f64)| {
            let along = Position::new(axis[0], axis[1], axis[2]);
            rule.iter().map(move |&(deviations, share)| (place + along * deviations, weight * share))
        };
        points = points.iter().flat_map(spread).collect();
    }
    points
}

impl Estimate {
    /// Points that stand for the posterior, with their weights: the place alone without a covariance.
    pub(crate) fn points(&self) -> Vec<(Position, f64)> {
        points(self.position, &self.covariance.unwrap_or_default(), &POINTS)
    }

    /// The estimate from places with probabilities that sum to 1, which stand for cells, their mean (m), and the likeliest place
    /// with its log-likelihood. It has no concern.
    pub(crate) fn of_places(
        kind: EstimateKind,
        places: &[(Position, f64)],
        cell: Cell,
        mean: Position,
        likeliest: (Position, f64),
    ) -> Self {
        let (position, covariance) = match kind {
            EstimateKind::Argmax => (likeliest.0, None),
            EstimateKind::PosteriorMean => {
                let apart = places.iter().map(|&(place, probability)| (place - mean, probability));
                (mean, Some(cell.spread(covariance(apart))))
            }
        };
        let log_likelihood = Some(likeliest.1);
        Self { position, log_likelihood, ties: 1, covariance, infeasible: false, concern: None }
    }
}
