//! What is open of the place of a node that was heard.

use std::sync::LazyLock;

use nalgebra::Matrix3;
use sextant_channel::Position;
use sextant_kernel::NodeId;

use super::law::StopLaw;
use super::told::told;
use crate::numerics::normal::quantile;
use crate::posterior::{POINTS, points};

/// Points along an axis of the ellipsoid of a node, in the plane and in space.
const PLANAR: usize = 8;
const SPATIAL: usize = 5;
/// Variances below this are none (m²).
const FLAT_M2: f64 = 1e-12;
/// A stop hears nothing of a node whose mean is farther away than its reach and so many standard deviations.
const FAR: f64 = 3.0;

/// What is open of the place of a node.
#[derive(Clone, Debug)]
pub(super) struct NodeOutlook {
    node: NodeId,
    mean: Position,
    /// The covariance that is left (m²).
    left: Matrix3<f64>,
    /// The covariance of the mean after the stops that were taken (m²).
    moved: Matrix3<f64>,
    /// Points about the mean that stand for `left`.
    about_mean: Vec<(Position, f64)>,
    /// Points that stand for `moved`.
    means: Vec<(Position, f64)>,
}

impl NodeOutlook {
    pub(super) fn new(node: NodeId, mean: Position, covariance: [[f64; 3]; 3]) -> Self {
        let left = Matrix3::from_fn(|row, column| covariance[row][column]);
        Self { node, mean, left, moved: Matrix3::zeros(), about_mean: about_mean(&left), means: vec![(mean, 1.0)] }
    }

    pub(super) fn node(&self) -> NodeId {
        self.node
    }

    /// The root mean square of the error (m).
    pub(super) fn error_m(&self) -> f64 {
        self.left.trace().max(0.0).sqrt()
    }

    /// The same after the covariance has fallen (m).
    pub(super) fn error_after_m(&self, fall: &Matrix3<f64>) -> f64 {
        (self.left.trace() - fall.trace()).max(0.0).sqrt()
    }

    /// How much the covariance is expected to fall by a stop at `place` (m²); `None` if the node is out of its reach.
    pub(super) fn fall(&self, law: &StopLaw, place: Position) -> Option<Matrix3<f64>> {
        let spread_m = (self.left.trace() + self.moved.trace()).max(0.0).sqrt();
        if self.mean.distance_m(place) > law.reach_m() + FAR * spread_m {
            return None;
        }
        let mut fall = Matrix3::zeros();
        let mut is_heard = false;
        for &(mean, weight) in &self.means {
            let places: Vec<(Position, f64)> =
                self.about_mean.iter().map(|&(off, weight)| (mean + off, weight)).collect();
            if let Some(told) = told(law, &places, place) {
                fall += told.fall * weight;
                is_heard = true;
            }
        }
        is_heard.then_some(fall)
    }

    /// The covariance falls by so much.
    pub(super) fn take(&mut self, fall: &Matrix3<f64>) {
        self.left -= fall;
        self.moved += fall;
        self.about_mean = about_mean(&self.left);
        self.means = points(self.mean, &rows(&self.moved), &POINTS);
    }
}

/// Points about the mean that stand for a covariance.
fn about_mean(covariance: &Matrix3<f64>) -> Vec<(Position, f64)> {
    let rule: &[(f64, f64)] = if covariance[(2, 2)] > FLAT_M2 { &SPATIAL_RULE } else { &PLANAR_RULE };
    points(Position::ORIGIN, &rows(covariance), rule)
}

fn rows(matrix: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [0, 1, 2].map(|row| [0, 1, 2].map(|column| matrix[(row, column)]))
}

static PLANAR_RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| rule(PLANAR));
static SPATIAL_RULE: LazyLock<Vec<(f64, f64)>> = LazyLock::new(|| rule(SPATIAL));

/// The middles of so many equal parts of the normal law, spread so that their variance is 1, and their weights.
fn rule(count: usize) -> Vec<(f64, f64)> {
    let places: Vec<f64> = (0..count).map(|part| quantile((part as f64 + 0.5) / count as f64)).collect();
    let deviation = (places.iter().map(|place| place * place).sum::<f64>() / count as f64).sqrt();
    places.into_iter().map(|place| (place / deviation, 1.0 / count as f64)).collect()
}
