//! Places from directions that were measured at known places.

use std::convert::Infallible;

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};
use sextant_channel::Position;

use super::{DAMPING, LaterationError, STEPS};
use crate::grid_ml::directions::wrapped;
use crate::numerics::least_squares::{LeastSquares, minimum};

/// Residuals of more standard deviations count linearly: 5 % more variance where errors are normal (Huber 1964).
const HUBER: f64 = 1.345;
/// Least ratio of the eigenvalues of the normal equations at which lines still cross.
const FLATNESS: f64 = 1e-9;

/// An angle and its standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredAngle {
    /// The angle (rad).
    pub rad: f64,
    /// Standard deviation of its error (rad), above 0.
    pub sigma_rad: f64,
}

/// The direction of a node, measured at a known place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    /// The known place (m).
    pub from: Position,
    /// Azimuth, counter-clockwise from x.
    pub azimuth: MeasuredAngle,
    /// Elevation above the horizontal plane, if it was measured.
    pub elevation: Option<MeasuredAngle>,
}

/// The place that fits the directions best: the minimum of the sum of Huber's function of all angular errors over their standard
/// deviations, which is the maximum of the likelihood if errors are normal (Gavish and Weiss 1992) and does not follow a few that
/// are far off. The search starts where the lines cross by linear least squares (Stansfield 1947), and amid the known places: lines
/// also cross behind those who measured. Without elevations the height is the mean of the known places.
///
/// # Errors
/// If fewer than two directions are given, all lines are parallel, a place is so unsure that its standard deviation is
/// more than its distance from the farthest of the known places, or a number is not finite.
pub fn angulate(bearings: &[Bearing]) -> Result<Position, LaterationError> {
    let crossing = crossing(bearings)?;
    let has_elevations = bearings.iter().any(|bearing| bearing.elevation.is_some());
    let directions = Directions { bearings, has_elevations };
    let found = [crossing, middle(bearings)].map(|start| {
        let Ok(place) = minimum(&directions, start, DAMPING, STEPS);
        place
    });
    let place = if directions.cost(&found[1]) < directions.cost(&found[0]) { found[1] } else { found[0] };
    let farthest_m = bearings.iter().map(|bearing| bearing.from.distance_m(place)).fold(0.0, f64::max);
    let is_sure = directions.deviation_m(place).is_some_and(|deviation_m| deviation_m <= farthest_m);
    if is_sure { Ok(place) } else { Err(LaterationError::Parallel) }
}

/// The mean of the places where directions were measured.
fn middle(bearings: &[Bearing]) -> Position {
    bearings.iter().fold(Position::ORIGIN, |sum, bearing| sum + bearing.from) * (1.0 / bearings.len() as f64)
}

/// Where the lines cross by linear least squares: the minimum of `Σ (n·(x − a))² / σ²`, with n across the line.
fn crossing(bearings: &[Bearing]) -> Result<Position, LaterationError> {
    if bearings.len() < 2 {
        return Err(LaterationError::TooFewDirections { found: bearings.len() });
    }
    let angles = |bearing: &Bearing| [Some(bearing.azimuth), bearing.elevation].into_iter().flatten();
    let is_finite = |bearing: &Bearing| {
        bearing.from.is_finite() && angles(bearing).all(|angle| angle.rad.is_finite() && angle.sigma_rad > 0.0)
    };
    if !bearings.iter().all(is_finite) {
        return Err(LaterationError::NotFinite);
    }
    let middle =
        bearings.iter().fold(Position::ORIGIN, |sum, bearing| sum + bearing.from) * (1.0 / bearings.len() as f64);
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    for bearing in bearings {
        let (sin, cos) = libm::sincos(bearing.azimuth.rad);
        let across = Vector2::new(-sin, cos) / bearing.azimuth.sigma_rad;
        let from = bearing.from - middle;
        normal += across * across.transpose();
        right += across * across.dot(&Vector2::new(from.x_m, from.y_m));
    }
    let eigenvalues = normal.symmetric_eigenvalues();
    if eigenvalues.min() <= FLATNESS * eigenvalues.max() {
        return Err(LaterationError::Parallel);
    }
    let plane = normal.cholesky().ok_or(LaterationError::Parallel)?.solve(&right);
    let place = middle + Position::new(plane.x, plane.y, 0.0);
    let (mut height, mut weights) = (0.0, 0.0);
    for bearing in bearings {
        if let Some(elevation) = bearing.elevation {
            let along = place - bearing.from;
            let weight = elevation.sigma_rad.powi(-2);
            height += weight * (bearing.from.z_m + libm::hypot(along.x_m, along.y_m) * libm::tan(elevation.rad));
            weights += weight;
        }
    }
    Ok(if weights > 0.0 { Position::new(place.x_m, place.y_m, height / weights) } else { place })
}

