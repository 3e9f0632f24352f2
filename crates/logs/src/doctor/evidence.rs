//! How probable the strengths of a node are if it is at a place, with shadowing that neighbouring stops share.
//!
//! A strength is `a − b ln √(d² + d₀²)` and a Gaussian process over the stops: shadowing with the correlation exp(−Δ/l)
//! (Gudmundson 1991), and noise of each stop alone. So stops that lie close together count about once. `a` and `b` have
//! Gaussian priors and are integrated out (Rasmussen and Williams 2006, section 2.7); places are on a lattice, and the mean over
//! it is that of a uniform prior. What needs more places or parameters pays for them by itself.

use nalgebra::{DMatrix, DVector};
use sextant_channel::Position;
use sextant_kernel::maths::{cholesky, exp_each, solve_lower};

use super::node_strengths::NodeStrengths;
use crate::place::distance::plane_m;

/// Mean and standard deviation of `b` (dB over a factor of e): a path-loss exponent of 2.5 ± 1.2.
const SLOPE_DB: [f64; 2] = [10.857, 5.212];
/// Standard deviation of the mean level of a node around that of its strengths (dB).
const LEVEL_DB: f64 = 20.0;
/// Places along the shorter and the longer side of a lattice, as the geometric mean.
const ALONG: f64 = 14.0;
/// The lattice of a survey reaches beyond the stops by this share of their extent, and that of a node beyond the stops that heard
/// it, as far as that of the survey.
const MARGIN: f64 = 0.15;
const NODE_MARGIN: f64 = 0.5;
/// The distance below which the law is flat (m), at least.
const FLAT_M: f64 = 0.5;

/// Shadowing of a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shadowing {
    /// Standard deviation of what neighbouring stops share (dB).
    pub(super) shared_db: f64,
    /// Distance over which it is correlated (m).
    pub(super) range_m: f64,
    /// Standard deviation of what each stop has alone (dB).
    pub(super) alone_db: f64,
}

/// Where a node may be, in the plane.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Lattice {
    pub(super) places: Vec<[f64; 2]>,
    /// Distance between neighbours (m).
    pub(super) step_m: f64,
    /// The diagonal of the box around the stops (m).
    pub(super) extent_m: f64,
    /// The ends along x and y (m).
    sides: [[f64; 2]; 2],
}

impl Lattice {
    /// The lattice around `stops`; `None` if all are at one place.
    pub(super) fn around(stops: impl Iterator<Item = Position> + Clone) -> Option<Self> {
        let sides = sides(stops);
        let extent_m = diagonal_m(sides);
        if !(extent_m.is_finite() && extent_m > 0.0) {
            return None;
        }
        Some(Self::on(sides.map(|[low, high]| [low - MARGIN * extent_m, high + MARGIN * extent_m]), extent_m))
    }

    /// The part of this lattice, made finer, in which a node may be that these stops heard: in a large field a lattice of all of it
    /// is coarser than the distances over which a node is heard.
    pub(super) fn near(&self, stops: &[Position]) -> Self {
        let heard = sides(stops.iter().copied());
        let margin_m = (NODE_MARGIN * diagonal_m(heard)).max(0.5 * self.step_m);
        let part = [0, 1].map(|axis| {
            let ([low, high], [first, last]) = (self.sides[axis], heard[axis]);
            [low.max(first - margin_m), high.min(last + margin_m)]
        });
        Self::on(part, self.extent_m * diagonal_m(part) / diagonal_m(self.sides))
    }

    fn on(sides: [[f64; 2]; 2], extent_m: f64) -> Self {
        let [width_m, depth_m] = sides.map(|[low, high]| high - low);
        let step_m = (width_m * depth_m).sqrt() / ALONG;
        let on_axis = |[low, high]: [f64; 2]| {
            let mut at = low + 0.5 * step_m;
            std::iter::from_fn(move || {
                let found = at;
                at += step_m;
                (found < high).then_some(found)
            })
        };
        let places = on_axis(sides[0]).flat_map(|x| on_axis(sides[1]).map(move |y| [x, y])).collect();
        Self { places, step_m, extent_m, sides }
    }

    /// The mean of the places, whose logarithms of probability are `ln`.
    pub(super) fn middle(&self, ln: &[f64]) -> Position {
        let highest = ln.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let (mut sum, mut total) = (Position::ORIGIN, 0.0);
        for (&[x, y], ln) in self.places.iter().zip(ln) {
            let weight = libm::exp(ln - highest);
            sum = sum + Position::new(x, y, 0.0) * weight;
            total += weight;
        }
        sum * (1.0 / total)
    }
}

