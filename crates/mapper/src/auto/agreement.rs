//! How well the regions of an estimator tell how far its maps of different parts of a log are from each other.

use nalgebra::{DMatrix, DVector};

use crate::posterior::Estimate;
use crate::topology_map::TopologyMap;

/// A node counts at most by this many times what its regions tell: single nodes far off are no reason to enlarge all.
const MOST_OF_A_NODE: f64 = 25.0;
/// Largest factor on the variances.
const MOST: f64 = 25.0;
/// Variance that a place has at least, as a share of the usual variance of the nodes.
const LEAST_SHARE: f64 = 0.05;

/// The factor on the variances of an estimator with which its regions agree with the distances between its maps from
/// different stops, at least 1. Maps from different stops err independently of each other, so that the distance between two
/// places of a node has the sum of both covariances.
pub(super) fn enlargement(maps: &[TopologyMap]) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (number, first) in maps.iter().enumerate() {
        for second in &maps[number + 1..] {
            let least_m2 = LEAST_SHARE * usual_variance_m2([first, second]);
            for (a, b) in first.estimates.iter().zip(&second.estimates) {
                if let Some(squared) = a.as_ref().zip(b.as_ref()).and_then(|(a, b)| apart(a, b, least_m2)) {
                    sum += squared.min(MOST_OF_A_NODE);
                    count += 1.0;
                }
            }
        }
    }
    if count > 0.0 { (sum / count).clamp(1.0, MOST) } else { 1.0 }
}

/// The mean squared distance between the places of an estimator and those of another one on maps of the same parts of the stops,
/// in units of its own variance along each axis. What is wrong with a law is in all maps by it: only another law tells.
pub(super) fn between_laws(own: &[TopologyMap], other: &[TopologyMap]) -> Option<f64> {
    let (mut sum, mut count) = (0.0, 0.0);
    for (own, other) in own.iter().zip(other) {
        let least_m2 = LEAST_SHARE * usual_variance_m2([own]);
        let places = other.estimates.iter().map(|estimate| {
            estimate.as_ref().map(|estimate| Estimate { covariance: Some([[0.0; 3]; 3]), ..estimate.clone() })
        });
        for (a, b) in own.estimates.iter().zip(places) {
            if let Some(squared) = a.as_ref().zip(b).and_then(|(a, b)| apart(a, &b, 0.5 * least_m2)) {
                sum += squared.min(MOST_OF_A_NODE);
                count += 1.0;
            }
        }
    }
    (count > 0.0).then(|| sum / count)
}

/// How many times the variances of another estimator are those of its own, on maps of the same parts of the stops.
pub(super) fn variances_over(own: &[TopologyMap], other: &[TopologyMap]) -> f64 {
    let own_m2 = usual_variance_m2(own);
    if own_m2 > 0.0 { (usual_variance_m2(other) / own_m2).min(MOST) } else { 1.0 }
}

/// The mean variance along an axis of the plane (m²).
fn usual_variance_m2<'a>(maps: impl IntoIterator<Item = &'a TopologyMap, IntoIter: Clone>) -> f64 {
    let maps = maps.into_iter();
    let variances = || {
        let estimates = maps.clone().flat_map(|map| map.estimates.iter().flatten());
        estimates.filter_map(|estimate| Some(0.5 * (estimate.covariance?[0][0] + estimate.covariance?[1][1])))
    };
    variances().sum::<f64>() / (variances().count().max(1)) as f64
}

/// The squared distance between two places of a node in units of its variance along each axis.
fn apart(first: &Estimate, second: &Estimate, least_m2: f64) -> Option<f64> {
    let (a, b) = (first.covariance?, second.covariance?);
    let dimensions = if a[2][2] + b[2][2] > 1e-12 { 3 } else { 2 };
    let own = |row: usize, column: usize| if row == column { 2.0 * least_m2 } else { 0.0 };
    let sum =
        DMatrix::from_fn(dimensions, dimensions, |row, column| a[row][column] + b[row][column] + own(row, column));
    let way: [f64; 3] = (second.position - first.position).into();
    let way = DVector::from_column_slice(&way[..dimensions]);
    Some(way.dot(&sum.cholesky()?.solve(&way)) / dimensions as f64)
}

#[cfg(test)]
mod tests {
    use sextant_channel::Position;

    use super::*;
    use crate::topology_map::CoordinateFrame;

    /// A map of nodes with these places and one variance along each axis (m, m²).
    fn map(places: &[[f64; 2]], variance_m2: f64) -> TopologyMap {
        let places = places.iter().map(|&[x_m, y_m]| Some(Position::new(x_m, y_m, 0.0))).collect();
        let mut map = TopologyMap::of_places("a", places, CoordinateFrame::World);
        for estimate in map.estimates.iter_mut().flatten() {
            estimate.covariance = Some([[variance_m2, 0.0, 0.0], [0.0, variance_m2, 0.0], [0.0; 3]]);
        }
        map
    }

    #[test]
    fn maps_that_are_farther_apart_than_their_regions_tell_have_larger_ones() {
        // 2 m apart along each axis: a squared distance of 4 m² an axis, where the sum of the variances is 0.5 + 5 % m².
        let maps = [map(&[[0.0, 0.0], [5.0, 5.0]], 0.25), map(&[[2.0, 2.0], [3.0, 3.0]], 0.25)];
        assert!((enlargement(&maps) - 4.0 / (0.5 * 1.05)).abs() < 1e-9, "{}", enlargement(&maps));
        // Nearer than the regions tell: they stay.
        let maps = [map(&[[0.0, 0.0]], 4.0), map(&[[0.5, 0.0]], 4.0)];
        assert!((enlargement(&maps) - 1.0).abs() < 1e-12);
        // One node that is far off does not enlarge the regions of all by far.
        let maps = [map(&[[0.0, 0.0]; 10], 1.0), map(&[[1e3, 0.0], [0.0; 2], [0.0; 2], [0.0; 2]], 1.0)];
        assert!(enlargement(&maps) <= MOST_OF_A_NODE / 4.0 + 1e-9);
    }

    #[test]
    fn laws_that_place_nodes_differently_are_apart_in_units_of_the_own_variance() {
        let own = [map(&[[0.0, 0.0], [5.0, 5.0]], 0.25), map(&[[1.0, 0.0], [6.0, 5.0]], 0.25)];
        let other = [map(&[[1.0, 1.0], [6.0, 6.0]], 9.0), map(&[[2.0, 1.0], [7.0, 6.0]], 9.0)];
        // 1 m along each axis in every part, where the own variance is 0.25 + 5 % m².
        let apart = between_laws(&own, &other).unwrap();
        assert!((apart - 1.0 / (0.25 * 1.05)).abs() < 1e-9, "{apart}");
        assert_eq!(between_laws(&own, &own), Some(0.0));
        assert_eq!(between_laws(&own, &[]), None);
    }

    #[test]
    fn variances_are_compared_on_maps_of_parts() {
        let (narrow, wide) = ([map(&[[0.0, 0.0]], 1.0)], [map(&[[0.0, 0.0], [1.0, 0.0]], 9.0)]);
        assert!((variances_over(&narrow, &wide) - 9.0).abs() < 1e-12);
        assert!((variances_over(&wide, &narrow) - 1.0 / 9.0).abs() < 1e-12);
        assert!((variances_over(&[], &[]) - 1.0).abs() < 1e-12);
    }
}