/// The directions that the place should have.
struct Directions<'a> {
    bearings: &'a [Bearing],
    /// Otherwise the height is not sought.
    has_elevations: bool,
}

impl Directions<'_> {
    /// Standard deviation of a place (m), by the information of all directions; `None` if they do not tell one.
    fn deviation_m(&self, place: Position) -> Option<f64> {
        let mut information = Matrix3::zeros();
        for (_, slope) in self.residuals(place) {
            information += slope * slope.transpose();
        }
        if !self.has_elevations {
            let plane = information.fixed_view::<2, 2>(0, 0).into_owned().cholesky()?;
            return Some(plane.inverse().trace().sqrt());
        }
        Some(information.cholesky()?.inverse().trace().sqrt())
    }

    /// The residuals of a place over their standard deviations, each with its slope.
    fn residuals(&self, place: Position) -> impl Iterator<Item = (f64, Vector3<f64>)> {
        self.bearings.iter().flat_map(move |bearing| {
            let apart = place - bearing.from;
            let level_m = libm::hypot(apart.x_m, apart.y_m);
            let square = level_m * level_m + apart.z_m * apart.z_m;
            let of_azimuth = || {
                let off = wrapped(libm::atan2(apart.y_m, apart.x_m) - bearing.azimuth.rad);
                let slope = Vector3::new(-apart.y_m, apart.x_m, 0.0) / (level_m * level_m);
                (off / bearing.azimuth.sigma_rad, slope / bearing.azimuth.sigma_rad)
            };
            let of_elevation = |elevation: MeasuredAngle| {
                let off = libm::atan2(apart.z_m, level_m) - elevation.rad;
                let steep = apart.z_m / level_m;
                let slope = Vector3::new(-apart.x_m * steep, -apart.y_m * steep, level_m) / square;
                (off / elevation.sigma_rad, slope / elevation.sigma_rad)
            };
            // A place on the antenna has no direction.
            let has_direction = level_m > 0.0;
            let azimuth = has_direction.then(of_azimuth);
            [azimuth, bearing.elevation.filter(|_| has_direction).map(of_elevation)].into_iter().flatten()
        })
    }
}

