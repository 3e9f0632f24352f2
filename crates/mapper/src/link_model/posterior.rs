//! Where a node is, after what was heard.

use sextant_channel::Position;
use sextant_kernel::maths::exp_each;

use super::cavity::{ExpectedMargin, KnownMargin, conditioned};
use super::geometry::{Arrangement, Columns, MeanSquare};
use super::hearing::Hearing;
use super::law::Law;
use super::likelihood::MarginSums;
use super::links::{HeardLink, NodeLinks, PlaceLinks};
use super::outages::{NodeAndPlace, Outages};
use super::site::{Site, silence_of_living};
use super::window::{Bounds, LinkWindow};
use crate::posterior::Cell;

/// Distances are at least this share of the step of the grid, because a vertex stands for its cell.
const NEAREST: f64 = 0.35;
/// The fine grid spans so many standard deviations on each side.
const SPREADS: f64 = 3.2;
/// Sites before anything is known of the place: prediction and spread of a margin.
pub(super) const UNKNOWN: [f64; 2] = [0.0, 3.0];
/// A site with less than this variance tells something of its margin.
const TELLING: f64 = 10.0;
/// Vertices with at least this share of a posterior tell what margins are expected.
const LIKELY: f64 = 1e-3;
/// A vertex with less than this share of the likeliest one is left out of a grid round a posterior: e to the power of -20.
const NEGLIGIBLE: f64 = 2e-9;
/// Least spread of a prediction.
pub(super) const LEAST_SPREAD: f64 = 0.3;

/// What was heard of a node, ready to be weighed.
#[derive(Clone, Debug)]
pub(super) struct HeardLinks<'a> {
    node: &'a NodeLinks,
    links: Vec<HeardLink>,
    /// Whether silence is expected by the other links of the node, and not by its place alone.
    doubts_silence: bool,
    arrangement: Arrangement,
    /// In the order of the arrangement.
    places: Vec<Position>,
    bounds: Bounds,
    /// In the order of the links.
    pub(super) sites: Vec<Site>,
}

/// A grid of vertices and the densities before anything is heard.
#[derive(Clone, Debug)]
pub(super) struct PriorGrid {
    pub(super) vertices: Vec<Position>,
    pub(super) step_m: f64,
    log_densities: Vec<f64>,
    /// Logarithm of the sum of the densities.
    log_total: f64,
    columns: Columns,
}

impl PriorGrid {
    fn new(vertices: Vec<Position>, step_m: f64, log_densities: Vec<f64>, columns: Columns) -> Self {
        let log_total = log_sum(&log_densities);
        Self { vertices, step_m, log_densities, log_total, columns }
    }

    /// The logarithm of the density of each vertex before anything was heard, and of its likelihood, but for a constant.
    pub(super) fn logarithms(&self, posterior: &GridPosterior) -> impl Iterator<Item = (f64, f64)> {
        self.log_densities.iter().zip(&posterior.shares).map(|(&before, &share)| (before, libm::log(share) - before))
    }
}

/// A posterior on a grid.
#[derive(Clone, Debug)]
pub(super) struct GridPosterior {
    pub(super) mean: Position,
    pub(super) covariance: [[f64; 3]; 3],
    /// Highest logarithm of a likelihood.
    pub(super) highest: f64,
    /// The share of each vertex.
    pub(super) shares: Vec<f64>,
}

impl<'a> HeardLinks<'a> {
    /// Those of `node`, to be weighed by laws whose links share something, or by laws of independent links alone.
    pub(super) fn new(
        node: &'a NodeLinks,
        links: &PlaceLinks,
        window: &LinkWindow<'_>,
        (hearing, outages): (&Hearing, &Outages),
        share: bool,
    ) -> Self {
        let arrangement = Arrangement::of(&node.links, &links.places, share);
        let places = arrangement.order.iter().map(|&link| links.places[node.links[link].place]).collect();
        let own = node.links.iter().map(|link| HeardLink { outage: outages.of_log, ..*link });
        let links: Vec<HeardLink> = own.collect();
        let sites = links.iter().map(|link| Site::of(link, hearing, UNKNOWN[0], UNKNOWN[1])).collect();
        Self {
            node,
            links,
            doubts_silence: outages.are_frequent(),
            arrangement,
            places,
            bounds: window.of(node),
            sites,
        }
    }

