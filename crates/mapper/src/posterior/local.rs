//! The posterior of one node near a known place.

use sextant_channel::Position;
use sextant_kernel::maths::exp;

use super::Cell;
use crate::log_facts::heights::Heights;
use crate::posterior::estimate::Estimate;
use crate::posterior::estimate_kind::EstimateKind;

/// Places with their posterior probabilities, and how far they spread.
#[derive(Clone, Debug)]
pub(crate) struct LocalPosterior {
    /// Places (m) with probabilities that sum to 1.
    pub(crate) places: Vec<(Position, f64)>,
    /// Their mean (m).
    pub(crate) mean: Position,
    /// Standard deviation along each axis (m).
    pub(crate) spread_m: [f64; 3],
    /// What each place stands for.
    cell: Cell,
}

impl LocalPosterior {
    /// The likeliest place.
    pub(crate) fn likeliest(&self) -> Position {
        self.places.iter().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(self.mean, |&(place, _)| place)
    }

    /// The estimate, where the likeliest place has this log-likelihood.
    pub(crate) fn estimate(&self, kind: EstimateKind, likeliest: (Position, f64)) -> Estimate {
        Estimate::of_places(kind, &self.places, self.cell, self.mean, likeliest)
    }
}

/// Steps from the middle of the grid to its edge.
const PLANAR_REACH: i32 = 4;
const SPATIAL_REACH: i32 = 3;
/// Maximum number of times that the grid is adapted to the posterior.
const FITS: usize = 20;
/// Offset of the vertices from the middle of the grid, in steps, so that no true place is on a vertex.
const PHASE: [f64; 3] = [0.118, -0.264, 0.354];
/// The grid is too small if the probability at its edge is above this.
const EDGE: f64 = 0.03;
/// The grid is too coarse if its step is more than this times the spread.
const COARSE: f64 = 1.4;

/// The posterior, for a uniform prior, on a grid round `start` that is moved, widened and refined until it holds all
/// but a few hundredths of the probability in steps of about its spread, which for smooth likelihoods gives its
/// moments to a thousandth. `spread_m` is a first guess of the spread; steps do not fall below `least_step_m`. `None`
/// if the likelihood is zero at all places that were tried.
pub(crate) fn local_posterior(
    heights: Heights,
    start: Position,
    spread_m: [f64; 3],
    least_step_m: f64,
    log_likelihood: &impl Fn(Position) -> f64,
) -> Option<LocalPosterior> {
    let reach = if matches!(heights, Heights::Level(_)) { PLANAR_REACH } else { SPATIAL_REACH };
    let mut centre = start;
    let mut steps = spread_m.map(|spread| (3.0 * spread / f64::from(reach)).max(least_step_m));
    let mut found: Option<LocalPosterior> = None;
    for _ in 0..FITS {
        let grid = LocalGrid { heights, reach, centre, steps };
        let Some((posterior, edge)) = grid.posterior(log_likelihood) else {
            if steps.iter().all(|&step| step <= least_step_m) {
                break;
            }
            steps = steps.map(|step| (0.5 * step).max(least_step_m));
            continue;
        };
        centre = posterior.mean;
        let mut fits = true;
        for axis in 0..if reach == PLANAR_REACH { 2 } else { 3 } {
            if edge[axis] > EDGE {
                steps[axis] *= 1.6;
                fits = false;
            } else if steps[axis] > least_step_m && steps[axis] > COARSE * posterior.spread_m[axis] {
                steps[axis] = (0.5 * steps[axis]).max(least_step_m);
                fits = false;
            }
        }
        found = Some(posterior);
        if fits {
            break;
        }
    }
    found
}

/// A box of vertices.
struct LocalGrid {
    heights: Heights,
    reach: i32,
    centre: Position,
    steps: [f64; 3],
}

