//! What estimators predict of stops that they did not use.

use sextant_channel::{Position, ReceptionLog, Stop};
use sextant_kernel::maths::{exp, ln};

use super::EstimatorFit;
use super::fall_of_strength::FallOfStrength;
use super::folds::{Fold, NodeAndStop};
use super::opinions::GainOfLaw;
use super::score::Predicted;
use crate::link_model::{LinkFit, Placed, Predictor};
use crate::posterior::Estimate;
use crate::self_calibrated::{CalibratedShares, Calibration};
use crate::topology_map::TopologyMap;

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
        let points = estimate.as_ref().map(Estimate::points);
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
    calibrated: Option<CalibratedShares<'a>>,
    usual: f64,
}

impl<'a> PredictedShares<'a> {
    fn of(fit: &'a EstimatorFit, usual: f64) -> Self {
        let calibrated = match fit {
            EstimatorFit::Calibration(calibration) => calibration.shares(),
            _ => None,
        };
        Self { fit, calibrated, usual }
    }

    /// The share of packets that arrive over a link.
    fn at(&self, place: Position, stop: &Stop) -> f64 {
        match self.fit {
            EstimatorFit::Profile(profile) => profile.curve.probability(place.distance_m(stop.position)),
            EstimatorFit::Calibration(_) => {
                self.calibrated.as_ref().map_or(self.usual, |shares| shares.at(place, stop.position))
            }
            EstimatorFit::Pattern(pattern) => pattern.probability(place, stop),
            EstimatorFit::Links(_) => self.usual,
        }
    }
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
