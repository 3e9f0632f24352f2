//! How probable the strengths of a node are if it is at a place, with shadowing that neighbouring stops share.
//!
//! A strength is `a − b ln √(d² + d₀²)` and a Gaussian process over the stops: shadowing with the correlation exp(−Δ/l)
//! (Gudmundson 1991), and noise of each stop alone. So stops that lie close together count about once. `a` and `b` have
//! Gaussian priors and are integrated out (Rasmussen and Williams 2006, section 2.7); places are on a lattice, and the mean over
//! it is that of a uniform prior. What needs more places or parameters pays for them by itself.

use nalgebra::{DMatrix, DVector};
use sextant_kernel::maths::{InverseProducts, ShiftedMatrices, cholesky, exp_each, solve_lower};

use super::lattice::Lattice;
use super::node_strengths::NodeStrengths;
use crate::place::distance::plane_m;

/// Mean and standard deviation of `b` (dB over a factor of e): a path-loss exponent of 2.5 ± 1.2.
const SLOPE_DB: [f64; 2] = [10.857, 5.212];
/// Standard deviation of the mean level of a node around that of its strengths (dB).
const LEVEL_DB: f64 = 20.0;
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

    /// What the strengths at the stops `rows`, whose covariance is that, say of each place. `None` if the covariance is none.
    pub(super) fn at(&self, rows: &[usize], covariance: DMatrix<f64>) -> Option<FieldAt> {
        let root = root(covariance)?;
        let sides = self.sides(rows);
        let mut solved = sides.clone();
        solve_lower(root.as_slice(), rows.len(), solved.as_mut_slice());
        Some(FieldAt { root, sides, solved })
    }

    /// The logarithm of the probability of the strengths without a law: all distances are alike.
    pub(super) fn without_law(&self, rows: &[usize], covariance: DMatrix<f64>) -> Option<f64> {
        let root = root(covariance)?;
        let mut levels = self.centred(rows);
        solve_lower(root.as_slice(), rows.len(), levels.as_mut_slice());
        Some(constant(ln_determinant(&root), rows.len() as f64) - 0.5 * levels.norm_squared())
    }

    /// What all stops say under any shadowing of this range.
    pub(super) fn of_range(&self, range_m: f64) -> FieldOfRange {
        let rows: Vec<usize> = (0..self.len()).collect();
        let mut shared: Vec<f64> = self.apart_m.iter().map(|apart_m| -apart_m / range_m).collect();
        exp_each(&mut shared);
        let shifted = ShiftedMatrices::new(shared, self.len(), self.sides(&rows).as_slice());
        FieldOfRange { shifted, count: self.len() as f64 }
    }

    /// At the stops `rows`: ones, the strengths and the logarithms of each place, about their means.
    fn sides(&self, rows: &[usize]) -> DMatrix<f64> {
        let mut sides = self.logs.select_rows(rows).insert_columns(0, 2, 1.0);
        sides.set_column(1, &self.levels_dbm.select_rows(rows));
        for mut column in sides.column_iter_mut().skip(1) {
            let mean = column.mean();
            column.add_scalar_mut(-mean);
        }
        sides
    }

    /// The strengths at `rows` about their mean (dB).
    fn centred(&self, rows: &[usize]) -> DVector<f64> {
        let mut levels = self.levels_dbm.select_rows(rows);
        let mean = levels.mean();
        levels.add_scalar_mut(-mean);
        levels
    }
}

/// The strengths of a node at all stops, under shadowing of one range.
#[derive(Clone, Debug)]
pub(super) struct FieldOfRange {
    /// The correlations; the first sides are ones, and the strengths.
    shifted: ShiftedMatrices,
    count: f64,
}

impl FieldOfRange {
    /// The logarithms of the probability of the strengths, with a law (the mean over the places) and without one.
    pub(super) fn evidence(&self, shared_db: f64, alone_db: f64) -> Option<[f64; 2]> {
        let InverseProducts { ln_determinant, squares, with_first: [with_ones, with_levels] } =
            self.shifted.products(shared_db * shared_db, alone_db * alone_db)?;
        let level = Change { square: with_ones[0], with_levels: with_ones[1], with_logs: &with_ones[2..] };
        let alone = PlaceProducts {
            levels: squares[1],
            with_levels: with_levels[2..].to_vec(),
            logs: squares[2..].to_vec(),
            ln_determinant,
            count: self.count,
        };
        let products = alone.changed(LEVEL_DB * LEVEL_DB, &level);
        Some([products.one_place(), products.constant() - 0.5 * products.levels])
    }
}

