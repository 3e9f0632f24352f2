//! Places from distances that are all wrong by the same unknown length: their differences count.

use std::convert::Infallible;

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};
use sextant_channel::Position;

use super::{DAMPING, LaterationError, Range, STEPS};
use crate::numerics::least_squares::{LeastSquares, minimum};

/// Smallest ratio of singular values at which anchors still tell the place and the length.
const FLATNESS: f64 = 1e-9;

/// The place in two or three `dimensions` whose distances, all longer by one unknown length, fit best: the minimum of
/// `Σ w (|x − a| + b − d)²` over place and length b. Signals whose time of arrival is known, but not when they were sent, tell such
/// distances, and only their differences say anything. The search starts at the linear solution of the squared equations
/// minus the last one (Smith and Abel 1987). In two dimensions the height is that of the first anchor, and distances are
/// those in the plane.
///
/// # Errors
/// If there are fewer than `dimensions + 2` anchors, they lie on one line (in one plane), or a number is not finite.
pub fn locate_by_differences(ranges: &[Range], dimensions: usize) -> Result<Position, LaterationError> {
    let start = linear(ranges, dimensions)?;
    let Ok([x, y, z, _]) = minimum(&Differences { ranges, dimensions }, start, DAMPING, STEPS).map(Into::into);
    Ok(Position::new(x, y, z))
}

/// Whether differences of ranges tell how far `place` is. One that is twice as far from the middle of the anchors fits clearly worse
/// then; beside a straight way and far from all anchors, none does.
#[must_use]
pub fn differences_tell_distance(ranges: &[Range], dimensions: usize, place: Position) -> bool {
    /// The squares of the errors grow by so many times their variance: two standard deviations.
    const CLEAR: f64 = 4.0;
    let weight: f64 = ranges.iter().map(|range| range.weight).sum();
    let middle =
        ranges.iter().fold(Position::ORIGIN, |sum, range| sum + range.anchor * range.weight) * (1.0 / weight);
    let problem = Differences { ranges, dimensions };
    let squares = |place: Position| {
        let at = Vector4::new(place.x_m, place.y_m, place.z_m, 0.0);
        let length_m =
            -ranges.iter().map(|range| range.weight * problem.residual(&at, range).0).sum::<f64>() / weight;
        problem.cost(&Vector4::new(place.x_m, place.y_m, place.z_m, length_m))
    };
    let near = squares(place);
    let freedom = ranges.len().saturating_sub(dimensions + 1).max(1) as f64;
    squares(middle + (place - middle) * 2.0) - near > CLEAR * near / freedom
}

/// Place and length by linear least squares.
fn linear(ranges: &[Range], dimensions: usize) -> Result<Vector4<f64>, LaterationError> {
    let Some((last, others)) = ranges.split_last().filter(|(_, others)| others.len() > dimensions) else {
        return Err(LaterationError::TooFewDifferences { found: ranges.len(), dimensions });
    };
    if !ranges.iter().all(|range| range.anchor.is_finite() && range.distance_m.is_finite()) {
        return Err(LaterationError::NotFinite);
    }
    let relative = |range: &Range| <[f64; 3]>::from(range.anchor - last.anchor);
    let root = |row: usize| others[row].weight.sqrt();
    let matrix = DMatrix::from_fn(others.len(), dimensions + 1, |row, column| {
        let value = if column < dimensions {
            2.0 * relative(&others[row])[column]
        } else {
            2.0 * (last.distance_m - others[row].distance_m)
        };
        root(row) * value
    });
    let right = DVector::from_fn(others.len(), |row, _| {
        let square: f64 = relative(&others[row])[..dimensions].iter().map(|x| x * x).sum();
        root(row) * (square + last.distance_m.powi(2) - others[row].distance_m.powi(2))
    });
    let svd = matrix.svd(true, true);
    if svd.singular_values.min() <= FLATNESS * svd.singular_values.max() {
        return Err(LaterationError::Degenerate);
    }
    let found = svd.solve(&right, 0.0).map_err(|_| LaterationError::Degenerate)?;
    let z_m = if dimensions == 3 { last.anchor.z_m + found[2] } else { ranges[0].anchor.z_m };
    Ok(Vector4::new(last.anchor.x_m + found[0], last.anchor.y_m + found[1], z_m, found[dimensions]))
}

/// The distances that the place should have, with the length that is in all of them.
struct Differences<'a> {
    ranges: &'a [Range],
    dimensions: usize,
}

impl Differences<'_> {
    /// The residual of a range, and its slope by place and length.
    fn residual(&self, at: &Vector4<f64>, range: &Range) -> (f64, Vector4<f64>) {
        let z_m = if self.dimensions == 3 { at.z - range.anchor.z_m } else { 0.0 };
        let apart = Vector4::new(at.x - range.anchor.x_m, at.y - range.anchor.y_m, z_m, 0.0);
        let distance_m = apart.norm();
        let mut slope = if distance_m > 0.0 { apart / distance_m } else { Vector4::zeros() };
        slope.w = 1.0;
        (distance_m + at.w - range.distance_m, slope)
    }
}

