//! Where a station is at a time: it stands, or it drives straight or along an arc.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

/// A place and a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where it is (m).
    pub position: Position,
    /// Where it looks: the angle from the x axis, counterclockwise (rad).
    pub heading_rad: f64,
}

/// A drive: a straight line, or an arc seen from above that may climb evenly, at constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Trip {
    pub(crate) from: Pose,
    pub(crate) to: Pose,
    pub(crate) start: SimTime,
    pub(crate) end: SimTime,
    /// Angle that the heading turns by, counterclockwise (rad); zero on a straight line.
    pub(crate) turn_rad: f64,
    pub(crate) length_m: f64,
    pub(crate) speed_m_per_s: f64,
}

/// A way relative to the pose at its start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Curve {
    pub(crate) length_m: f64,
    /// How much higher its end is than its start (m), at most the length.
    pub(crate) climb_m: f64,
    /// Angle that the heading turns by, counterclockwise (rad).
    pub(crate) turn_rad: f64,
}

/// How a station moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Motion {
    Standing(Pose),
    Driving(Trip),
}

impl Motion {
    pub(crate) fn standing(position: Position) -> Self {
        Self::Standing(Pose { position, heading_rad: 0.0 })
    }

    /// The place at `now`.
    #[inline]
    pub(crate) fn at(&self, now: SimTime) -> Position {
        match self {
            Self::Standing(pose) => pose.position,
            Self::Driving(trip) => trip.at(now).position,
        }
    }

    pub(crate) fn pose_at(&self, now: SimTime) -> Pose {
        match self {
            Self::Standing(pose) => *pose,
            Self::Driving(trip) => trip.at(now),
        }
    }
}

impl Pose {
    /// Where an arc ends that starts here: a vehicle whose wheels do not slip drives `length_m` while its heading
    /// turns by `turn_rad` (unicycle; Siegwart and Nourbakhsh 2004, section 3.2). The height stays.
    #[must_use]
    pub fn after_arc(self, length_m: f64, turn_rad: f64) -> Self {
        // The chord of the arc is shorter than the arc, and points half the turn to the side.
        let half = 0.5 * turn_rad;
        let chord_m = if half.abs() < 1e-9 { length_m } else { length_m * libm::sin(half) / half };
        let direction = self.heading_rad + half;
        let step = Position::new(chord_m * libm::cos(direction), chord_m * libm::sin(direction), 0.0);
        Self { position: self.position + step, heading_rad: self.heading_rad + turn_rad }
    }
}

/// No way takes longer (s): 31 years, which no simulation lasts.
pub(crate) const LONGEST_S: f64 = 1e9;

/// How long a body takes for a way.
pub(crate) fn time_of(length_m: f64, speed_m_per_s: f64) -> Duration {
    Duration::from_secs_f64((length_m / speed_m_per_s).min(LONGEST_S))
}

impl Trip {
    /// The straight line from `from` to `to` at `speed_m_per_s`.
    pub(crate) fn straight(from: Pose, to: Position, start: SimTime, speed_m_per_s: f64) -> Self {
        // What would take too long ends on the way, so that the speed is right.
        let share = LONGEST_S * speed_m_per_s / from.position.distance_m(to);
        let to = if share < 1.0 { from.position + (to - from.position) * share } else { to };
        let length_m = from.position.distance_m(to);
        let end = start + time_of(length_m, speed_m_per_s);
        let step = to - from.position;
        let is_vertical = libm::hypot(step.x_m, step.y_m) <= 0.0;
        let heading_rad = if is_vertical { from.heading_rad } else { libm::atan2(step.y_m, step.x_m) };
        let to = Pose { position: to, heading_rad };
        Self { from: Pose { heading_rad, ..from }, to, start, end, turn_rad: 0.0, length_m, speed_m_per_s }
    }

    /// The way along `curve` at `speed_m_per_s`.
    pub(crate) fn along(curve: Curve, from: Pose, start: SimTime, speed_m_per_s: f64) -> Self {
        let Curve { length_m, turn_rad, .. } = curve;
        let end = start + time_of(length_m, speed_m_per_s);
        Self { from, to: curve.end(from), start, end, turn_rad, length_m, speed_m_per_s }
    }

    /// The way relative to the pose at its start.
    pub(crate) fn curve(&self) -> Curve {
        let climb_m = self.to.position.z_m - self.from.position.z_m;
        Curve { length_m: self.length_m, climb_m, turn_rad: self.turn_rad }
    }

    pub(crate) fn is_straight(&self) -> bool {
        self.turn_rad.abs() <= 0.0
    }

    /// The first `length_m` of the way.
    pub(crate) fn first(&self, length_m: f64) -> Self {
        if self.is_straight() {
            let direction = (self.to.position - self.from.position) * (1.0 / self.length_m);
            return Self::straight(
                self.from,
                self.from.position + direction * length_m,
                self.start,
                self.speed_m_per_s,
            );
        }
        Self::along(self.curve().part(length_m / self.length_m), self.from, self.start, self.speed_m_per_s)
    }

    /// Share of the way that is done at `now`.
    fn share(&self, now: SimTime) -> f64 {
        let span = (self.end - self.start).as_secs_f64();
        if span <= 0.0 { 1.0 } else { (now.saturating_since(self.start).as_secs_f64() / span).min(1.0) }
    }

    /// The pose at `now`: that of the start before it, that of the end after it.
    pub(crate) fn at(&self, now: SimTime) -> Pose {
        self.after(self.share(now))
    }