/// What the strengths of a node at some stops, in an order, say of each place.
#[derive(Clone, Debug)]
pub(super) struct FieldAt {
    /// The Cholesky factor of the covariance.
    root: DMatrix<f64>,
    /// Ones, the strengths and the logarithms of each place: as they are, and times the inverse of the root.
    sides: DMatrix<f64>,
    solved: DMatrix<f64>,
}

impl FieldAt {
    /// What the first `count` of the stops say.
    pub(super) fn of_first(&self, count: usize) -> PlaceProducts {
        let solved = self.solved.rows(0, count);
        let (ones, levels) = (solved.column(0), solved.column(1));
        let (square, with_levels) = (ones.norm_squared(), ones.dot(&levels));
        let mean = |side: usize| self.sides.column(side).rows(0, count).mean();
        let middle = mean(1);
        // Of each place: its product with itself and with the strengths, all about the means of these stops.
        let of_place = |side: usize| {
            let (log, mean) = (solved.column(side), mean(side));
            let with_ones = log.dot(&ones);
            let own = log.norm_squared() - mean * (2.0 * with_ones - mean * square);
            (own, log.dot(&levels) - mean * with_levels - middle * (with_ones - mean * square))
        };
        let (logs, with_logs) = (2..self.solved.ncols()).map(of_place).unzip();
        PlaceProducts {
            levels: levels.norm_squared() - middle * (2.0 * with_levels - middle * square),
            with_levels: with_logs,
            logs,
            ln_determinant: self.root.diagonal().rows(0, count).iter().map(|value| 2.0 * libm::log(*value)).sum(),
            count: count as f64,
        }
    }

    /// The same of all stops, whose `products` these are, if their level changes from the stop `at` on with this variance (dB²).
    pub(super) fn stepped(&self, products: &PlaceProducts, at: usize, variance: f64) -> PlaceProducts {
        let count = self.root.nrows();
        let mut step = DVector::from_fn(count, |row, _| f64::from(u8::from(row >= at)));
        solve_lower(self.root.as_slice(), count, step.as_mut_slice());
        let with: Vec<f64> = self.solved.column_iter().skip(1).map(|side| side.dot(&step)).collect();
        let change = Change { square: step.norm_squared(), with_levels: with[0], with_logs: &with[1..] };
        products.changed(variance, &change)
    }
}

/// Strengths and the logarithms of each place under the inverse of a covariance.
#[derive(Clone, Debug)]
pub(super) struct PlaceProducts {
    /// The product of the strengths with themselves, and with the logarithms of each place.
    levels: f64,
    with_levels: Vec<f64>,
    /// The product of the logarithms of each place with themselves.
    logs: Vec<f64>,
    ln_determinant: f64,
    count: f64,
}

/// The products of how a level changes over the stops with itself, the strengths and the logarithms of each place.
struct Change<'a> {
    square: f64,
    with_levels: f64,
    with_logs: &'a [f64],
}

impl PlaceProducts {
    /// Those with a level that also changes in one way, with this variance (Sherman and Morrison 1950).
    fn changed(&self, variance: f64, change: &Change<'_>) -> Self {
        let more = 1.0 + variance * change.square;
        let share = variance / more;
        let with = change.with_logs;
        Self {
            levels: self.levels - share * change.with_levels * change.with_levels,
            with_levels: self
                .with_levels
                .iter()
                .zip(with)
                .map(|(own, with)| own - share * with * change.with_levels)
                .collect(),
            logs: self.logs.iter().zip(with).map(|(own, with)| own - share * with * with).collect(),
            ln_determinant: self.ln_determinant + libm::log(more),
            count: self.count,
        }
    }

    /// The logarithm of the probability of the strengths from each place, with `a` and `b` integrated out.
    pub(super) fn by_place(&self) -> Vec<f64> {
        let constant = self.constant();
        let of_place = |(with, logs): (&f64, &f64)| constant + exponent(self.levels, *with, *logs);
        self.with_levels.iter().zip(&self.logs).map(of_place).collect()
    }

    /// The same from any place.
    pub(super) fn one_place(&self) -> f64 {
        ln_mean(self.by_place().iter().copied())
    }

