//! All places together that fit the distances best.

use nalgebra::{DMatrix, DVector};
use sextant_channel::Position;
use sextant_kernel::maths::{cholesky, solve_lower};
use sextant_kernel::{Interrupted, Watch, Work};

use super::NAME;
use crate::comparators::smacof::PairDistance;
use crate::numerics::least_squares::{Damping, LeastSquares, minimum};

/// Most steps of a fit.
const STEPS: u32 = 100;
/// A step in which no node moves farther is the last (m).
const SMALL_M: f64 = 1e-9;
const DAMPING: Damping = Damping { first: 1e-3, ease: 0.2, least: 1e-12, tighten: 5.0, most: 1e12 };

/// The least-squares problem of all nodes that are not anchors.
pub(super) struct Cooperative<'a> {
    pairs: Vec<PairDistance>,
    /// The number of each node among those that move.
    moves: Vec<Option<usize>>,
    /// The places of those that do not.
    fixed: &'a [(usize, Position)],
    dimensions: usize,
}

/// The slopes of the squares: half of the gradient, and the matrix of the normal equations.
struct Slopes {
    gradient: DVector<f64>,
    normal: DMatrix<f64>,
}

impl<'a> Cooperative<'a> {
    /// The problem of the nodes that have `places`, apart from the anchors `fixed`.
    pub(super) fn new(
        pairs: &[PairDistance],
        fixed: &'a [(usize, Position)],
        places: &[Option<Position>],
        dimensions: usize,
    ) -> Self {
        let mut count = 0;
        let moves = places.iter().enumerate().map(|(node, place)| {
            let is_free = place.is_some() && !fixed.iter().any(|&(anchor, _)| anchor == node);
            is_free.then(|| {
                count += 1;
                count - 1
            })
        });
        let moves: Vec<Option<usize>> = moves.collect();
        let told = |pair: &&PairDistance| {
            places[pair.a].is_some()
                && places[pair.b].is_some()
                && (moves[pair.a].is_some() || moves[pair.b].is_some())
        };
        Self { pairs: pairs.iter().filter(told).copied().collect(), moves, fixed, dimensions }
    }

    /// Moves `places` to the best fit, and writes the covariances of those that anchors fix.
    pub(super) fn fit(
        &self,
        places: &mut [Option<Position>],
        covariances: &mut [Option<[[f64; 3]; 3]>],
        watch: &dyn Watch,
    ) -> Result<(), Interrupted> {
        let size = self.dimensions * self.moves.iter().flatten().count();
        if size == 0 {
            return Ok(());
        }
        let operations = (size as f64).powi(3) / 3.0 * f64::from(STEPS);
        watch.begin(Work { name: NAME, unit: "step", steps: STEPS.into(), operations });
        let start: Vec<Position> = places.iter().map(|place| place.unwrap_or(Position::ORIGIN)).collect();
        let found = minimum(&Watched { problem: self, watch }, start, DAMPING, STEPS)?;
        let squares = self.cost(&found);
        for (node, place) in places.iter_mut().enumerate() {
            if self.moves[node].is_some() {
                *place = Some(found[node]);
            }
        }
        // Without anchors the places are known up to turns and shifts; with no more distances than unknowns nothing tells the noise.
        let spare = self.pairs.len().saturating_sub(size);
        if self.fixed.is_empty() || spare == 0 {
            return Ok(());
        }
        let Slopes { mut normal, .. } = self.slopes(&found);
        if !cholesky(normal.as_mut_slice(), size) {
            return Ok(());
        }
        let variance = squares / spare as f64;
        for (node, number) in self.moves.iter().enumerate() {
            let Some(number) = number else { continue };
            let mut halves = vec![0.0; self.dimensions * size];
            for axis in 0..self.dimensions {
                halves[axis * size + number * self.dimensions + axis] = 1.0;
            }
            solve_lower(normal.as_slice(), size, &mut halves);
            let half = |axis: usize| &halves[axis * size..(axis + 1) * size];
            let mut covariance = [[0.0; 3]; 3];
            for (row, line) in covariance.iter_mut().enumerate().take(self.dimensions) {
                for (column, entry) in line.iter_mut().enumerate().take(self.dimensions) {
                    *entry = variance * half(row).iter().zip(half(column)).map(|(a, b)| a * b).sum::<f64>();
                }
            }
            covariances[node] = Some(covariance);
        }
        Ok(())
    }

    fn cost(&self, at: &[Position]) -> f64 {
        self.pairs.iter().map(|pair| (at[pair.a].distance_m(at[pair.b]) - pair.distance_m).powi(2)).sum()
    }

    fn slopes(&self, at: &[Position]) -> Slopes {
        let size = self.dimensions * self.moves.iter().flatten().count();
        let mut slopes = Slopes { gradient: DVector::zeros(size), normal: DMatrix::zeros(size, size) };
        for pair in &self.pairs {
            let apart = at[pair.a] - at[pair.b];
            let distance_m = apart.length_m();
            if distance_m <= 0.0 {
                continue;
            }
            let residual_m = distance_m - pair.distance_m;
            let along: [f64; 3] = (apart * (1.0 / distance_m)).into();
            let ends = [(self.moves[pair.a], 1.0), (self.moves[pair.b], -1.0)];
            for (own, sign) in ends {
                let Some(own) = own else { continue };
                for row in 0..self.dimensions {
                    let first = own * self.dimensions + row;
                    slopes.gradient[first] += sign * along[row] * residual_m;
                    for (other, other_sign) in ends {
                        let Some(other) = other else { continue };
                        for column in 0..self.dimensions {
                            slopes.normal[(first, other * self.dimensions + column)] +=
                                sign * other_sign * along[row] * along[column];
                        }
                    }
                }
            }
        }
        slopes
    }
}

/// The problem, with the watch that may end the work.
struct Watched<'a> {
    problem: &'a Cooperative<'a>,
    watch: &'a dyn Watch,
}

impl LeastSquares for Watched<'_> {
    type Point = Vec<Position>;
    type Step = Vec<f64>;
    type Error = Interrupted;

    fn cost(&self, at: &Vec<Position>) -> f64 {
        self.problem.cost(at)
    }

    fn step(&self, at: &Vec<Position>, damping: f64) -> Result<Option<Vec<f64>>, Interrupted> {
        self.watch.check()?;
        self.watch.advance(1);
        let Slopes { mut normal, gradient } = self.problem.slopes(at);
        let size = gradient.len();
        let scale = normal.trace() / size as f64;
        for i in 0..size {
            normal[(i, i)] += damping * scale;
        }
        if !cholesky(normal.as_mut_slice(), size) {
            return Ok(None);
        }
        let factor = nalgebra::linalg::Cholesky::pack_dirty(normal);
        Ok(Some(factor.solve(&gradient).as_slice().to_vec()))
    }

    fn moved(&self, at: &Vec<Position>, step: &Vec<f64>) -> Vec<Position> {
        let dimensions = self.problem.dimensions;
        let along =
            |number: usize, axis: usize| if axis < dimensions { step[number * dimensions + axis] } else { 0.0 };
        let moved = at.iter().zip(&self.problem.moves).map(|(&place, number)| match *number {
            Some(number) => place - Position::new(along(number, 0), along(number, 1), along(number, 2)),
            None => place,
        });
        moved.collect()
    }

    fn is_last(&self, _: &Vec<Position>, step: &Vec<f64>, _: bool) -> bool {
        step.iter().all(|along| along.abs() <= SMALL_M)
    }
}
