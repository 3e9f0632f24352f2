//! The search under a likelihood that knows how uncertain anchors are.

use std::cell::Cell;
use std::f64::consts::{FRAC_PI_2, PI};

use sextant_channel::Position;

use super::OwnEstimate;
use super::evidence::{AnchorEvidence, KnownAnchor, LogProduct, Sector};
use super::octets;
use super::search_set::SearchSet;
use crate::grid_ml::directions::{CONTRADICTED, wrapped};
use crate::grid_ml::findings::Findings;
use crate::grid_ml::solver::{Moments, Peak};
use crate::posterior::{Estimate, EstimateKind, TieRule, covariance, local_posterior};

/// Number of vertices of the coarse grid.
const COARSE: u64 = 600;
/// The coarse step is at most this share of the range.
const COARSEST: f64 = 0.25;
/// How many standard deviations of an anchor's place its range is extended.
const DEVIATIONS: f64 = 2.0;
/// Standard deviation at which a normal density at its mean is that of a uniform law on the circle, or on the half-circle
/// of elevations (rad): more is not known worse than that.
const UNKNOWN_AZIMUTH_RAD: f64 = 2.506_628_274_631_000_5;
const UNKNOWN_ELEVATION_RAD: f64 = 0.5 * UNKNOWN_AZIMUTH_RAD;

/// The estimate; `None` if no vertex is within the range of an anchor.
pub(super) fn estimate(evidence: &AnchorEvidence<'_>, kind: EstimateKind) -> Option<OwnEstimate> {
    let lattice = &evidence.lattice;
    let balls =
        || evidence.heard.iter().map(|anchor| (anchor.place, evidence.curve.range_m + DEVIATIONS * anchor.sigma_m));
    let set = SearchSet::intersection(lattice, balls()).unwrap_or_else(|| SearchSet::union(lattice, balls()));
    let search = SoftSearch { evidence, highest: Cell::new(f64::NEG_INFINITY), vertices: Cell::new(0) };
    let mut coarse = Findings::new(EstimateKind::PosteriorMean, lattice);
    let stride = stride(evidence, &set);
    set.each(stride, |vertex| {
        let place = lattice.position(vertex);
        if let Some(value) = search.log_likelihood(place, Moments::NEGLIGIBLE) {
            coarse.take(lattice.index(vertex), place, value);
        }
    });
    let (mut estimate, of_result) = match kind {
        EstimateKind::Argmax => {
            let mut findings = Findings::new(kind, lattice);
            set.each(1, |vertex| {
                let place = lattice.position(vertex);
                if let Some(value) = search.log_likelihood(place, Peak::TOLERANCE) {
                    findings.take(lattice.index(vertex), place, value);
                }
            });
            let estimate = findings.estimate(lattice, TieRule::Mean, false)?;
            let of_result = octets::of_peak(estimate.ties);
            (estimate, of_result)
        }
        EstimateKind::PosteriorMean => search.mean(&coarse, stride)?,
    };
    let violations = evidence.violations(estimate.position);
    estimate.infeasible = violations > 0;
    let peak_octets = octets::of_evidence(evidence) + of_result;
    Some(OwnEstimate { estimate, violations, vertices: search.vertices.get(), peak_octets })
}

/// The distance of the coarse grid's vertices, in steps of the lattice.
fn stride(evidence: &AnchorEvidence<'_>, set: &SearchSet) -> usize {
    let widest = (COARSEST * evidence.curve.range_m / evidence.lattice.step_m()).floor();
    let mut stride = 1;
    while set.len(stride) > COARSE && ((stride + 1) as f64) <= widest {
        stride += 1;
    }
    stride
}

struct SoftSearch<'e> {
    evidence: &'e AnchorEvidence<'e>,
    /// The highest log-likelihood so far.
    highest: Cell<f64>,
    vertices: Cell<u64>,
}

