//! How far a robot comes on its way before an obstacle stops it.

use std::f64::consts::FRAC_PI_4;

use sextant_channel::{ObstacleField, Position};

use super::motion::Trip;

/// Gap between the hull of a blocked robot and the obstacle (m).
const HALT_M: f64 = 1e-3;

/// Largest distance between an arc and the chords that stand for it (m).
const SAGITTA_M: f64 = 5e-4;

/// Half the distance of two places between which the distance from obstacles is differentiated (m).
const NEAR_M: f64 = 1e-6;

/// The part of a trip that a robot can drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Way {
    pub(crate) trip: Trip,
    /// The point of contact on the obstacle, if one ends the trip (m).
    pub(crate) contact: Option<Position>,
}

impl Way {
    /// The part of `trip` that a hull of `radius_m` can drive among `obstacles`.
    ///
    /// A straight line is checked exactly. An arc is checked by chords: the hull is larger by the largest distance
    /// between arc and chord, 0.5 mm. So the robot never touches an obstacle, and stops at most 1.5 mm before that
    /// if it meets the obstacle head-on. A quarter of a circle with a radius of 1 m has 25 chords; their number grows
    /// with the square root of the radius.
    pub(crate) fn of(trip: Trip, obstacles: &ObstacleField, radius_m: f64) -> Self {
        if trip.length_m <= 0.0 || obstacles.is_empty() {
            return Self { trip, contact: None };
        }
        if trip.is_straight() { straight(trip, obstacles, radius_m) } else { curved(trip, obstacles, radius_m) }
    }
}

fn straight(trip: Trip, obstacles: &ObstacleField, radius_m: f64) -> Way {
    let (from, length_m) = (trip.from.position, trip.length_m);
    let direction = (trip.to.position - from) * (1.0 / length_m);
    let clear_m = obstacles.clearance_m(from, direction, length_m, radius_m);
    if clear_m >= length_m {
        return Way { trip, contact: None };
    }
    let contact = from + direction * (clear_m + radius_m);
    Way { trip: trip.first((clear_m - HALT_M).max(0.0)), contact: Some(contact) }
}

fn curved(trip: Trip, obstacles: &ObstacleField, radius_m: f64) -> Way {
    let chords = chords(&trip);
    let mut from = trip.from.position;
    for i in 1..=chords {
        let to = trip.after(f64::from(i) / f64::from(chords)).position;
        let chord_m = from.distance_m(to);
        let clear_m = obstacles.clearance_m(from, to - from, chord_m, radius_m + SAGITTA_M);
        if clear_m < chord_m {
            let share = (f64::from(i - 1) + clear_m / chord_m) / f64::from(chords);
            let contact = nearest(trip.after(share).position, obstacles);
            let clear_m = share * trip.length_m;
            return Way { trip: trip.first((clear_m - HALT_M).max(0.0)), contact: Some(contact) };
        }
        from = to;
    }
    Way { trip, contact: None }
}

/// Number of chords of equal length that are nowhere farther from an arc than [`SAGITTA_M`]. An arc of length l along
/// which the heading turns by t is at most r (1 - cos(t / 2)) <= l t / 8 away from its chord.
fn chords(trip: &Trip) -> u32 {
    let turn_rad = trip.turn_rad.abs();
    let chords = (trip.curve().level_m() * turn_rad / (8.0 * SAGITTA_M)).sqrt().max(turn_rad / FRAC_PI_4).ceil();
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a number of chords")]
    let chords = chords as u32;
    chords.max(1)
}

/// The point of an obstacle that is nearest to `place`: against the gradient of the distance.
fn nearest(place: Position, obstacles: &ObstacleField) -> Position {
    let slope = |step: Position| (obstacles.distance_m(place + step) - obstacles.distance_m(place - step)) / NEAR_M;
    let away = Position::new(
        slope(Position::new(NEAR_M, 0.0, 0.0)),
        slope(Position::new(0.0, NEAR_M, 0.0)),
        slope(Position::new(0.0, 0.0, NEAR_M)),
    );
    let length = away.length_m();
    if length > 0.0 { place - away * (obstacles.distance_m(place) / length) } else { place }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::Files;

    use proptest::prelude::*;
    use sextant_channel::{BoxConfig, Obstacle, ObstacleConfig, ShapeConfig};
    use sextant_kernel::SimTime;

    use super::*;
    use crate::station::motion::{Curve, Pose};

    fn block() -> ObstacleField {
        let shape = ShapeConfig::Box(BoxConfig {
            center_m: Position::new(3.0, 1.0, 0.0),
            size_m: [2.0, 3.0, 2.0],
            yaw_deg: 20.0,
        });
        let config = ObstacleConfig::absorbing(shape, 1.0);
        ObstacleField::new(vec![Obstacle::read(config, &Files::default()).expect("a good block")])
    }

    fn arc(from: Position, heading_rad: f64, curve: Curve) -> Trip {
        Trip::along(curve, Pose { position: from, heading_rad }, SimTime::ZERO, 1.0)
    }

    /// Smallest distance from the obstacles on a trip.
    fn least_distance_m(trip: &Trip, obstacles: &ObstacleField) -> f64 {
        let distance_m = |i: u32| obstacles.distance_m(trip.after(f64::from(i) / 2000.0).position);
        (0..=2000).map(distance_m).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn a_quarter_of_a_circle_has_25_chords() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let curve = Curve { length_m: quarter, climb_m: 0.0, turn_rad: -quarter };
        assert_eq!(chords(&arc(Position::ORIGIN, 0.0, curve)), 25);
    }

    proptest! {
        #[test]
        fn a_robot_on_an_arc_never_touches_an_obstacle_and_stops_only_at_one(
            heading_rad in -3.0..3.0_f64, length_m in 0.1..20.0_f64, turn_rad in -7.0..7.0_f64, climb in -0.2..0.2_f64,
        ) {
            let (obstacles, radius_m) = (block(), 0.2);
            let curve = Curve { length_m, climb_m: climb * length_m, turn_rad };
            let whole = arc(Position::ORIGIN, heading_rad, curve);
            let Way { trip, contact } = Way::of(whole, &obstacles, radius_m);
            prop_assert!(least_distance_m(&trip, &obstacles) > radius_m);
            match contact {
                None => prop_assert_eq!(trip, whole),
                Some(contact) => {
                    prop_assert!(trip.length_m < whole.length_m);
                    prop_assert!(obstacles.distance_m(contact) < 1e-6, "{} m", obstacles.distance_m(contact));
                    let gap_m = obstacles.distance_m(trip.to.position) - radius_m;
                    prop_assert!(gap_m < HALT_M + 2.0 * SAGITTA_M, "{} m before the obstacle", gap_m);
                }
            }
        }
    }
}