/// The ends of `places` along x and y (m).
fn sides(places: impl Iterator<Item = Position> + Clone) -> [[f64; 2]; 2] {
    let along = |axis: fn(Position) -> f64| {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        places.clone().map(axis).fold(ends, |[low, high], at| [low.min(at), high.max(at)])
    };
    [along(|at| at.x_m), along(|at| at.y_m)]
}

/// The diagonal of a box with these ends (m).
fn diagonal_m([[west, east], [south, north]]: [[f64; 2]; 2]) -> f64 {
    libm::hypot(east - west, north - south)
}

/// The strengths of a node, and what a law says of them from each place of its lattice.
#[derive(Clone, Debug)]
pub(super) struct NodeField {
    pub(super) lattice: Lattice,
    levels_dbm: DVector<f64>,
    /// −ln √(d² + d₀²) of each stop (row) and place (column).
    logs: DMatrix<f64>,
    /// Distances between the stops (m).
    apart_m: DMatrix<f64>,
}

impl NodeField {
    /// What is known of a node in a survey that has this lattice.
    pub(super) fn new(heard: &NodeStrengths, survey: &Lattice) -> Self {
        let lattice = survey.near(&heard.places);
        let count = heard.len();
        let flat_m = FLAT_M.max(0.5 * lattice.step_m);
        let log = |stop: usize, place: usize| {
            let [x, y] = lattice.places[place];
            let (dx, dy) = (heard.places[stop].x_m - x, heard.places[stop].y_m - y);
            -0.5 * libm::log(dx * dx + dy * dy + flat_m * flat_m)
        };
        Self {
            levels_dbm: DVector::from_column_slice(&heard.levels_dbm),
            logs: DMatrix::from_fn(count, lattice.places.len(), log),
            apart_m: DMatrix::from_fn(count, count, |a, b| plane_m(heard.places[a], heard.places[b])),
            lattice,
        }
    }

    /// Number of stops.
    pub(super) fn len(&self) -> usize {
        self.levels_dbm.len()
    }

    /// The covariance of the strengths at the stops `rows`, apart from the law: its lower triangle.
    pub(super) fn covariance(&self, rows: &[usize], shadowing: Shadowing) -> DMatrix<f64> {
        let Shadowing { shared_db, range_m, alone_db } = shadowing;
        let mut below = DMatrix::zeros(rows.len(), rows.len());
        let columns = below.as_mut_slice().chunks_exact_mut(rows.len().max(1));
        for (column, (entries, &own)) in columns.zip(rows).enumerate() {
            let entries = &mut entries[column..];
            let others = entries.iter_mut().zip(&rows[column..]);
            others.for_each(|(entry, &other)| *entry = -self.apart_m[(own, other)] / range_m);
            exp_each(entries);
            entries.iter_mut().for_each(|entry| *entry = LEVEL_DB * LEVEL_DB + shared_db * shared_db * *entry);
            entries[0] += alone_db * alone_db;
        }
        below
    }

    /// The logarithm of the probability of the strengths at the stops `rows`, whose covariance is that, from each place of the
    /// lattice. `None` if the covariance is none.
    pub(super) fn by_place(&self, rows: &[usize], covariance: DMatrix<f64>) -> Option<Vec<f64>> {
        let root = root(covariance)?;
        let mut levels = self.centred(rows);
        let mut logs = self.logs.select_rows(rows);
        for mut column in logs.column_iter_mut() {
            let mean = column.mean();
            column.add_scalar_mut(-mean);
        }
        let [slope, deviation] = SLOPE_DB;
        solve_lower(root.as_slice(), rows.len(), levels.as_mut_slice());
        solve_lower(root.as_slice(), rows.len(), logs.as_mut_slice());
        let constant = constant(&root);
        let of_place = |log: usize| {
            let log = logs.column(log);
            let (with_levels, square) = (log.dot(&levels) - slope * log.norm_squared(), log.norm_squared());
            let left = levels.norm_squared() - 2.0 * slope * log.dot(&levels) + slope * slope * square;
            let precision = 1.0 / (deviation * deviation) + square;
            constant
                - 0.5 * (left - with_levels * with_levels / precision)
                - 0.5 * libm::log(precision * deviation * deviation)
        };
        Some((0..logs.ncols()).map(of_place).collect())
    }

    /// The same without a law: all distances are alike.
    pub(super) fn without_law(&self, rows: &[usize], covariance: DMatrix<f64>) -> Option<f64> {
        let root = root(covariance)?;
        let mut levels = self.centred(rows);
        solve_lower(root.as_slice(), rows.len(), levels.as_mut_slice());
        Some(constant(&root) - 0.5 * levels.norm_squared())
    }

    /// The strengths at `rows` about their mean (dB).
    fn centred(&self, rows: &[usize]) -> DVector<f64> {
        let mut levels = self.levels_dbm.select_rows(rows);
        let mean = levels.mean();
        levels.add_scalar_mut(-mean);
        levels
    }
}