impl LeastSquares for Directions<'_> {
    type Point = Position;
    type Step = Vector3<f64>;
    type Error = Infallible;

    fn cost(&self, at: &Position) -> f64 {
        let huber = |off: f64| if off.abs() <= HUBER { off * off } else { HUBER * (2.0 * off.abs() - HUBER) };
        self.residuals(*at).map(|(off, _)| huber(off)).sum()
    }

    fn step(&self, at: &Position, damping: f64) -> Result<Option<Vector3<f64>>, Infallible> {
        let (mut normal, mut gradient) = (Matrix3::zeros(), Vector3::zeros());
        for (off, slope) in self.residuals(*at) {
            let weight = (HUBER / off.abs()).min(1.0);
            normal += slope * slope.transpose() * weight;
            gradient += slope * (weight * off);
        }
        if !self.has_elevations {
            normal[(2, 2)] = normal.trace().max(f64::MIN_POSITIVE);
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

    /// Directions from `count` places to `node`, with normal errors of `sigma_rad`.
    fn bearings(seed: u64, count: u64, node: Position, height: f64, sigma_rad: f64) -> Vec<Bearing> {
        let angle = |rad: f64, i, axis| MeasuredAngle {
            rad: rad + sigma_rad * Seed(seed).normal(Purpose::new(9), [i, axis, 0]),
            sigma_rad: sigma_rad.max(1e-4),
        };
        let one = |i| {
            let from = place(77, i, height);
            let apart = node - from;
            let azimuth = angle(libm::atan2(apart.y_m, apart.x_m), i, 0);
            let elevation =
                (height > 0.0).then(|| angle(libm::atan2(apart.z_m, libm::hypot(apart.x_m, apart.y_m)), i, 1));
            Bearing { from, azimuth, elevation }
        };
        (1..=count).map(one).collect()
    }

    #[test]
    fn exact_directions_give_the_exact_place_in_the_plane_and_in_space() {
        for seed in 0..100 {
            for (count, height) in [(2, 0.0), (9, 0.0), (2, 1.0), (9, 1.0)] {
                let node = place(seed, 0, height);
                let found = angulate(&bearings(seed, count, node, height, 0.0)).unwrap();
                assert!(found.distance_m(node) < 1e-6, "{found} not {node}, seed {seed}");
            }
        }
    }

    #[test]
    fn errors_are_near_the_bound_of_cramer_and_rao() {
        let (node, sigma_rad) = (Position::new(2.0, -3.0, 0.0), 0.05);
        let first = bearings(0, 12, node, 0.0, sigma_rad);
        let mut information = Matrix2::zeros();
        for bearing in &first {
            let apart = node - bearing.from;
            let slope = Vector2::new(-apart.y_m, apart.x_m) / (apart.dot(apart) * sigma_rad);
            information += slope * slope.transpose();
        }
        let bound = information.try_inverse().unwrap().trace();
        let runs = 400;
        let square = |seed| angulate(&bearings(seed, 12, node, 0.0, sigma_rad)).unwrap().distance_m(node).powi(2);
        let mean = (0..runs).map(square).sum::<f64>() / f64::from(u32::try_from(runs).unwrap());
        // The standard error of the mean square of 400 runs is about 6 %, and Huber's function costs about 5 %.
        assert!((0.85..1.3).contains(&(mean / bound)), "{mean} {bound}");
    }

    #[test]
    fn a_direction_that_is_far_off_moves_the_place_little() {
        let node = Position::new(2.0, -3.0, 0.0);
        let mut all = bearings(5, 12, node, 0.0, 0.02);
        all[3].azimuth.rad += 2.0;
        assert!(crossing(&all).unwrap().distance_m(node) > 0.5);
        assert!(angulate(&all).unwrap().distance_m(node) < 0.25);
    }

    #[test]
    fn lines_that_cross_behind_those_who_measured_give_no_place_far_away() {
        let from = |x_m: f64| Position::new(x_m, 0.0, 0.0);
        let up = |x_m: f64, rad: f64| Bearing {
            from: from(x_m),
            azimuth: MeasuredAngle { rad, sigma_rad: 0.1 },
            elevation: None,
        };
        let half = std::f64::consts::FRAC_PI_2;
        // They spread upwards, so their lines cross below.
        let spread = [up(-1.0, half + 0.02), up(0.0, half), up(1.0, half - 0.02)];
        assert!(crossing(&spread).unwrap().y_m < -40.0);
        assert_eq!(angulate(&spread), Err(LaterationError::Parallel));
    }

    #[test]
    fn one_line_parallel_lines_and_invalid_numbers_are_refused() {
        let node = Position::new(1.0, 1.0, 0.0);
        let two = bearings(1, 2, node, 0.0, 0.0);
        assert_eq!(angulate(&two[..1]), Err(LaterationError::TooFewDirections { found: 1 }));
        let parallel = Bearing { from: two[0].from + Position::new(1.0, 2.0, 0.0), ..two[0] };
        assert_eq!(angulate(&[two[0], parallel]), Err(LaterationError::Parallel));
        let invalid = Bearing { azimuth: MeasuredAngle { rad: f64::NAN, sigma_rad: 0.1 }, ..two[0] };
        assert_eq!(angulate(&[two[1], invalid]), Err(LaterationError::NotFinite));
    }
}
