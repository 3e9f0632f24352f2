//! What estimators predict of stops that they did not use.

use sextant_channel::{Position, ReceptionLog, Stop};
use sextant_kernel::maths::{exp, ln};

use super::EstimatorFit;
use super::fall_of_strength::FallOfStrength;
use super::folds::{Fold, NodeAndStop};
use super::opinions::GainOfLaw;
use super::score::Predicted;
use crate::link_model::{LinkFit, Placed, Predictor};
use crate::numerics::normal::{below, quantile};
use crate::posterior::Estimate;
use crate::self_calibrated::Calibration;
use crate::topology_map::TopologyMap;

/// The nodes of a Gauss-Hermite rule along an axis, in standard deviations, and their weights.
const POINTS: [(f64, f64); 3] =
    [(-1.732_050_807_568_877_2, 1.0 / 6.0), (0.0, 2.0 / 3.0), (1.732_050_807_568_877_2, 1.0 / 6.0)];

/// Takes what an estimator of independent packets predicts of a fold: the places of `map`, and the curve of its `fit`.
/// Without a curve it predicts the usual share.
pub(super) fn independent(fold: &Fold<'_>, map: &TopologyMap, fit: Option<&EstimatorFit>, predicted: &mut Predicted) {
    let usual = fold.usual_share();
    let absorbed = |place, stop| match fit {
        Some(EstimatorFit::Calibration(Calibration { obstacles: Some(obstacles), .. })) => {
            obstacles.absorbed(place, stop)
        }
        _ => 0.0,
    };
    let strengths = FallOfStrength::of(fold, map, &absorbed);
    let shares = fit.map(|fit| PredictedShares::of(fit, usual));
    for (node, estimate) in map.estimates.iter().enumerate() {
        let points = estimate.as_ref().map(points);
        for pair in fold.pairs(node) {
            let share = match (&points, &shares) {
                (Some(points), Some(shares)) => {
                    points.iter().map(|&(place, weight)| weight * binomial(shares.at(place, &pair.stop), &pair)).sum()
                }
                _ => binomial(usual, &pair),
            };
            let density = pair.rssi_dbm.zip(strengths.as_ref()).map(|(rssi_dbm, strengths)| {
                let Some(points) = &points else { return strengths.density(None, rssi_dbm) };
                let each = points.iter().map(|&(place, weight)| {
                    let absorbed = absorbed(place, pair.stop.position);
                    weight * strengths.density(Some((node, place.distance_m(pair.stop.position), absorbed)), rssi_dbm)
                });
                each.sum()
            });
            predicted.take(node, share, pair.sent, density);
        }
    }
}

fn binomial(share: f64, pair: &NodeAndStop) -> f64 {
    let (received, sent) = (f64::from(pair.received), f64::from(pair.sent));
    let ways = libm::lgamma(sent + 1.0) - libm::lgamma(received + 1.0) - libm::lgamma(sent - received + 1.0);
    let share = share.clamp(1e-9, 1.0 - 1e-9);
    exp(ways + received * ln(share) + (sent - received) * ln(1.0 - share))
}

/// The shares of packets that an estimator predicts.
struct PredictedShares<'a> {
    fit: &'a EstimatorFit,
    /// The normal quantile of the share in each bin of a calibrated curve behind obstacles.
    scores: Vec<f64>,
    usual: f64,
}

impl<'a> PredictedShares<'a> {
    fn of(fit: &'a EstimatorFit, usual: f64) -> Self {
        let scores = match fit {
            EstimatorFit::Calibration(Calibration { curve: Some(curve), obstacles: Some(_), .. }) => {
                curve.probabilities().iter().map(|&clear| quantile(clear)).collect()
            }
            _ => Vec::new(),
        };
        Self { fit, scores, usual }
    }

    /// The share of packets that arrive over a link.
    fn at(&self, place: Position, stop: &Stop) -> f64 {
        let distance_m = place.distance_m(stop.position);
        match self.fit {
            EstimatorFit::Profile(profile) => profile.curve.probability(distance_m),
            EstimatorFit::Calibration(calibration) => {
                let Some(curve) = &calibration.curve else { return self.usual };
                match &calibration.obstacles {
                    Some(obstacles) => {
                        below(self.scores[curve.bin(distance_m)] - obstacles.absorbed(place, stop.position))
                    }
                    None => curve.probability(distance_m),
                }
            }
            EstimatorFit::Pattern(pattern) => pattern.probability(place, stop),
            EstimatorFit::Links(_) => self.usual,
        }
    }
}

/// Points that stand for the posterior of a node, with their weights.
fn points(estimate: &Estimate) -> Vec<(Position, f64)> {
    let covariance = estimate.covariance.unwrap_or_default();
    let flat = nalgebra::Matrix3::from_fn(|row, column| covariance[row][column]).symmetric_eigen();
    let axis = |k: usize| flat.eigenvectors.column(k) * flat.eigenvalues[k].max(0.0).sqrt();
    let axes = [axis(0), axis(1), axis(2)];
    let mut points = vec![(estimate.position, 1.0)];
    for axis in axes.iter().filter(|axis| axis.norm() > 1e-9) {
        let spread = |&(place, weight): &(Position, f64)| {
            let along = Position::new(axis[0], axis[1], axis[2]);
            POINTS.map(|(deviations, share)| (place + along * deviations, weight * share))
        };
        points = points.iter().flat_map(spread).collect();
    }
    points
}

/// Takes what the law of `fit` predicts of a fold, if nodes are where `map` says, and what it gains over fields of strengths.
pub(super) fn by_links(
    fold: &Fold<'_>,
    log: &ReceptionLog,
    fit: Option<&LinkFit>,
    map: &TopologyMap,
    predicted: &mut Predicted,
    gain: &mut GainOfLaw,
) {
    let predictor = fit.and_then(|fit| Predictor::new(log, fit));
    let strengths = FallOfStrength::of(fold, map, &|_, _| 0.0);
    let usual = fold.usual_share();
    for (node, estimate) in map.estimates.iter().enumerate() {
        let pairs: Vec<NodeAndStop> = fold.pairs(node).collect();
        let others: Vec<Position> = pairs.iter().map(|pair| pair.stop.position).collect();
        let margins = estimate.as_ref().zip(predictor.as_ref()).and_then(|(estimate, predictor)| {
            let placed = Placed { place: estimate.position, covariance: estimate.covariance.unwrap_or_default() };
            predictor.margins(node, &placed, &others)
        });
        let mut by_law = Vec::new();
        for (number, pair) in pairs.iter().enumerate() {
            let probability = match margins.as_ref().zip(predictor.as_ref()) {
                Some((margins, predictor)) => predictor.probability(&margins[number], pair.received, pair.sent),
                None => binomial(usual, pair),
            };
            let density = pair.rssi_dbm.and_then(|rssi_dbm| {
                let (margins, predictor) = margins.as_ref().zip(predictor.as_ref())?;
                predictor.strength_density(&margins[number], [pair.received, pair.sent], rssi_dbm)
            });
            by_law.extend(density.map(|density| (*pair, density)));
            let usual = || pair.rssi_dbm.zip(strengths.as_ref()).map(|(dbm, strengths)| strengths.density(None, dbm));
            predicted.take(node, probability, pair.sent, density.or_else(usual));
        }
        gain.take(fold, node, &by_law);
    }
}