/// The Cholesky factor of a covariance, below its diagonal; `None` if it is none.
fn root(mut covariance: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = covariance.nrows();
    cholesky(covariance.as_mut_slice(), size).then_some(covariance)
}

/// What a Gaussian density with the covariance of this root has apart from its exponent.
fn constant(root: &DMatrix<f64>) -> f64 {
    let count = root.nrows() as f64;
    let ln_root: f64 = root.diagonal().iter().map(|value| libm::log(*value)).sum();
    -ln_root - 0.5 * count * libm::log(std::f64::consts::TAU)
}

/// The logarithm of the mean of numbers whose logarithms are `ln`.
pub(super) fn ln_mean(ln: impl Iterator<Item = f64> + Clone) -> f64 {
    let highest = ln.clone().fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut count) = (0.0, 0.0);
    for ln in ln {
        sum += libm::exp(ln - highest);
        count += 1.0;
    }
    highest + libm::log(sum / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strengths(places: &[[f64; 2]], levels_dbm: &[f64]) -> NodeStrengths {
        NodeStrengths {
            stops: (0..).take(places.len()).collect(),
            places: places.iter().map(|&[x, y]| Position::new(x, y, 0.0)).collect(),
            levels_dbm: levels_dbm.to_vec(),
        }
    }

    #[test]
    fn the_evidence_of_two_stops_is_the_density_of_two_gaussians() {
        let heard = strengths(&[[0.0, 0.0], [3.0, 4.0]], &[-50.0, -56.0]);
        let lattice = Lattice::around(heard.places.iter().copied()).unwrap();
        let field = NodeField::new(&heard, &lattice);
        let shadowing = Shadowing { shared_db: 3.0, range_m: 5.0, alone_db: 2.0 };
        let found = field.by_place(&[0, 1], field.covariance(&[0, 1], shadowing)).unwrap();
        // By hand: the sum and the difference of two strengths with the same variance are independent.
        let flat_m = FLAT_M.max(0.5 * field.lattice.step_m);
        let [x, y] = field.lattice.places[7];
        let log = |at: Position| -0.5 * ((at.x_m - x).powi(2) + (at.y_m - y).powi(2) + flat_m * flat_m).ln();
        let step = log(heard.places[0]) - log(heard.places[1]);
        let shared = 9.0 * (-1.0_f64).exp();
        let difference = 2.0 * (9.0 + 4.0 - shared) + (SLOPE_DB[1] * step).powi(2);
        let sum = 2.0 * (9.0 + 4.0 + shared) + 4.0 * LEVEL_DB * LEVEL_DB;
        let normal =
            |error: f64, variance: f64| -0.5 * (error * error / variance + (std::f64::consts::TAU * variance).ln());
        // A change of variables from two strengths to their sum and difference has the determinant 2.
        let expected = normal(6.0 - SLOPE_DB[0] * step, difference) + normal(0.0, sum) + 2.0_f64.ln();
        assert!((found[7] - expected).abs() < 1e-9, "{} {expected}", found[7]);
        let without = field.without_law(&[0, 1], field.covariance(&[0, 1], shadowing)).unwrap();
        let flat = 2.0 * (9.0 + 4.0 - shared);
        assert!((without - (normal(6.0, flat) + normal(0.0, sum) + 2.0_f64.ln())).abs() < 1e-9);
    }

    #[test]
    fn the_lattice_of_a_node_is_that_of_a_small_survey_and_finer_in_a_large_one() {
        let corners = |size_m: f64| [Position::ORIGIN, Position::new(size_m, size_m, 0.0)];
        let survey = Lattice::around(corners(100.0).into_iter()).unwrap();
        assert_eq!(survey.near(&corners(100.0)), survey);
        let part = survey.near(&corners(10.0));
        // 10 m and half of the diagonal beyond, on the side where the survey goes on; it ends 21 m beyond its stops on the other.
        let wide_m = 10.0 + 2.0 * 0.5 * 10.0 * 2.0_f64.sqrt();
        assert!((part.step_m - wide_m / ALONG).abs() < 1e-9, "{}", part.step_m);
        assert!((part.extent_m - survey.extent_m * wide_m / (100.0 + 30.0 * 2.0_f64.sqrt())).abs() < 1e-9);
    }

    #[test]
    fn the_mean_of_logarithms_is_that_of_the_numbers() {
        let numbers = [0.5_f64, 1.5, 4.0];
        assert!((ln_mean(numbers.iter().map(|number| number.ln() - 900.0)) - (2.0_f64.ln() - 900.0)).abs() < 1e-12);
    }
}
