//! Places from distances.

use std::convert::Infallible;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use sextant_channel::Position;

use super::{DAMPING, LaterationError, STEPS};
use crate::numerics::least_squares::{LeastSquares, minimum};

/// Smallest ratio of singular values at which anchors still span plane or space.
const FLATNESS: f64 = 1e-9;

/// A distance to a known place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Range {
    /// The known place (m).
    pub anchor: Position,
    /// The distance to it (m).
    pub distance_m: f64,
    /// Weight of its squared residual, above zero: the inverse of the variance of the distance, up to a factor.
    pub weight: f64,
}

impl Range {
    /// A distance of weight 1.
    #[must_use]
    pub fn new(anchor: Position, distance_m: f64) -> Self {
        Self { anchor, distance_m, weight: 1.0 }
    }
}

/// The place in two or three `dimensions` that fits the distances by linear least squares: the equations
/// `|x − a_i|² = d_i²` minus the last one, `X = (PᵀP)⁻¹ PᵀQ` (Gunathillake 2018, appendix A). Weights are not used.
/// In two dimensions the height is that of the first anchor, and distances are those in the plane.
///
/// # Errors
/// If there are fewer than `dimensions + 1` anchors, they lie on one line (in one plane), or a number is not finite.
pub fn multilaterate_linear(ranges: &[Range], dimensions: usize) -> Result<Position, LaterationError> {
    let Some((last, others)) = ranges.split_last().filter(|(_, others)| others.len() >= dimensions) else {
        return Err(LaterationError::TooFew { found: ranges.len(), dimensions });
    };
    if !ranges.iter().all(|range| range.anchor.is_finite() && range.distance_m.is_finite()) {
        return Err(LaterationError::NotFinite);
    }
    // Coordinates relative to the last anchor: its equation then has no constant.
    let relative = |range: &Range| <[f64; 3]>::from(range.anchor - last.anchor);
    let root = |row: usize| others[row].weight.sqrt();
    let p =
        DMatrix::from_fn(others.len(), dimensions, |row, column| root(row) * (2.0 * relative(&others[row])[column]));
    let q = DVector::from_fn(others.len(), |row, _| {
        let square: f64 = relative(&others[row])[..dimensions].iter().map(|x| x * x).sum();
        root(row) * (square + last.distance_m.powi(2) - others[row].distance_m.powi(2))
    });
    let svd = p.svd(true, true);
    if svd.singular_values.min() <= FLATNESS * svd.singular_values.max() {
        return Err(LaterationError::Degenerate);
    }
    let x = svd.solve(&q, 0.0).map_err(|_| LaterationError::Degenerate)?;
    let z_m = if dimensions == 3 { last.anchor.z_m + x[2] } else { ranges[0].anchor.z_m };
    Ok(Position::new(last.anchor.x_m + x[0], last.anchor.y_m + x[1], z_m))
}

/// The place whose distances fit best: the minimum of `Σ w (|x − a| − d)²` near the linear solution, or near the
/// centroid of the anchors if there is no linear solution.
///
/// # Errors
/// As [`multilaterate_linear`], but anchors on one line are accepted; the result is then one of the two mirror
/// images.
pub fn multilaterate(ranges: &[Range], dimensions: usize) -> Result<Position, LaterationError> {
    let start = match multilaterate_linear(ranges, dimensions) {
        Ok(place) => place,
        Err(LaterationError::Degenerate) => beside_centroid(ranges, dimensions),
        Err(error) => return Err(error),
    };
    Ok(refine(start, ranges, dimensions))
}

/// A place beside the weighted centroid of the anchors. If all anchors are on one line, the slope across the line is
/// zero on it, and a search could not leave the line.
fn beside_centroid(ranges: &[Range], dimensions: usize) -> Position {
    let weights: f64 = ranges.iter().map(|range| range.weight).sum();
    let mean = ranges.iter().fold(Position::ORIGIN, |sum, range| sum + range.anchor * (range.weight / weights));
    let shortest_m = ranges.iter().map(|range| range.distance_m).fold(f64::INFINITY, f64::min);
    let step_m = 0.1 * shortest_m.abs().max(1e-3);
    mean + Position::new(0.618 * step_m, 0.786 * step_m, if dimensions == 3 { 0.486 * step_m } else { 0.0 })
}

/// The minimum of `Σ w (|x − a| − d)²` near `start`, by Levenberg and Marquardt's method. In two dimensions the
/// height stays that of `start` and distances are those in the plane.
#[must_use]
pub fn refine(start: Position, ranges: &[Range], dimensions: usize) -> Position {
    let Ok(place) = minimum(&Ranges { ranges, dimensions }, start, DAMPING, STEPS);
    place
}

/// The distances that the place should have.
struct Ranges<'a> {
    ranges: &'a [Range],
    dimensions: usize,
}

impl Ranges<'_> {
    fn apart(&self, place: Position, range: &Range) -> Vector3<f64> {
        let apart = place - range.anchor;
        Vector3::new(apart.x_m, apart.y_m, if self.dimensions == 3 { apart.z_m } else { 0.0 })
    }
}

