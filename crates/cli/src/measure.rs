//! Where truth meets estimate: how good a map is.

use sextant_channel::Position;
use sextant_mapper::{
    ConnectivityError, Fit, NeighbourhoodRule, PositionError, Reflection, Region, Similarity, TopologyMap,
    connectivity_error,
};

use crate::scenario::MetricsConfig;
use crate::summary::{ConnectivitySummary, ErrorSummary, FittedProfileSummary, MapSummary};

/// What a map says of itself, without a look at the truth.
#[must_use]
pub fn outline(name: &str, map: &TopologyMap) -> MapSummary {
    MapSummary {
        name: (name != map.algorithm).then(|| name.to_owned()),
        algorithm: map.algorithm.to_owned(),
        mapped: map.mapped(),
        unmapped: map.unmapped(),
        ambiguous: Some(map.estimates.iter().flatten().filter(|estimate| estimate.ties > 1).count()),
        infeasible: Some(map.infeasible()),
        grid_step_m: map.grid_step_m,
        vertices_evaluated: (map.vertices_evaluated > 0).then_some(map.vertices_evaluated),
        ..MapSummary::default()
    }
}

/// What a map says of itself and, if the true place of each node is known, how far it is from the truth.
/// Connectivity is measured at each radius of `metrics`; a measure that the nodes do not allow (all in one place, say)
/// is absent.
#[must_use]
pub fn measure(name: &str, map: &TopologyMap, truth: Option<&[Position]>, metrics: &MetricsConfig) -> MapSummary {
    let Some(truth) = truth else {
        return outline(name, map);
    };
    let mapped = map.positions();
    let at_radius = |&radius_m: &f64| connectivity(truth, &mapped, radius_m);
    let connectivity_errors: Vec<_> = metrics.neighbourhood_m.iter().map(at_radius).collect();
    let first = connectivity_errors.first().copied().unwrap_or_default();
    MapSummary {
        position_error_m: PositionError::between(truth, &mapped).map(ErrorSummary::from),
        coverage_95: coverage_95(truth, map),
        aligned_error_m: aligned(truth, &mapped).map(ErrorSummary::from),
        connectivity_error: first.connectivity_error,
        false_neighbour_rate: first.false_neighbour_rate,
        connectivity_errors,
        ..outline(name, map)
    }
}

/// Share of the nodes with a 95 % region that are in it.
#[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
fn coverage_95(truth: &[Position], map: &TopologyMap) -> Option<f64> {
    let step_m = map.grid_step_m.unwrap_or(0.0);
    let regions = map.estimates.iter().map(|estimate| Region::of_95(estimate.as_ref()?, step_m));
    let inside: Vec<bool> =
        regions.zip(truth).filter_map(|(region, &truth)| region.map(|region| region.contains(truth))).collect();
    let count = inside.iter().filter(|&&inside| inside).count();
    (!inside.is_empty()).then(|| count as f64 / inside.len() as f64)
}

impl From<&Fit> for FittedProfileSummary {
    fn from(fit: &Fit) -> Self {
        let range_m = fit.curve.range_m();
        Self {
            rounds: fit.rounds,
            converged: fit.converged,
            range_m,
            probability: (0..8).map(|i| fit.curve.probability(range_m * f64::from(i) / 8.0)).collect(),
            dead_stops: fit.dead_stops.clone(),
            outliers: fit.outliers.len(),
        }
    }
}

/// The errors that are left after the similarity, reflection allowed, that brings the map closest to the truth.
fn aligned(truth: &[Position], mapped: &[Option<Position>]) -> Option<PositionError> {
    let pairs: Vec<_> =
        truth.iter().zip(mapped).filter_map(|(&truth, mapped)| mapped.map(|mapped| (mapped, truth))).collect();
    let similarity = Similarity::fit(&pairs, Reflection::Allowed).ok()?;
    let left: Vec<_> = pairs.iter().map(|&(mapped, truth)| similarity.apply(mapped).distance_m(truth)).collect();
    PositionError::of(&left)
}

fn connectivity(truth: &[Position], mapped: &[Option<Position>], radius_m: f64) -> ConnectivitySummary {
    let error = |rule| connectivity_error(truth, mapped, radius_m, rule).ok();
    let affine = error(NeighbourhoodRule::Affine);
    ConnectivitySummary {
        neighbourhood_m: radius_m,
        connectivity_error: affine.as_ref().map(ConnectivityError::connectivity_error),
        connectivity_error_end_points: error(NeighbourhoodRule::EndPoints).map(|e| e.connectivity_error()),
        connectivity_error_per_node: error(NeighbourhoodRule::PerNode).map(|e| e.connectivity_error()),
        false_neighbour_rate: affine.as_ref().map(ConnectivityError::false_neighbour_rate),
        symmetric_loss: affine.as_ref().map(ConnectivityError::symmetric_loss),
    }
}

impl From<PositionError> for ErrorSummary {
    fn from(PositionError { mean, median, p90, p95, max, .. }: PositionError) -> Self {
        Self { mean, median, p90, p95, max }
    }
}
