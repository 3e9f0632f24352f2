//! How wide the regions of a map are beside what its estimator says.

use super::EstimatorFit;
use crate::topology_map::TopologyMap;

/// How many times more slowly strengths fall with the logarithm of the distance than in real surroundings, at least 1: so many times
/// wider are regions, because what makes them fall slowly is in no law.
pub(super) fn slow_fall(fit: Option<&EstimatorFit>) -> f64 {
    /// The least path-loss exponent of real surroundings.
    const LEAST_EXPONENT: f64 = 1.5;
    match fit {
        Some(EstimatorFit::Links(fit)) => {
            fit.path_loss_exponent().map_or(1.0, |exponent| (LEAST_EXPONENT / exponent).clamp(1.0, 3.0))
        }
        _ => 1.0,
    }
}

/// Enlarges the variances of a map by a factor.
pub(super) fn enlarge(map: &mut TopologyMap, factor: f64) {
    for covariance in map.estimates.iter_mut().flatten().filter_map(|estimate| estimate.covariance.as_mut()) {
        *covariance = covariance.map(|row| row.map(|entry| factor * entry));
    }
}