impl LeastSquares for Ranges<'_> {
    type Point = Position;
    type Step = Vector3<f64>;
    type Error = Infallible;

    fn cost(&self, at: &Position) -> f64 {
        let square = |range: &Range| range.weight * (self.apart(*at, range).norm() - range.distance_m).powi(2);
        self.ranges.iter().map(square).sum()
    }

    fn step(&self, at: &Position, damping: f64) -> Result<Option<Vector3<f64>>, Infallible> {
        let mut normal = Matrix3::zeros();
        let mut gradient = Vector3::zeros();
        for range in self.ranges {
            let apart = self.apart(*at, range);
            let distance_m = apart.norm();
            if distance_m > 0.0 {
                let direction = apart / distance_m;
                normal += direction * direction.transpose() * range.weight;
                gradient += direction * (range.weight * (distance_m - range.distance_m));
            }
        }
        let scale = normal.trace().max(f64::MIN_POSITIVE);
        let damped = normal + Matrix3::identity() * (damping * scale);
        Ok(damped.cholesky().map(|cholesky| cholesky.solve(&gradient)))
    }

    fn moved(&self, at: &Position, step: &Vector3<f64>) -> Position {
        *at - Position::new(step.x, step.y, step.z)
    }

    fn is_last(&self, at: &Position, step: &Vector3<f64>, is_lower: bool) -> bool {
        is_lower && step.norm() <= 1e-13 * (1.0 + Vector3::from(<[f64; 3]>::from(*at)).norm())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    fn place(seed: u64, i: u64, height: f64) -> Position {
        let draw = |axis| 20.0 * Seed(seed).uniform(Purpose::new(8), [i, axis, 0]) - 10.0;
        Position::new(draw(0), draw(1), height * draw(2))
    }

    fn ranges(seed: u64, count: u64, height: f64, node: Position) -> Vec<Range> {
        let anchors = (1..=count).map(|i| place(seed, i, height));
        anchors.map(|anchor| Range::new(anchor, anchor.distance_m(node))).collect()
    }

    #[test]
    fn exact_distances_give_the_exact_place() {
        for seed in 0..100 {
            for (dimensions, height) in [(2, 0.0), (3, 1.0)] {
                let node = place(seed, 0, height);
                for count in [dimensions as u64 + 1, 9] {
                    let ranges = ranges(seed, count, height, node);
                    let linear = multilaterate_linear(&ranges, dimensions).unwrap();
                    assert!(linear.distance_m(node) < 1e-7, "{linear} not {node}, seed {seed}");
                    let refined = multilaterate(&ranges, dimensions).unwrap();
                    assert!(refined.distance_m(node) < 1e-7, "{refined} not {node}, seed {seed}");
                }
            }
        }
        let anchors = [Position::ORIGIN, Position::new(4.0, 0.0, 0.0), Position::new(0.0, 3.0, 0.0)];
        let middle = multilaterate_linear(&anchors.map(|anchor| Range::new(anchor, 2.5)), 2).unwrap();
        assert!(middle.distance_m(Position::new(2.0, 1.5, 0.0)) < 1e-12);
    }

    #[test]
    fn the_refined_place_is_a_minimum_that_the_linear_one_is_not() {
        let node = place(3, 0, 1.0);
        let mut ranges = ranges(3, 8, 1.0, node);
        for (i, range) in (0..).zip(&mut ranges) {
            range.distance_m *= 1.0 + 0.1 * Seed(3).normal(Purpose::new(8), [i, 9, 0]);
            range.weight = 1.0 / range.distance_m.powi(2);
        }
        let cost = |place: Position| -> f64 {
            ranges.iter().map(|r| r.weight * (place.distance_m(r.anchor) - r.distance_m).powi(2)).sum()
        };
        let best = multilaterate(&ranges, 3).unwrap();
        assert!(cost(best) < cost(multilaterate_linear(&ranges, 3).unwrap()));
        for (x, y, z) in [(1e-4, 0.0, 0.0), (0.0, 1e-4, 0.0), (0.0, 0.0, 1e-4)] {
            let step = Position::new(x, y, z);
            assert!(cost(best) < cost(best + step) && cost(best) < cost(best - step));
        }
    }

    #[test]
    fn anchors_on_a_line_leave_a_mirror_image() {
        let node = Position::new(1.0, 2.0, 0.0);
        let anchors = [0.0, 1.0, 5.0].map(|x| Position::new(x, 0.0, 0.0));
        let ranges = anchors.map(|anchor| Range::new(anchor, anchor.distance_m(node)));
        assert_eq!(multilaterate_linear(&ranges, 2), Err(LaterationError::Degenerate));
        let found = multilaterate(&ranges, 2).unwrap();
        assert!((found.x_m - 1.0).abs() < 1e-7 && (found.y_m.abs() - 2.0).abs() < 1e-7, "{found}");
    }

    #[test]
    fn too_few_anchors_and_invalid_numbers_are_rejected() {
        let two = [Range::new(Position::ORIGIN, 1.0), Range::new(Position::new(1.0, 0.0, 0.0), 1.0)];
        assert_eq!(multilaterate(&two, 2), Err(LaterationError::TooFew { found: 2, dimensions: 2 }));
        assert_eq!(multilaterate(&[], 3), Err(LaterationError::TooFew { found: 0, dimensions: 3 }));
        let anchors = [Position::ORIGIN, Position::new(1.0, 0.0, 0.0), Position::new(0.0, 1.0, 0.0)];
        let unknown = [1.0, f64::NAN, 1.0];
        let ranges: Vec<_> = anchors.into_iter().zip(unknown).map(|(at, range_m)| Range::new(at, range_m)).collect();
        assert_eq!(multilaterate_linear(&ranges, 2), Err(LaterationError::NotFinite));
    }
}
