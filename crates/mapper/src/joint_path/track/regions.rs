//! What errors that stay the same for a while add to the regions of a track.

use nalgebra::{Matrix2, Vector2};
use sextant_channel::Position;

use super::problem::{TrackPoint, TrackProblem};
use crate::numerics::convex_hull::{hull, turn};
use crate::numerics::median;

/// The fit of a track takes a part of what strengths keep, which its residuals do not show: at least so much is kept (dB). By
/// the best law at the true places, strengths of four real walks were 4 to 6 dB off.
const LEAST_KEPT_DB: f64 = 4.0;

/// What errors that stay the same for a while add to the covariance of each place (m²): what stands in the way of a receiver lengthens
/// its ranges, or weakens its strengths, until the tag has moved on, so that the readings of a place share it, whatever their number.
pub(super) fn by_place(problem: &TrackProblem<'_>, point: &TrackPoint) -> Vec<Matrix2<f64>> {
    let has_ranges = problem.readings.iter().any(|reading| !reading.is_strength);
    // Of strengths alone, no less than what their fit cannot take.
    let least_db2 = if has_ranges { 0.0 } else { LEAST_KEPT_DB * LEAST_KEPT_DB };
    let variance = if has_ranges { kept_variance(problem, point, false) } else { 1.0 };
    let strengths = kept_variance(problem, point, true).max(least_db2).max(1e-9);
    let mut directions = vec![Matrix2::zeros(); point.states.len()];
    for reading in problem.readings {
        let sight = problem.sight(reading, point);
        let along = Vector2::new(sight.apart[0], sight.apart[1]) / sight.distance_m;
        // The information of a strength in the units of a range.
        let weight = if reading.is_strength {
            let db_per_m = problem.db_per_m(sight.distance_m, point);
            db_per_m * db_per_m * variance / strengths
        } else {
            1.0
        };
        directions[reading.epoch] += along * along.transpose() * weight;
    }
    // Receivers that are not heard in an epoch are in others nearby. Where all are in one direction, nothing tells the other one.
    let around = |at: usize| {
        let near = &directions[at.saturating_sub(2)..(at + 3).min(directions.len())];
        let mean = near.iter().sum::<Matrix2<f64>>() / near.len() as f64;
        let least = if has_ranges { 0.05 } else { 0.01 * mean.trace() + 1e-6 };
        mean + Matrix2::identity() * least
    };
    (0..directions.len()).map(|at| around(at).try_inverse().unwrap_or_else(Matrix2::zeros) * variance).collect()
}

/// The variance of what the errors of ranges (m²), or of strengths (dB²), keep for a while.
fn kept_variance(problem: &TrackProblem<'_>, point: &TrackPoint, of_strengths: bool) -> f64 {
    /// So many readings in a row have nearly the same error.
    const ROW: usize = 20;
    let mut series = vec![Vec::new(); problem.receivers.len()];
    for (receiver, error) in problem.errors(point, of_strengths) {
        series[receiver].push(error);
    }
    let (mut sum, mut count) = (0.0, 0.0_f64);
    for row in series.iter().flat_map(|errors| errors.chunks_exact(ROW)) {
        sum += median(&mut row.to_vec()).powi(2);
        count += 1.0;
    }
    sum / count.max(1.0)
}

/// Whether most of a track is among the receivers: within their convex hull, made larger by a fifth.
pub(super) fn is_among(receivers: &[Position], track: &[[f64; 2]]) -> bool {
    let middle = receivers.iter().fold(Position::ORIGIN, |sum, &place| sum + place) * (1.0 / receivers.len() as f64);
    let larger: Vec<[f64; 2]> = receivers
        .iter()
        .map(|place| [middle.x_m + 1.2 * (place.x_m - middle.x_m), middle.y_m + 1.2 * (place.y_m - middle.y_m)])
        .collect();
    let hull = hull(larger);
    let is_inside = |place: &&[f64; 2]| {
        hull.len() >= 3 && (0..hull.len()).all(|at| turn(hull[at], hull[(at + 1) % hull.len()], **place) >= 0.0)
    };
    2 * track.iter().filter(is_inside).count() >= track.len()
}
