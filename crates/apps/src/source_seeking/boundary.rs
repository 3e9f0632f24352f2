//! Round an obstacle along its boundary, with one hand on it (after Lumelsky and Stepanov 1987, "Path-planning strategies
//! for a point mobile automaton moving amidst unknown obstacles of arbitrary shape": leave where it pays).

use std::f64::consts::{PI, TAU};

use super::gradient::wrapped;

/// Directions are tried in steps of this angle (rad).
const STEP_RAD: f64 = PI / 36.0;
const DIRECTIONS: u32 = 72;
/// The first direction that is tried, from straight ahead to the hand (rad).
const BEHIND_RAD: f64 = 0.75 * PI;
/// After this turn the robot has been all the way round (rad).
const FULL_TURN_RAD: f64 = TAU + 0.1;
/// A course is free if so many steps of the robot fit into it.
const FREE_STEPS: f64 = 5.0;
/// The field must have grown by this since the robot met the obstacle, relative to the level still to climb, before it leaves.
const LEAST_GAIN: f64 = 0.01;

/// The hand that the robot has on the obstacle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Hand {
    Left,
    Right,
}

impl Hand {
    /// Sign of a turn to this hand, counterclockwise.
    fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }
}

/// A robot on its way round an obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Boundary {
    hand: Hand,
    /// The value of the field where the robot met the obstacle, at its best.
    met_at: f64,
    /// Angle turned with this hand, to the hand (rad).
    turned_rad: f64,
    /// Whether the robot has been all the way round without a reason to leave.
    is_round: bool,
    /// Way with this hand (m).
    way_m: f64,
}

impl Boundary {
    /// A robot that looks into `heading_rad` meets an obstacle where the field is `value`. `clearance_m` tells how far it can
    /// drive into a direction. It goes to the side that needs the smaller turn.
    pub(super) fn meet(heading_rad: f64, value: f64, step_m: f64, clearance_m: impl Fn(f64) -> f64) -> Self {
        let turn = |hand: Hand| {
            // With the left hand on the obstacle, the robot turns to the right.
            let is_free = |i: &u32| clearance_m(heading_rad - hand.sign() * STEP_RAD * f64::from(*i)) >= step_m;
            (0..DIRECTIONS).find(is_free).unwrap_or(DIRECTIONS)
        };
        let hand = if turn(Hand::Left) <= turn(Hand::Right) { Hand::Left } else { Hand::Right };
        Self { hand, met_at: value, turned_rad: 0.0, is_round: false, way_m: 0.0 }
    }

    /// The direction of the next step along the boundary: the first free one, from the side of the hand. `None` if none is
    /// free.
    pub(super) fn direction(
        &mut self,
        heading_rad: f64,
        step_m: f64,
        clearance_m: impl Fn(f64) -> f64,
    ) -> Option<f64> {
        if self.turned_rad.abs() > FULL_TURN_RAD {
            // Back where it came from, with the other hand.
            *self = Self { hand: self.hand.other(), turned_rad: 0.0, way_m: 0.0, is_round: true, ..*self };
            return self.free(heading_rad + PI + self.hand.sign() * BEHIND_RAD, step_m, clearance_m);
        }
        if self.way_m <= 0.0 {
            // The obstacle is ahead.
            return self.free(heading_rad, step_m, clearance_m);
        }
        let direction = self.free(heading_rad + self.hand.sign() * BEHIND_RAD, step_m, clearance_m)?;
        self.turned_rad += self.hand.sign() * wrapped(direction - heading_rad);
        Some(direction)
    }

    /// The first free direction from `from_rad` on, away from the hand.
    fn free(&mut self, from_rad: f64, step_m: f64, clearance_m: impl Fn(f64) -> f64) -> Option<f64> {
        let direction = |i: u32| from_rad - self.hand.sign() * STEP_RAD * f64::from(i);
        let free = (0..DIRECTIONS).map(direction).find(|&direction| clearance_m(direction) >= step_m)?;
        self.way_m += step_m;
        Some(free)
    }

    /// Whether the robot leaves the boundary for `course_rad`, where the field is `value` and should be `level`: the course is
    /// free, and the field has grown since it met the obstacle, or it was all the way round in vain.
    pub(super) fn may_leave(
        &self,
        course_rad: f64,
        [value, level]: [f64; 2],
        step_m: f64,
        clearance_m: impl Fn(f64) -> f64,
    ) -> bool {
        let least = LEAST_GAIN * (level - self.met_at).abs();
        let pays = value > self.met_at + least || self.is_round;
        // Not at once, where it has just arrived.
        let has_moved = self.way_m > FREE_STEPS * step_m;
        pays && has_moved && clearance_m(course_rad) >= FREE_STEPS * step_m
    }

    /// The robot met the obstacle again soon after it had left it where the field was `value`.
    pub(super) fn met_again(&mut self, value: f64) {
        self.met_at = self.met_at.max(value);
        self.way_m = 0.0;
    }
}