    pub(super) fn node(&self) -> &'a NodeLinks {
        self.node
    }

    /// A grid of about `count` vertices over all places where the node can be.
    pub(super) fn grid(&self, window: &LinkWindow<'_>, count: f64) -> PriorGrid {
        self.grid_in(&self.bounds, window, count)
    }

    /// A grid of about `count` vertices round a posterior.
    pub(super) fn fine_grid(
        &self,
        window: &LinkWindow<'_>,
        coarse: &PriorGrid,
        posterior: &GridPosterior,
        count: f64,
    ) -> PriorGrid {
        let least_m = 1.2 * coarse.step_m;
        let half = [0, 1, 2].map(|axis| (SPREADS * posterior.covariance[axis][axis].sqrt()).max(least_m));
        self.grid_in(&self.bounds.round(posterior.mean, half), window, count)
    }

    /// The grid of about `count` vertices over all places that may be, with about as many more round a posterior on it.
    pub(super) fn mixed_grid(
        &self,
        window: &LinkWindow<'_>,
        coarse: &PriorGrid,
        posterior: &GridPosterior,
        count: f64,
    ) -> PriorGrid {
        let half = [0, 1, 2].map(|axis| SPREADS * posterior.covariance[axis][axis].sqrt());
        let part = self.bounds.cells_round(count, posterior.mean, half);
        let (fine, step_m) = part.vertices(count);
        if step_m > 0.7 * coarse.step_m {
            return coarse.clone();
        }
        let least = NEGLIGIBLE * posterior.shares.iter().copied().fold(0.0, f64::max);
        let outside = coarse.vertices.iter().zip(&posterior.shares);
        let outside = outside.filter(|&(&vertex, &share)| share > least && !part.contains(vertex));
        let mut vertices: Vec<Position> = fine.clone();
        vertices.extend(outside.map(|(&vertex, _)| vertex));
        // A vertex has the weight of its cell.
        let dimensions = if window.heights()[1] > window.heights()[0] { 3.0 } else { 2.0 };
        let larger = dimensions * libm::log(coarse.step_m / step_m);
        let is_fine = |number: usize| number < fine.len();
        let log_density = |(number, &vertex): (usize, &Position)| {
            window.log_density(vertex) + if is_fine(number) { 0.0 } else { larger }
        };
        let log_densities = vertices.iter().enumerate().map(log_density).collect();
        let least_m = |number: usize| NEAREST * if is_fine(number) { step_m } else { coarse.step_m };
        let columns = Columns::new(&vertices, &self.places, least_m);
        PriorGrid::new(vertices, step_m, log_densities, columns)
    }

    fn grid_in(&self, bounds: &Bounds, window: &LinkWindow<'_>, count: f64) -> PriorGrid {
        let (vertices, step_m) = bounds.vertices(count);
        let log_densities = vertices.iter().map(|&vertex| window.log_density(vertex)).collect();
        let columns = Columns::new(&vertices, &self.places, |_| NEAREST * step_m);
        PriorGrid::new(vertices, step_m, log_densities, columns)
    }

    /// A grid of about `count` vertices over all places within reach, of which none is likelier than others.
    pub(super) fn even_grid(&self, window: &LinkWindow<'_>, count: f64) -> PriorGrid {
        let (vertices, step_m) = window.within_reach(self.node).vertices(count);
        let columns = Columns::new(&vertices, &self.places, |_| NEAREST * step_m);
        let log_densities = vec![0.0; vertices.len()];
        PriorGrid::new(vertices, step_m, log_densities, columns)
    }

    /// The posterior on `grid` under laws whose margins are higher than that of `law` by numbers with logarithms of weights.
    pub(super) fn posterior_of_levels(&self, law: &Law, grid: &PriorGrid, levels: &[(f64, f64)]) -> GridPosterior {
        let sums = self.sums(law, grid);
        let mut each: Vec<Vec<f64>> = Vec::with_capacity(levels.len());
        for &(higher, log_weight) in levels {
            let mut logs = Vec::new();
            sums.log_likelihoods(&Law { margin: law.margin + higher, ..*law }, &mut logs);
            logs.truncate(grid.vertices.len());
            logs.iter_mut().for_each(|log| *log += log_weight);
            each.push(logs);
        }
        let logs: Vec<f64> = (0..grid.vertices.len())
            .map(|vertex| {
                log_sum(&each.iter().map(|logs| logs[vertex]).collect::<Vec<_>>()) + grid.log_densities[vertex]
            })
            .collect();
        let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let shares = normalised(&logs);
        let (mean, covariance) = moments(&grid.vertices, &shares, grid.step_m);
        GridPosterior { mean, covariance, highest, shares }
    }

    /// The posterior on `grid` under `law`. `scratch` is memory to use.
    pub(super) fn posterior(&self, law: &Law, grid: &PriorGrid, scratch: &mut Vec<f64>) -> GridPosterior {
        self.sums(law, grid).log_likelihoods(law, scratch);
        scratch.truncate(grid.vertices.len());
        let highest = scratch.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        for (log, density) in scratch.iter_mut().zip(&grid.log_densities) {
            *log += density;
        }
        let shares = normalised(scratch);
        let (mean, covariance) = moments(&grid.vertices, &shares, grid.step_m);
        GridPosterior { mean, covariance, highest, shares }
    }

    /// The sums of the likelihood on `grid` under `law`.
    pub(super) fn sums(&self, law: &Law, grid: &PriorGrid) -> MarginSums {
        MarginSums::of(law, &self.arrangement, &self.sites, &grid.columns)
    }

    /// The same under another law, where `sums` are those under one.
    pub(super) fn sums_under(&self, law: &Law, grid: &PriorGrid, sums: &MarginSums) -> MarginSums {
        sums.under(law, &self.arrangement, &self.sites, &grid.columns)
    }

    /// Approximates the links where their margins are expected.
    pub(super) fn refine(&mut self, law: &Law, expected: ExpectedMargins, links: &PlaceLinks, hearing: &Hearing) {
        let spread = law.spread().max(LEAST_SPREAD);
        let ExpectedMargins { by_place, by_others } = expected;
        let expected = match by_others {
            Some(by_others) if self.doubts_silence => by_others,
            None if self.doubts_silence => self.expected_by_others(law, &by_place, links),
            _ => by_place,
        };
        for ((site, link), expected) in self.sites.iter_mut().zip(&self.links).zip(expected) {
            let ExpectedMargin { margin, spread } =
                if link.received == 0 { expected } else { ExpectedMargin { spread, ..expected } };
            *site = Site::of(link, hearing, margin, spread.max(LEAST_SPREAD));
        }
    }

    /// What silence says of outages where the margins are `expected`.
    pub(super) fn pairs(&self, expected: &ExpectedMargins, hearing: &Hearing) -> Vec<NodeAndPlace> {
        let pair = |(link, ExpectedMargin { margin, spread }): (&HeardLink, &ExpectedMargin)| {
            let silence = silence_of_living(link, hearing, *margin, *spread);
            NodeAndPlace { place: link.place, silence, is_silent: link.received == 0 }
        };
        self.links.iter().zip(expected.by_others.as_ref().unwrap_or(&expected.by_place)).map(pair).collect()
    }

    /// Sets how probable it is that each link is dead, where these are the `pairs` of the node.
    pub(super) fn set_outages(&mut self, outages: &Outages, pairs: &[NodeAndPlace]) {
        self.doubts_silence = outages.are_frequent();
        for (link, outage) in self.links.iter_mut().zip(outages.of_node(pairs)) {
            link.outage = outage;
        }
    }

    /// The margin of each link where the posterior places the node.
    pub(super) fn expected(
        &self,
        law: &Law,
        grid: &PriorGrid,
        posterior: &GridPosterior,
        links: &PlaceLinks,
    ) -> ExpectedMargins {
        let level = law.at_one_metre();
        let spread = law.spread().max(LEAST_SPREAD);
        let likely: Vec<f64> =
            posterior.shares.iter().map(|&share| if share > LIKELY { share } else { 0.0 }).collect();
        let total: f64 = likely.iter().sum();
        let mut by_place = vec![ExpectedMargin { margin: level, spread }; self.links.len()];
        for (MeanSquare { mean, square }, &link) in
            grid.columns.mean_logarithms(&likely).iter().zip(&self.arrangement.order)
        {
            let mean = mean / total;
            let variance = (square / total - mean * mean).max(0.0) * law.slope * law.slope;
            let spread = (spread * spread + variance).sqrt();
            by_place[link] = ExpectedMargin { margin: level - law.slope * mean, spread };
        }
        let by_others = self.doubts_silence.then(|| self.expected_by_others(law, &by_place, links));
        ExpectedMargins { by_place, by_others }
    }

    /// The margin of each link as its place tells; of a silent one, what the others tell of it.
    fn expected_by_others(&self, law: &Law, by_place: &[ExpectedMargin], links: &PlaceLinks) -> Vec<ExpectedMargin> {
        let known: Vec<KnownMargin> = (self.links.iter().zip(&self.sites).zip(by_place).enumerate())
            .filter(|(_, ((_, site), _))| site.variance < TELLING)
            .map(|(number, ((link, site), told))| KnownMargin {
                number,
                place: links.places[link.place],
                excess: site.margin - told.margin,
                variance: site.variance,
            })
            .collect();
        let each = self.links.iter().zip(by_place).enumerate().map(|(number, (link, &told))| {
            if link.received > 0 {
                return told;
            }
            conditioned(law, told, number, links.places[link.place], &known)
        });
        each.collect()
    }
}

