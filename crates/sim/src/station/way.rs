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
    /// if it meets the obstacle head-on. Seven chords are needed for a quarter of a circle of 1 m, and their number
    /// grows with the square root of the radius.
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