impl LeastSquares for Differences<'_> {
    type Point = Vector4<f64>;
    type Step = Vector4<f64>;
    type Error = Infallible;

    fn cost(&self, at: &Vector4<f64>) -> f64 {
        self.ranges.iter().map(|range| range.weight * self.residual(at, range).0.powi(2)).sum()
    }

    fn step(&self, at: &Vector4<f64>, damping: f64) -> Result<Option<Vector4<f64>>, Infallible> {
        let (mut normal, mut gradient) = (Matrix4::zeros(), Vector4::zeros());
        for range in self.ranges {
            let (off, slope) = self.residual(at, range);
            normal += slope * slope.transpose() * range.weight;
            gradient += slope * (range.weight * off);
        }
        let scale = normal.trace().max(f64::MIN_POSITIVE);
        let damped = normal + Matrix4::identity() * (damping * scale);
        Ok(damped.cholesky().map(|cholesky| cholesky.solve(&gradient)))
    }

    fn moved(&self, at: &Vector4<f64>, step: &Vector4<f64>) -> Vector4<f64> {
        at - step
    }

    fn is_last(&self, at: &Vector4<f64>, step: &Vector4<f64>, is_lower: bool) -> bool {
        is_lower && step.norm() <= 1e-13 * (1.0 + at.norm())
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

    fn ranges(seed: u64, count: u64, height: f64, node: Position, longer_m: f64) -> Vec<Range> {
        let anchors = (1..=count).map(|i| place(seed, i, height));
        anchors.map(|anchor| Range::new(anchor, anchor.distance_m(node) + longer_m)).collect()
    }

    #[test]
    fn exact_differences_give_the_exact_place_whatever_the_time_of_sending() {
        for seed in 0..100 {
            for (dimensions, height) in [(2, 0.0), (3, 1.0)] {
                for longer_m in [0.0, 300.0, -7.0] {
                    let node = place(seed, 0, height);
                    let found = locate_by_differences(&ranges(seed, 9, height, node, longer_m), dimensions).unwrap();
                    assert!(found.distance_m(node) < 1e-6, "{found} not {node}, seed {seed}");
                }
            }
        }
    }

    #[test]
    fn the_place_is_a_minimum_over_all_lengths() {
        let node = place(3, 0, 0.0);
        let mut all = ranges(3, 9, 0.0, node, 5.0);
        for (i, range) in (0..).zip(&mut all) {
            range.distance_m += 0.2 * Seed(3).normal(Purpose::new(8), [i, 9, 0]);
        }
        let cost = |place: Position| -> f64 {
            let off: Vec<f64> = all.iter().map(|range| range.distance_m - place.distance_m(range.anchor)).collect();
            let mean = off.iter().sum::<f64>() / off.len() as f64;
            off.iter().map(|off| (off - mean).powi(2)).sum()
        };
        let found = locate_by_differences(&all, 2).unwrap();
        for angle in 0..16 {
            let step = Position::new(libm::cos(f64::from(angle)), libm::sin(f64::from(angle)), 0.0) * 1e-3;
            assert!(cost(found) < cost(found + step));
        }
        assert!(found.distance_m(node) < 1.0);
    }

    #[test]
    fn differences_tell_the_distance_of_near_places_and_not_of_those_far_from_all_anchors() {
        let told = |node: Position, place: Option<Position>| {
            let mut all = ranges(3, 30, 0.0, node, 5.0);
            for (i, range) in (0..).zip(&mut all) {
                range.distance_m += 0.2 * Seed(3).normal(Purpose::new(8), [i, 9, 0]);
            }
            let place = place.unwrap_or_else(|| locate_by_differences(&all, 2).unwrap());
            differences_tell_distance(&all, 2, place)
        };
        assert!(told(Position::new(3.0, 8.0, 0.0), None) && told(Position::new(14.0, -9.0, 0.0), None));
        let far = Position::new(150_000.0, 90_000.0, 0.0);
        assert!(!told(far, Some(far)));
    }

    #[test]
    fn too_few_anchors_and_anchors_on_a_line_are_refused() {
        let three = ranges(1, 3, 0.0, Position::ORIGIN, 1.0);
        let few = LaterationError::TooFewDifferences { found: 3, dimensions: 2 };
        assert_eq!(locate_by_differences(&three, 2), Err(few));
        let line = [0.0, 1.0, 3.0, 7.0].map(|x_m| Range::new(Position::new(x_m, 0.0, 0.0), x_m + 2.0));
        assert_eq!(locate_by_differences(&line, 2), Err(LaterationError::Degenerate));
    }
}