/// The margin of each link where a posterior places the node.
#[derive(Clone, Debug)]
pub(super) struct ExpectedMargins {
    /// What the place tells.
    by_place: Vec<ExpectedMargin>,
    /// What the other links tell of silent ones, if silence is doubted.
    by_others: Option<Vec<ExpectedMargin>>,
}

/// Logarithm of the evidence of a law on `grid`, from the `sums` of its covariance. `scratch` is memory to use.
pub(super) fn log_evidence(law: &Law, grid: &PriorGrid, sums: &MarginSums, scratch: &mut Vec<f64>) -> f64 {
    sums.log_likelihoods(law, scratch);
    scratch.truncate(grid.vertices.len());
    for (log, density) in scratch.iter_mut().zip(&grid.log_densities) {
        *log += density;
    }
    log_sum(scratch) - grid.log_total
}

/// Logarithm of the sum of numbers that are given by their logarithms; 0 if all are 0.
fn log_sum(logs: &[f64]) -> f64 {
    let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if highest == f64::NEG_INFINITY {
        return 0.0;
    }
    let mut terms: Vec<f64> = logs.iter().map(|log| log - highest).collect();
    exp_each(&mut terms);
    highest + libm::log(terms.iter().sum())
}

/// The shares of densities that are given by their logarithms; equal shares if all are 0.
fn normalised(logs: &[f64]) -> Vec<f64> {
    let highest = logs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if highest == f64::NEG_INFINITY {
        return vec![1.0 / logs.len().max(1) as f64; logs.len()];
    }
    let mut shares: Vec<f64> = logs.iter().map(|log| log - highest).collect();
    exp_each(&mut shares);
    let total: f64 = shares.iter().sum();
    for share in &mut shares {
        *share /= total;
    }
    shares
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
    let cell = Cell::new(extent.map(|extent_m| if extent_m > 0.0 { step_m } else { 0.0 }));
    (mean, cell.spread(covariance))
}