impl SoftSearch<'_> {
    /// The posterior mean with its covariance, and the octets that a node needs for it: on a grid that follows the
    /// posterior from the mean of the coarse one.
    fn mean(&self, coarse: &Findings, stride: usize) -> Option<(Estimate, usize)> {
        let AnchorEvidence { lattice, heights, .. } = self.evidence;
        let moments = coarse.moments.as_ref().filter(|_| coarse.peak.highest() > f64::NEG_INFINITY)?;
        let spread = moments.covariance();
        let least_m = 0.5 * lattice.step_m();
        let cell_m = stride as f64 * lattice.step_m() / 12.0_f64.sqrt();
        let spread_m = [0, 1, 2].map(|axis| spread[axis][axis].sqrt().max(cell_m));
        let value = |place| self.log_likelihood(place, Moments::NEGLIGIBLE).unwrap_or(f64::NEG_INFINITY);
        let found = local_posterior(*heights, moments.mean(), spread_m, least_m, &value);
        let (position, covariance, vertices) = match &found {
            Some(found) => {
                let places = found.places.iter().map(|&(place, weight)| (place - found.mean, weight));
                (found.mean, covariance(places), found.places.len())
            }
            None => (moments.mean(), spread, 0),
        };
        let log_likelihood = self.value(position, f64::NEG_INFINITY);
        let estimate = Estimate {
            position,
            log_likelihood,
            ties: 1,
            covariance: Some(covariance),
            infeasible: false,
            concern: None,
        };
        Some((estimate, octets::of_moments() + octets::of_grid(vertices)))
    }

    /// The log-likelihood of a place; `None` if it is certainly more than `margin` below the highest so far.
    fn log_likelihood(&self, place: Position, margin: f64) -> Option<f64> {
        self.vertices.set(self.vertices.get() + 1);
        let value = self.value(place, self.highest.get() - margin)?;
        self.highest.set(self.highest.get().max(value));
        Some(value)
    }

    /// The log-likelihood of a place; `None` if it is certainly below `least`.
    fn value(&self, place: Position, least: f64) -> Option<f64> {
        let AnchorEvidence { clamped, heard, .. } = self.evidence;
        let exp_least = libm::exp(least);
        let mut product = LogProduct::default();
        for anchor in heard {
            let line = AnchorLine::new(anchor, place);
            product.multiply(self.reception(&line, anchor), anchor.packets);
            if let Some(sector) = &anchor.sector {
                product.multiply(self.direction(&line, anchor, sector), 1);
            }
            if product.is_below(least, exp_least) {
                return None;
            }
        }
        let value = product.times(self.evidence.missed(clamped, place)).ln();
        (value >= least).then_some(value)
    }

    /// S(d), averaged over the place of the anchor along the line: Gauss–Hermite quadrature with three points.
    fn reception(&self, line: &AnchorLine, anchor: &KnownAnchor) -> f64 {
        let curve = self.evidence.clamped;
        let Some(covariance) = &anchor.covariance else {
            return curve.at(line.distance_m * line.distance_m);
        };
        let apart_m = (3.0 * variance_along(covariance, line.along)).sqrt();
        let at = |distance_m: f64| curve.at(distance_m * distance_m);
        (at(line.distance_m - apart_m) + 4.0 * at(line.distance_m) + at(line.distance_m + apart_m)) / 6.0
    }

    /// Probability that a node in the direction of the line names the sector.
    fn direction(&self, line: &AnchorLine, anchor: &KnownAnchor, sector: &Sector) -> f64 {
        // A vertex stands for its cell.
        let cell = self.evidence.lattice.step_m() * self.evidence.lattice.step_m() / 12.0;
        let variance_across = |direction| {
            cell + anchor.covariance.as_ref().map_or(0.0, |covariance| variance_along(covariance, direction))
        };
        let normal = self.evidence.normal;
        let wedge = &sector.wedge;
        let half = 0.5 * wedge.azimuth_width_rad;
        let in_azimuth = if half >= PI {
            1.0
        } else {
            let off = wrapped(libm::atan2(line.apart.y_m, line.apart.x_m) - wedge.azimuth_from_rad - half).abs();
            let of_places = variance_across(line.left) / line.across_square;
            let own = sector.azimuth_sigma_rad;
            let sigma = (of_places + own * own).sqrt().min(UNKNOWN_AZIMUTH_RAD);
            normal.below((half - off) / sigma) - normal.below((-half - off) / sigma)
        };
        let [low, high] = wedge.elevation_rad;
        let in_elevation = if low <= -FRAC_PI_2 && high >= FRAC_PI_2 {
            1.0
        } else {
            let elevation = libm::atan2(line.apart.z_m, line.across_square.sqrt());
            let square = line.distance_m * line.distance_m;
            let sigma = (variance_across(line.up) / square).sqrt().min(UNKNOWN_ELEVATION_RAD);
            let below = |edge: f64| normal.below((edge - elevation) / sigma);
            // Nothing is beyond the vertical.
            let above_low = if low <= -FRAC_PI_2 { 0.0 } else { below(low) };
            let below_high = if high >= FRAC_PI_2 { 1.0 } else { below(high) };
            below_high - above_low
        };
        CONTRADICTED + (1.0 - CONTRADICTED) * (in_azimuth * in_elevation).max(0.0)
    }
}

/// The line from an anchor to a place, with unit vectors along it, to its left and upwards across it.
struct AnchorLine {
    apart: Position,
    distance_m: f64,
    /// Square of the horizontal distance (m²).
    across_square: f64,
    along: [f64; 3],
    left: [f64; 3],
    up: [f64; 3],
}

impl AnchorLine {
    fn new(anchor: &KnownAnchor, place: Position) -> Self {
        // So short a line has any direction.
        const SHORT_M: f64 = 1e-9;
        let apart = place - anchor.place;
        let across_square = (apart.x_m * apart.x_m + apart.y_m * apart.y_m).max(SHORT_M * SHORT_M);
        let across_m = across_square.sqrt();
        let distance_m = (across_square + apart.z_m * apart.z_m).sqrt();
        let (cos, sin) = (apart.x_m / across_m, apart.y_m / across_m);
        let (level, rise) = (across_m / distance_m, apart.z_m / distance_m);
        Self {
            apart,
            distance_m,
            across_square,
            along: [level * cos, level * sin, rise],
            left: [-sin, cos, 0.0],
            up: [-rise * cos, -rise * sin, level],
        }
    }
}

/// Variance along a unit vector.
fn variance_along(covariance: &[[f64; 3]; 3], direction: [f64; 3]) -> f64 {
    let mut sum = 0.0;
    for (row, a) in covariance.iter().zip(direction) {
        for (entry, b) in row.iter().zip(direction) {
            sum += a * entry * b;
        }
    }
    sum.max(0.0)
}