    /// The pose after a share of the way.
    pub(crate) fn after(&self, share: f64) -> Pose {
        if share >= 1.0 {
            return self.to;
        }
        if !self.is_straight() {
            return self.curve().part(share).end(self.from);
        }
        let position = self.from.position + (self.to.position - self.from.position) * share;
        Pose { position, heading_rad: self.to.heading_rad }
    }

    /// The part of the way that is done at `now`, as a separate trip.
    pub(crate) fn cut_at(&self, now: SimTime) -> Self {
        let share = self.share(now);
        Self {
            to: self.at(now),
            end: now.min(self.end),
            turn_rad: share * self.turn_rad,
            length_m: share * self.length_m,
            ..*self
        }
    }
}

impl Curve {
    /// The first part, a share of the way.
    fn part(self, share: f64) -> Self {
        let Self { length_m, climb_m, turn_rad } = self;
        Self { length_m: share * length_m, climb_m: share * climb_m, turn_rad: share * turn_rad }
    }

    /// Its length seen from above (m).
    pub(crate) fn level_m(self) -> f64 {
        if self.climb_m.abs() <= 0.0 {
            return self.length_m;
        }
        (self.length_m * self.length_m - self.climb_m * self.climb_m).max(0.0).sqrt()
    }

    /// Where it ends if it begins at `from`.
    fn end(self, from: Pose) -> Pose {
        let mut end = from.after_arc(self.level_m(), self.turn_rad);
        end.position.z_m += self.climb_m;
        end
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    const HERE: Pose = Pose { position: Position::ORIGIN, heading_rad: 0.0 };

    fn at(seconds: f64) -> SimTime {
        SimTime::ZERO + Duration::from_secs_f64(seconds)
    }

    fn assert_near(found: Position, expected: [f64; 3]) {
        assert!(found.distance_m(expected.into()) < 1e-9, "{found:?}, not {expected:?}");
    }

    fn arc(length_m: f64, turn_rad: f64) -> Curve {
        Curve { length_m, climb_m: 0.0, turn_rad }
    }

    #[test]
    fn a_straight_drive_is_where_its_speed_says() {
        let trip = Trip::straight(HERE, Position::new(3.0, 4.0, 0.0), at(2.0), 0.5);
        assert_eq!(trip.end, at(12.0));
        assert_near(trip.at(at(1.0)).position, [0.0; 3]);
        assert_near(trip.at(at(7.0)).position, [1.5, 2.0, 0.0]);
        assert_near(trip.at(at(13.0)).position, [3.0, 4.0, 0.0]);
        assert!((trip.at(at(7.0)).heading_rad - 4_f64.atan2(3.0)).abs() < 1e-12);
    }

    #[test]
    fn a_way_that_takes_too_long_is_driven_at_its_speed_as_far_as_time_goes() {
        let trip = Trip::straight(HERE, Position::new(1e9, 0.0, 0.0), at(0.0), 1e-3);
        assert_near(trip.at(at(1e6)).position, [1e3, 0.0, 0.0]);
        assert!((trip.to.position.x_m - 1e6).abs() < 1e-3 && trip.end <= at(1e9));
    }

    #[test]
    fn a_quarter_circle_ends_beside_its_centre() {
        // Radius 2 m to the left: the centre is (0, 2).
        let trip = Trip::along(arc(PI, FRAC_PI_2), HERE, at(0.0), 1.0);
        assert_near(trip.to.position, [2.0, 2.0, 0.0]);
        assert!((trip.to.heading_rad - FRAC_PI_2).abs() < 1e-12);
        for share in [0.1, 0.35, 0.8] {
            let place = trip.at(at(share * PI)).position;
            assert!((place.distance_m(Position::new(0.0, 2.0, 0.0)) - 2.0).abs() < 1e-9);
        }
        let half = trip.cut_at(at(0.5 * PI));
        let root = 2_f64.sqrt();
        assert_near(half.to.position, [root, 2.0 - root, 0.0]);
        assert!((half.length_m - 0.5 * PI).abs() < 1e-9);
    }

    #[test]
    fn a_turn_that_climbs_ends_above_its_arc() {
        // A way of 5 m that climbs 3 m is 4 m long from above: half a circle of radius 4 m / pi to the right.
        let helix = Curve { length_m: 5.0, climb_m: 3.0, turn_rad: -PI };
        let trip = Trip::along(helix, HERE, at(0.0), 1.0);
        assert_near(trip.to.position, [0.0, -8.0 / PI, 3.0]);
        assert_near(trip.at(at(2.5)).position, [4.0 / PI, -4.0 / PI, 1.5]);
    }

    #[test]
    fn the_first_part_of_a_way_is_on_the_way() {
        for trip in [
            Trip::straight(HERE, Position::new(3.0, 4.0, 1.0), at(2.0), 0.5),
            Trip::along(arc(4.0, 2.5), HERE, at(2.0), 0.5),
        ] {
            let first = trip.first(1.0);
            assert_eq!(first.end, at(4.0));
            assert!((first.length_m - 1.0).abs() < 1e-12);
            assert_near(trip.at(at(4.0)).position, first.to.position.into());
            assert!((trip.at(at(4.0)).heading_rad - first.to.heading_rad).abs() < 1e-12);
        }
    }

    #[test]
    fn a_way_that_is_cut_ends_where_it_was_at_that_time() {
        let trip = Trip::straight(HERE, Position::new(3.0, 4.0, 0.0), at(2.0), 0.5);
        let cut = trip.cut_at(at(4.0));
        assert_near(cut.to.position, [0.6, 0.8, 0.0]);
        assert_eq!((cut.end, cut.at(at(3.0))), (at(4.0), trip.at(at(3.0))));
        assert_eq!(trip.cut_at(at(99.0)), trip);
    }
}