    fn constant(&self) -> f64 {
        constant(self.ln_determinant, self.count)
    }
}

/// The exponent of the density of strengths at a place, with `a` and `b` integrated out: from the squares of the strengths and of
/// the logarithms at the place under the inverse of the covariance, and their product.
fn exponent(strengths: f64, with_strengths: f64, logs: f64) -> f64 {
    let [slope, deviation] = SLOPE_DB;
    let left = strengths - 2.0 * slope * with_strengths + slope * slope * logs;
    let along = with_strengths - slope * logs;
    let precision = 1.0 / (deviation * deviation) + logs;
    -0.5 * (left - along * along / precision) - 0.5 * libm::log(precision * deviation * deviation)
}

/// The Cholesky factor of a covariance, below its diagonal; `None` if it is none.
fn root(mut covariance: DMatrix<f64>) -> Option<DMatrix<f64>> {
    let size = covariance.nrows();
    cholesky(covariance.as_mut_slice(), size).then_some(covariance)
}

/// The logarithm of the determinant of the matrix of a Cholesky factor.
fn ln_determinant(root: &DMatrix<f64>) -> f64 {
    root.diagonal().iter().map(|value| 2.0 * libm::log(*value)).sum()
}

/// What a Gaussian density of `count` numbers, whose covariance has this determinant, has apart from its exponent.
fn constant(ln_determinant: f64, count: f64) -> f64 {
    -0.5 * ln_determinant - 0.5 * count * libm::log(std::f64::consts::TAU)
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
    use sextant_channel::Position;

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
        let found = field.at(&[0, 1], field.covariance(&[0, 1], shadowing)).unwrap().of_first(2).by_place();
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

    /// Fifteen strengths on a curve, and all of them.
    fn curve() -> (NodeField, Vec<usize>) {
        let at = |i: u32| [7.0 * libm::sin(f64::from(i)), 5.0 * libm::cos(1.7 * f64::from(i))];
        let levels: Vec<f64> = (0..15).map(|i| -60.0 + 8.0 * libm::sin(2.3 * f64::from(i))).collect();
        let heard = strengths(&(0..15).map(at).collect::<Vec<_>>(), &levels);
        (NodeField::new(&heard, &Lattice::around(heard.places.iter().copied()).unwrap()), (0..15).collect())
    }

    #[test]
    fn all_shadowings_of_a_range_have_the_evidence_of_each_by_itself() {
        let (field, rows) = curve();
        for (shared_db, range_m, alone_db) in [(1.5, 0.3, 1.0), (12.0, 4.0, 1.0), (5.0, 40.0, 4.0)] {
            let [law, alone] = field.of_range(range_m).evidence(shared_db, alone_db).unwrap();
            let covariance = || field.covariance(&rows, Shadowing { shared_db, range_m, alone_db });
            let by_itself = field.at(&rows, covariance()).unwrap().of_first(15).one_place();
            assert!((law - by_itself).abs() < 1e-9, "{law} {by_itself}");
            assert!((alone - field.without_law(&rows, covariance()).unwrap()).abs() < 1e-9, "{alone}");
        }
    }

    #[test]
    fn the_first_stops_and_a_step_have_the_evidence_of_their_own_covariance() {
        let (field, rows) = curve();
        let shadowing = Shadowing { shared_db: 4.0, range_m: 3.0, alone_db: 2.0 };
        let covariance = |rows: &[usize]| field.covariance(rows, shadowing);
        let all = field.at(&rows, covariance(&rows)).unwrap();
        let first = field.at(&rows[..6], covariance(&rows[..6])).unwrap().of_first(6).by_place();
        for (found, expected) in all.of_first(6).by_place().iter().zip(&first) {
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        let step = DMatrix::from_fn(15, 15, |a, b| if a >= 9 && b >= 9 { 100.0 } else { 0.0 });
        let expected = field.at(&rows, covariance(&rows) + step).unwrap().of_first(15).one_place();
        let found = all.stepped(&all.of_first(15), 9, 100.0).one_place();
        assert!((found - expected).abs() < 1e-9, "{found} {expected}");
    }

    #[test]
    fn the_mean_of_logarithms_is_that_of_the_numbers() {
        let numbers = [0.5_f64, 1.5, 4.0];
        assert!((ln_mean(numbers.iter().map(|number| number.ln() - 900.0)) - (2.0_f64.ln() - 900.0)).abs() < 1e-12);
    }
}
