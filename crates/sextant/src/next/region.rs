//! The region in which a robot may stop.

use sextant_channel::{Bounds, ObstacleField, Position, Stop, nearest_on_line};
use sextant_mapper::{Area, convex_hull};

/// The region in which a robot may stop.
#[derive(Debug)]
pub(super) enum Region<'a> {
    /// An area that is given.
    Area(&'a Area),
    /// All places that are near to the hull of the stops, within a floor plan if there is one.
    Around {
        /// The corners of the hull (m).
        hull: Vec<[f64; 2]>,
        /// So near to it (m).
        within_m: f64,
        /// The box of the floor plan.
        floor: Option<Bounds>,
    },
}

impl<'a> Region<'a> {
    pub(super) fn new(
        area: Option<&'a Area>,
        stops: &[Stop],
        reach_m: f64,
        floor: Option<&ObstacleField>,
        notes: &mut Vec<String>,
    ) -> Self {
        if let Some(area) = area {
            return Self::Area(area);
        }
        let places = stops.iter().map(|stop| [stop.position.x_m, stop.position.y_m]).collect();
        let floor = floor.and_then(ObstacleField::bounds);
        let within = if floor.is_some() { " and within the floor plan" } else { "" };
        notes.push(format!(
            "no area is given: stops are sought up to {reach_m:.1} m from the hull of the log{within}, for so far nodes are heard"
        ));
        Self::Around { hull: convex_hull(places), within_m: reach_m, floor }
    }

    pub(super) fn contains(&self, place: Position) -> bool {
        match self {
            Self::Area(area) => area.contains(place),
            Self::Around { hull, within_m, floor } => {
                floor.is_none_or(|floor| floor.contains(Position { z_m: floor.center().z_m, ..place }))
                    && distance_m([place.x_m, place.y_m], hull) <= *within_m
            }
        }
    }

    /// The box of the region, at this height (m).
    pub(super) fn bounds(&self, z_m: f64) -> Bounds {
        let at = |[x_m, y_m]: [f64; 2]| Position::new(x_m, y_m, z_m);
        match self {
            Self::Area(area) => {
                let [low, high] = area.bounds();
                Bounds { min: at(low), max: at(high) }
            }
            Self::Around { hull, within_m, floor } => {
                let all = Bounds::of(hull.iter().copied().map(at))
                    .unwrap_or(Bounds { min: at([0.0; 2]), max: at([0.0; 2]) });
                let all = all.grown(*within_m);
                let (mut min, mut max) = (all.min, all.max);
                if let Some(floor) = floor {
                    (min.x_m, min.y_m) = (min.x_m.max(floor.min.x_m), min.y_m.max(floor.min.y_m));
                    (max.x_m, max.y_m) = (max.x_m.min(floor.max.x_m), max.y_m.min(floor.max.y_m));
                    (max.x_m, max.y_m) = (max.x_m.max(min.x_m), max.y_m.max(min.y_m));
                }
                Bounds { min: at([min.x_m, min.y_m]), max: at([max.x_m, max.y_m]) }
            }
        }
    }

    /// Distance from the region to the nearest of `stops` (m).
    pub(super) fn away_m(&self, stops: &[Stop]) -> f64 {
        let away = |stop: &Stop| match self {
            Self::Area(area) => area.nearest(stop.position).distance_m(stop.position),
            Self::Around { .. } => 0.0,
        };
        stops.iter().map(away).fold(f64::INFINITY, f64::min)
    }
}

/// Distance from `p` to a convex polygon whose corners go counterclockwise, or to the line or the place that it is (m).
fn distance_m(p: [f64; 2], hull: &[[f64; 2]]) -> f64 {
    let sides = || hull.iter().zip(hull.iter().cycle().skip(1));
    let is_left =
        |(a, b): (&[f64; 2], &[f64; 2])| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) >= 0.0;
    if hull.len() > 2 && sides().all(is_left) {
        return 0.0;
    }
    sides().map(|(&a, &b)| nearest_on_line(p, a, b).1).fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_as_far_from_a_hull_as_from_its_nearest_side() {
        let square = convex_hull(vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [2.0, 1.0]]);
        let line = convex_hull(vec![[0.0, 0.0], [2.0, 0.0], [4.0, 0.0]]);
        for (p, hull, expected) in [
            ([1.0, 1.0], &square, 0.0),
            ([7.0, 8.0], &square, 5.0),
            ([2.0, -3.0], &square, 3.0),
            ([1.0, 1.0], &line, 1.0),
            ([7.0, 4.0], &line, 5.0),
        ] {
            assert!((distance_m(p, hull) - expected).abs() < 1e-12, "{p:?}: {}", distance_m(p, hull));
        }
    }
}
