//! Where a node is, after what was heard.

use sextant_channel::Position;

use super::geometry::{Arrangement, Columns};
use super::law::Law;
use super::likelihood::log_likelihoods;
use super::links::{Links, NodeLinks};
use super::margin::{Receiver, Site};
use super::window::{Bounds, Window};

/// Distances are at least this share of the step of the grid, because a vertex stands for its cell.
const NEAREST: f64 = 0.35;
/// The fine grid spans so many standard deviations on each side.
const SPREADS: f64 = 3.2;
/// Sites before anything is known of the place: prediction and spread of a margin.
pub(super) const UNKNOWN: [f64; 2] = [0.0, 3.0];
/// Least spread of a prediction.
pub(super) const LEAST_SPREAD: f64 = 0.3;

/// What was heard of a node, ready to be weighed.
#[derive(Clone, Debug)]
pub(super) struct Evidence<'a> {
    node: &'a NodeLinks,
    arrangement: Arrangement,
    /// In the order of the arrangement.
    places: Vec<Position>,
    bounds: Bounds,
    /// In the order of the links.
    pub(super) sites: Vec<Site>,
}

/// A grid of vertices and the densities before anything is heard.
#[derive(Clone, Debug)]
pub(super) struct Grid {
    pub(super) vertices: Vec<Position>,
    pub(super) step_m: f64,
    log_densities: Vec<f64>,
    columns: Columns,
}

/// A posterior on a grid.
#[derive(Clone, Debug)]
pub(super) struct Posterior {
    pub(super) mean: Position,
    pub(super) covariance: [[f64; 3]; 3],
    /// Logarithm of the evidence.
    pub(super) evidence: f64,
    /// Highest logarithm of a likelihood.
    pub(super) highest: f64,
    /// The share of each vertex.
    pub(super) shares: Vec<f64>,
    /// Variance of x and y before anything was heard (m²).
    pub(super) prior_variance_m2: f64,
}

impl<'a> Evidence<'a> {
    pub(super) fn new(node: &'a NodeLinks, links: &Links, window: &Window<'_>, receiver: Option<&Receiver>) -> Self {
        let arrangement = Arrangement::of(&node.links, &links.places);
        let places = arrangement.order.iter().map(|&link| links.places[node.links[link].place]).collect();
        let sites = node.links.iter().map(|link| Site::of(link, receiver, UNKNOWN[0], UNKNOWN[1])).collect();
        Self { node, arrangement, places, bounds: window.of(node), sites }
    }

    pub(super) fn node(&self) -> &'a NodeLinks {
        self.node
    }

    /// A grid of about `count` vertices over all places where the node can be.
    pub(super) fn grid(&self, window: &Window<'_>, count: f64) -> Grid {
        self.grid_in(&self.bounds, window, count)
    }

    /// A grid of about `count` vertices round a posterior.
    pub(super) fn fine_grid(&self, window: &Window<'_>, coarse: &Grid, posterior: &Posterior, count: f64) -> Grid {
        let least_m = 1.2 * coarse.step_m;
        let half = [0, 1, 2].map(|axis| (SPREADS * posterior.covariance[axis][axis].sqrt()).max(least_m));
        self.grid_in(&self.bounds.round(posterior.mean, half), window, count)
    }

    fn grid_in(&self, bounds: &Bounds, window: &Window<'_>, count: f64) -> Grid {
        let (vertices, step_m) = bounds.vertices(count);
        let log_densities = vertices.iter().map(|&vertex| window.log_density(vertex)).collect();
        let columns = Columns::new(&vertices, &self.places, NEAREST * step_m);
        Grid { vertices, step_m, log_densities, columns }
    }

    /// The posterior on `grid` under `law`. `scratch` is memory to use.
    pub(super) fn posterior(&self, law: &Law, grid: &Grid, scratch: &mut Vec<f64>) -> Posterior {
        log_likelihoods(law, &self.arrangement, &self.sites, &grid.columns, scratch);
        scratch.truncate(grid.vertices.len());
        let highest = scratch.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let prior = normalised(&grid.log_densities);
        for (log, density) in scratch.iter_mut().zip(&grid.log_densities) {
            *log += density;
        }
        let posterior = normalised(scratch);
        let (mean, covariance) = moments(&grid.vertices, &posterior.shares, grid.step_m);
        let (_, before) = moments(&grid.vertices, &prior.shares, grid.step_m);
        Posterior {
            mean,
            covariance,
            evidence: posterior.log_total - prior.log_total,
            highest,
            shares: posterior.shares,
            prior_variance_m2: before[0][0] + before[1][1],
        }
    }

    /// Expects each margin where the posterior places the node, and approximates the links there.
    pub(super) fn refine(
        &mut self,
        law: &Law,
        grid: &Grid,
        posterior: &Posterior,
        links: &Links,
        receiver: Option<&Receiver>,
    ) {
        let level = law.at_one_metre();
        let spread = law.spread().max(LEAST_SPREAD);
        let likely: Vec<(Position, f64)> = grid
            .vertices
            .iter()
            .copied()
            .zip(posterior.shares.iter().copied())
            .filter(|&(_, share)| share > 1e-3)
            .collect();
        let total: f64 = likely.iter().map(|&(_, share)| share).sum();
        let least_m = NEAREST * grid.step_m;
        for (site, link) in self.sites.iter_mut().zip(&self.node.links) {
            let place = links.places[link.place];
            let logs = likely.iter().map(|&(vertex, share)| share * libm::log(vertex.distance_m(place).max(least_m)));
            let predicted = level - law.slope * logs.sum::<f64>() / total;
            *site = Site::of(link, receiver, predicted, spread);
        }
    }
}

struct Normalised {
    shares: Vec<f64>,
    log_total: f64,
}

fn normalised(logs: &[f64]) -> Normalised {
    let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if highest == f64::NEG_INFINITY {
        let share = 1.0 / logs.len().max(1) as f64;
        return Normalised { shares: vec![share; logs.len()], log_total: 0.0 };
    }
    let mut shares: Vec<f64> = logs.iter().map(|log| libm::exp(log - highest)).collect();
    let total: f64 = shares.iter().sum();
    for share in &mut shares {
        *share /= total;
    }
    Normalised { shares, log_total: highest + libm::log(total) }
}

/// Mean and covariance (m, m²); a vertex stands for a cell.
fn moments(vertices: &[Position], shares: &[f64], step_m: f64) -> (Position, [[f64; 3]; 3]) {
    let mean = vertices.iter().zip(shares).fold(Position::ORIGIN, |sum, (&vertex, &share)| sum + vertex * share);
    let mut covariance = [[0.0; 3]; 3];
    let [first, .., last] = vertices else { return (mean, covariance) };
    let extent: [f64; 3] = (*last - *first).into();
    for (&vertex, &share) in vertices.iter().zip(shares) {
        let error: [f64; 3] = (vertex - mean).into();
        for row in 0..3 {
            for column in 0..3 {
                covariance[row][column] += share * error[row] * error[column];
            }
        }
    }
    for (axis, extent_m) in extent.into_iter().enumerate() {
        if extent_m > 0.0 {
            covariance[axis][axis] += step_m * step_m / 12.0;
        }
    }
    (mean, covariance)
}
