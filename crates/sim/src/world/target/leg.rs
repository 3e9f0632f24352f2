//! A straight piece of the way of a target.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use crate::station::{Motion, Pose, Trip, time_of};

/// The shortest time of a leg: that of the clock of a simulation.
const SHORTEST: Duration = Duration::from_nanos(1);

/// A straight piece of the way of a target, at constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leg {
    /// Where it begins (m).
    pub from: Position,
    /// Where it ends (m).
    pub to: Position,
    /// When it begins.
    pub start: SimTime,
    /// When it ends: later than it begins, except where a target stands for ever.
    pub end: SimTime,
}

impl Leg {
    pub(super) fn new(from: Position, to: Position, start: SimTime, speed_m_per_s: f64) -> Self {
        let end = start + time_of(from.distance_m(to), speed_m_per_s);
        Self { from, to, start, end }.that_takes_time()
    }

    /// The same, but it takes at least the shortest time: legs that take none would never end.
    pub(crate) fn that_takes_time(self) -> Self {
        Self { end: self.end.max(self.start + SHORTEST), ..self }
    }

    /// A target that stands at `place` from `start` on.
    pub(crate) fn standing(place: Position, start: SimTime) -> Self {
        Self { from: place, to: place, start, end: start }
    }

    /// The motion along it.
    pub(crate) fn motion(&self) -> Motion {
        let &Self { from, to, start, end } = self;
        let length_m = from.distance_m(to);
        if length_m <= 0.0 {
            return Motion::standing(from);
        }
        let speed_m_per_s = length_m / (end - start).as_secs_f64();
        let from = Pose { position: from, heading_rad: 0.0 };
        Motion::Driving(Trip { end, ..Trip::straight(from, to, start, speed_m_per_s) })
    }

    /// The place at `time`: that of the start before it, that of the end after it.
    #[must_use]
    pub fn at(&self, time: SimTime) -> Position {
        if time >= self.end {
            return self.to;
        }
        let share = time.saturating_since(self.start).as_secs_f64() / (self.end - self.start).as_secs_f64();
        self.from + (self.to - self.from) * share
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_leg_takes_time_however_short_it_is() {
        let (here, start) = (Position::ORIGIN, SimTime::from_nanos(7));
        let end = |length_m: f64| Leg::new(here, Position::new(length_m, 0.0, 0.0), start, 1e3).end;
        assert_eq!((end(1e-9), end(1e-300)), (SimTime::from_nanos(8), SimTime::from_nanos(8)));
        assert_eq!(end(5e-6), SimTime::from_nanos(12));
    }
}