impl LocalGrid {
    /// The posterior on the vertices, and the probability at the two ends of each axis.
    fn posterior(&self, log_likelihood: &impl Fn(Position) -> f64) -> Option<(LocalPosterior, [f64; 3])> {
        let offset = |axis: usize, i: i32| (f64::from(i) + PHASE[axis]) * self.steps[axis];
        let layers = if matches!(self.heights, Heights::Level(_)) { 0..=0 } else { -self.reach..=self.reach };
        let mut places: Vec<(Position, f64)> = Vec::new();
        let mut at_edge: Vec<[bool; 3]> = Vec::new();
        let mut highest = f64::NEG_INFINITY;
        for k in layers {
            let z_m = match self.heights {
                Heights::Level(z_m) => z_m,
                Heights::Between(low, high) => {
                    let z_m = self.centre.z_m + offset(2, k);
                    if z_m < low || z_m > high {
                        continue;
                    }
                    z_m
                }
            };
            for j in -self.reach..=self.reach {
                for i in -self.reach..=self.reach {
                    let place = Position::new(self.centre.x_m + offset(0, i), self.centre.y_m + offset(1, j), z_m);
                    let value = log_likelihood(place);
                    highest = highest.max(value);
                    places.push((place, value));
                    at_edge.push([i, j, k].map(|index| index.abs() == self.reach));
                }
            }
        }
        if highest <= f64::NEG_INFINITY {
            return None;
        }
        let mut total = 0.0;
        for (_, value) in &mut places {
            *value = exp(*value - highest);
            total += *value;
        }
        let (mut edge, mut sum, mut squares) = ([0.0; 3], [0.0; 3], [0.0; 3]);
        for ((place, weight), at_edge) in places.iter_mut().zip(at_edge) {
            *weight /= total;
            let apart: [f64; 3] = (*place - self.centre).into();
            for axis in 0..3 {
                sum[axis] += *weight * apart[axis];
                squares[axis] += *weight * apart[axis] * apart[axis];
                edge[axis] += if at_edge[axis] { *weight } else { 0.0 };
            }
        }
        places.retain(|&(_, weight)| weight > 1e-6);
        let mean = self.centre + Position::new(sum[0], sum[1], sum[2]);
        let spread_m = [0, 1, 2].map(|axis| (squares[axis] - sum[axis] * sum[axis]).max(0.0).sqrt());
        let [x_m, y_m, z_m] = self.steps;
        let cell = Cell::new([x_m, y_m, if matches!(self.heights, Heights::Level(_)) { 0.0 } else { z_m }]);
        Some((LocalPosterior { places, mean, spread_m, cell }, edge))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_normal_law_is_found_from_afar_with_its_moments() {
        let (middle, sigma) = (Position::new(3.0, -2.0, 1.0), [0.1, 0.7, 2.0]);
        let log_likelihood = |place: Position| {
            let apart: [f64; 3] = (place - middle).into();
            -0.5 * (0..3).map(|axis| (apart[axis] / sigma[axis]).powi(2)).sum::<f64>()
        };
        let heights = Heights::Between(f64::NEG_INFINITY, f64::INFINITY);
        let found = local_posterior(heights, Position::ORIGIN, [1.0; 3], 1e-3, &log_likelihood).unwrap();
        assert!(found.mean.distance_m(middle) < 0.05, "{:?}", found.mean);
        for (spread, sigma) in found.spread_m.into_iter().zip(sigma) {
            assert!((spread / sigma - 1.0).abs() < 0.05, "{:?}", found.spread_m);
        }
        let level = local_posterior(Heights::Level(0.5), Position::ORIGIN, [1.0; 3], 1e-3, &log_likelihood).unwrap();
        assert!((level.mean.z_m - 0.5).abs() < 1e-12 && level.mean.distance_m(middle) < 0.55);
    }

    #[test]
    fn a_small_hole_in_impossibility_is_found() {
        let inside = |place: Position| if place.length_m() < 0.2 { 0.0 } else { f64::NEG_INFINITY };
        let found = local_posterior(Heights::Level(0.0), Position::ORIGIN, [2.0; 3], 1e-3, &inside).unwrap();
        // A disc of radius 0.2 m has a standard deviation of 0.1 m along each axis.
        assert!((found.spread_m[0] - 0.1).abs() < 0.01, "{:?}", found.spread_m);
        let nowhere = |_: Position| f64::NEG_INFINITY;
        assert!(local_posterior(Heights::Level(0.0), Position::ORIGIN, [2.0; 3], 1e-3, &nowhere).is_none());
    }
}
