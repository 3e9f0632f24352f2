//! How uncertain the frames of the robots are, and what that means for a place on the map of all.
//!
//! The frame of the first robot is that of the map, so it is exact. The others err together: a frame that is joined through
//! another one has the errors of both. The claim is for places in the frame of the first robot. After an alignment of all places
//! to something else, errors are smaller.

use nalgebra::{DMatrix, Matrix3, Vector3};
use sextant_channel::Position;

use super::frame_change::{FrameChange, Lengths, vector};
use super::joint::{Observation, PoseGraph, weight};

/// The covariance of the frames of all robots, in shifts, turns and scales about the frames that were found.
#[derive(Clone, Debug, PartialEq)]
pub struct FrameCovariance {
    frames: Vec<Option<FrameChange>>,
    lengths: Lengths,
    matrix: DMatrix<f64>,
}

/// How far observations are from each other, and how far they are expected to be.
#[derive(Clone, Copy, Debug, Default)]
struct Residuals {
    /// Weighted sum of the squares of the distances from the middle of each node, seen from above.
    found: f64,
    /// What the covariances of the maps let expect of it if all frames were known.
    expected: f64,
    /// Number of independent residuals along an axis.
    degrees: usize,
}

impl FrameCovariance {
    /// That of the frames of `graph`; `None` if its nodes do not tell the frames.
    ///
    /// The frames are weighted least squares over the shared nodes: their error is `N⁻¹ Σ w Dᵀ ε` with the normal matrix N, the
    /// weight w and the error ε of each place, and D, by which it differs from the middle of its node as the frames move. So the
    /// covariance is `N⁻¹ (Σ w² Dᵀ R D) N⁻¹`, where R is the covariance of the place on the map of its robot. If the residuals
    /// are larger than R lets expect, it is enlarged as they are; if the maps claim no covariances, the residuals alone tell it.
    pub(super) fn of(graph: &PoseGraph) -> Option<Self> {
        let mut scatter = DMatrix::zeros(graph.size(), graph.size());
        let mut residuals = Residuals::default();
        for node in &graph.nodes {
            let Some((middle, total)) = graph.middle(node) else { continue };
            let errors: Vec<Matrix3<f64>> = node.iter().map(|seen| graph.covariance_of(seen)).collect();
            // How the place of observation `a` counts in the residual of `b`.
            let share = |a: usize, b: usize| f64::from(u8::from(a == b)) - weight(&node[b]) / total;
            graph.add(&mut scatter, node, |b, c| {
                let of = |a: usize| errors[a] * (weight(&node[a]).powi(2) * share(a, b) * share(a, c));
                (0..node.len()).map(of).sum()
            });
            residuals.take(graph, node, middle, |a| {
                (0..node.len()).map(|b| share(a, b).powi(2) * (errors[b][(0, 0)] + errors[b][(1, 1)])).sum()
            });
        }
        let frames = graph.frames.iter().skip(1).flatten().count();
        let inflation = residuals.inflation(frames * (graph.lengths.unknowns() - 1));
        let inflation = if graph.has_claims() { inflation.max(1.0) } else { inflation };
        let inverse = graph.normal_matrix().cholesky()?.inverse();
        let matrix = &inverse * scatter * &inverse * inflation;
        Some(Self { frames: graph.frames.clone(), lengths: graph.lengths, matrix })
    }

    /// What the frames of robots add to the covariance (m²) of a node at `place` in the frame of the map, if each robot of
    /// `shares` tells this share of it.
    ///
    /// The place follows a frame by the share that its robot tells. Least squares of frames and places together have this sum of
    /// two covariances: of the place if the frames were exact, and of what their errors move it (Schur's complement).
    #[must_use]
    pub fn of_place(&self, place: Position, shares: &[(usize, f64)]) -> [[f64; 3]; 3] {
        let mut sum = Matrix3::zeros();
        for &(a, own) in shares {
            for &(b, other) in shares {
                sum += self.between(place, [a, b]) * (own * other);
            }
        }
        std::array::from_fn(|row| std::array::from_fn(|column| sum[(row, column)]))
    }

    /// The covariance of the displacements of `place` by the frames of two robots.
    fn between(&self, place: Position, robots: [usize; 2]) -> Matrix3<f64> {
        let [Some((rows, of_rows)), Some((columns, of_columns))] = robots.map(|robot| self.slopes(place, robot))
        else {
            return Matrix3::zeros();
        };
        let mut sum = Matrix3::zeros();
        for (i, row) in of_rows.iter().enumerate() {
            for (j, column) in of_columns.iter().enumerate() {
                sum += row * column.transpose() * self.matrix[(rows + i, columns + j)];
            }
        }
        sum
    }

    /// Where the unknowns of the frame of `robot` begin, and how `place` changes with each; `None` if it has none.
    fn slopes(&self, place: Position, robot: usize) -> Option<(usize, Vec<Vector3<f64>>)> {
        let first = self.lengths.first_of(robot)?;
        let frame = (*self.frames.get(robot)?)?;
        Some((first, frame.slopes(vector(place), self.lengths)))
    }
}

impl Residuals {
    /// Takes the residuals of a node from its `middle`. Before the frames were fitted, `expected` of each observation was
    /// the square to expect.
    fn take(
        &mut self,
        graph: &PoseGraph,
        node: &[Observation],
        middle: Vector3<f64>,
        expected: impl Fn(usize) -> f64,
    ) {
        let mut trusted = 0_usize;
        for (a, seen) in node.iter().enumerate().filter(|(_, seen)| weight(seen) > 0.0) {
            let apart = graph.seen_at(seen) - middle;
            self.found += weight(seen) * (apart.x * apart.x + apart.y * apart.y);
            self.expected += weight(seen) * expected(a);
            trusted += 1;
        }
        self.degrees += 2 * trusted.saturating_sub(1);
    }

    /// By which factor the squares of the residuals are larger than expected, of a fit with so many parameters.
    fn inflation(&self, parameters: usize) -> f64 {
        if self.degrees <= parameters || self.expected <= 0.0 {
            return 1.0;
        }
        let left = (self.degrees - parameters) as f64 / self.degrees as f64;
        self.found / (self.expected * left)
    }
}
