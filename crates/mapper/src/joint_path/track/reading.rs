//! What tells of a tag: ranges and strengths between it and receivers.

use sextant_channel::{Mounting, Position};
use sextant_kernel::SimTime;

/// What was measured between a receiver and a tag.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TagReading {
    /// The number of the receiver.
    pub receiver: usize,
    /// When it was measured.
    pub time: SimTime,
    /// What was measured.
    pub value: TagValue,
    /// Where odometry has the robot that carries the tag, if it has some: of all readings of a track, or of none.
    pub on_robot: Option<OnRobot>,
}

/// A measured value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TagValue {
    /// A distance (m).
    Range(f64),
    /// The strength of a packet (dBm). A channel is reciprocal, so it does not matter which end sent it.
    Strength(f64),
}

/// An antenna on a robot with odometry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnRobot {
    /// Where odometry has the robot (m).
    pub believed: Position,
    /// Where the antenna is on it; the arm is in the frame of odometry.
    pub mounting: Mounting,
}

impl TagReading {
    /// A range without odometry.
    #[must_use]
    pub const fn range(receiver: usize, time: SimTime, range_m: f64) -> Self {
        Self { receiver, time, value: TagValue::Range(range_m), on_robot: None }
    }

    /// A strength without odometry.
    #[must_use]
    pub const fn strength(receiver: usize, time: SimTime, rssi_dbm: f64) -> Self {
        Self { receiver, time, value: TagValue::Strength(rssi_dbm), on_robot: None }
    }

    /// What readings of one moment must have in common to be one: receiver, kind, antenna.
    pub(super) fn series(&self) -> (usize, bool, u32) {
        let is_strength = matches!(self.value, TagValue::Strength(_));
        (self.receiver, is_strength, self.on_robot.map_or(0, |on_robot| on_robot.mounting.antenna))
    }

    /// The value as a number, in its unit.
    pub(super) fn number(&self) -> f64 {
        match self.value {
            TagValue::Range(number) | TagValue::Strength(number) => number,
        }
    }
}
