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

/// A drive: a straight line or an arc in the horizontal plane, at constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Trip {
    pub(crate) from: Pose,
    pub(crate) to: Pose,
    pub(crate) start: SimTime,
    pub(crate) end: SimTime,
    /// Angle that the heading turns by, counterclockwise (rad); zero on a straight line.
    pub(crate) turn_rad: f64,
    pub(crate) length_m: f64,
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

impl Trip {
    /// The straight line from `from` to `to` at `speed_m_per_s`.
    pub(crate) fn straight(from: Pose, to: Position, start: SimTime, speed_m_per_s: f64) -> Self {
        let length_m = from.position.distance_m(to);
        let end = start + Duration::from_secs_f64(length_m / speed_m_per_s);
        let step = to - from.position;
        let is_vertical = step.x_m.hypot(step.y_m) <= 0.0;
        let heading_rad = if is_vertical { from.heading_rad } else { libm::atan2(step.y_m, step.x_m) };
        let to = Pose { position: to, heading_rad };
        Self { from: Pose { heading_rad, ..from }, to, start, end, turn_rad: 0.0, length_m }
    }

    /// The arc of `length_m` along which the heading turns by `turn_rad`.
    pub(crate) fn arc(from: Pose, length_m: f64, turn_rad: f64, start: SimTime, speed_m_per_s: f64) -> Self {
        let end = start + Duration::from_secs_f64(length_m / speed_m_per_s);
        Self { from, to: from.after_arc(length_m, turn_rad), start, end, turn_rad, length_m }
    }

    /// Share of the way that is done at `now`.
    fn share(&self, now: SimTime) -> f64 {
        let span = (self.end - self.start).as_secs_f64();
        if span <= 0.0 { 1.0 } else { (now.saturating_since(self.start).as_secs_f64() / span).min(1.0) }
    }

    /// The pose at `now`: that of the start before it, that of the end after it.
    fn at(&self, now: SimTime) -> Pose {
        let share = self.share(now);
        if share >= 1.0 {
            return self.to;
        }
        if self.turn_rad.abs() > 0.0 {
            return self.from.after_arc(share * self.length_m, share * self.turn_rad);
        }
        let position = self.from.position + (self.to.position - self.from.position) * share;
        Pose { position, heading_rad: self.to.heading_rad }
    }

    /// The part of the way that is done at `now`, as a trip of its own.
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
    fn a_quarter_circle_ends_beside_its_centre() {
        // Radius 2 m to the left: the centre is (0, 2).
        let trip = Trip::arc(HERE, PI, FRAC_PI_2, at(0.0), 1.0);
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
}
