//! What speaks against the map of an estimator that takes packets as independent.

use sextant_channel::{Position, Stop};

use super::EstimatorFit;
use crate::link_model::beyond_m;
use crate::topology_map::TopologyMap;

/// Whether an estimator settles on a log: its profile does, and most places have no concern.
pub(super) fn settles(map: &TopologyMap, fit: Option<&EstimatorFit>) -> bool {
    let has_curve = !matches!(fit, Some(EstimatorFit::Profile(fit)) if !fit.converged);
    has_curve && 2 * map.concerns().count() <= map.mapped()
}

/// Whether more than one in twenty places of a map is beyond all stops, by more than nodes usually are.
///
/// Stops round a hall, or along a straight way, leave two places on both sides of it. Estimators of independent packets take them
/// for equally likely; the link model knows that a survey goes round most nodes.
pub(super) fn is_beyond(map: &TopologyMap, stops: &[Stop], reach_m: f64) -> bool {
    let along = |axis: usize| stops.iter().map(move |stop| <[f64; 3]>::from(stop.position)[axis]);
    let ends = [0, 1].map(|axis| {
        along(axis).fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)])
    });
    let widths_m = ends.map(|[low, high]| high - low);
    let diagonal_m = libm::hypot(widths_m[0], widths_m[1]);
    let is_out = |place: Position| {
        let out_m = |axis: usize, at: f64| (ends[axis][0] - at).max(at - ends[axis][1]);
        let is_far = |axis: usize, at: f64| out_m(axis, at) > beyond_m(widths_m[axis], diagonal_m, reach_m);
        is_far(0, place.x_m) || is_far(1, place.y_m)
    };
    20 * map.positions().into_iter().flatten().filter(|&place| is_out(place)).count() > map.mapped()
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{RobotId, SimTime};

    use super::*;
    use crate::topology_map::CoordinateFrame;

    /// Stops round a hall of 16 by 11 m, whose nodes are heard up to 6 m.
    fn is_beyond_hall(places: &[[f64; 2]]) -> bool {
        let corners = [[0.0, 0.0], [16.0, 0.0], [16.0, 11.0], [0.0, 11.0]];
        let stops = corners.map(|[x_m, y_m]| Stop {
            robot: RobotId(0),
            time: SimTime::ZERO,
            position: Position::new(x_m, y_m, 0.0),
            heading_rad: None,
        });
        let places = places.iter().map(|&[x_m, y_m]| Some(Position::new(x_m, y_m, 0.0))).collect();
        is_beyond(&TopologyMap::of_places("a", places, CoordinateFrame::World), &stops, 6.0)
    }

    #[test]
    fn a_mirror_image_across_the_stops_is_beyond_them() {
        assert!(!is_beyond_hall(&[[9.8, 8.2], [3.0, 2.0], [-0.9, 5.0], [16.9, 11.9]]));
        assert!(is_beyond_hall(&[[9.8, 13.8], [3.0, 2.0], [8.0, 5.0]]));
        assert!(is_beyond_hall(&[[17.1, 5.0], [3.0, 2.0]]));
        // One of many says nothing of the estimator.
        let mut many = vec![[8.0, 5.0]; 19];
        many.push([8.0, 13.8]);
        assert!(!is_beyond_hall(&many));
    }
}
