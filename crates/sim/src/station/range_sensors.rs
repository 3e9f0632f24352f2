//! The range sensors of a robot.

use sextant_channel::{ObstacleField, Position};

/// The range sensors of a robot: they are where the robot really is, and measure in directions that the robot knows by
/// its odometry.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RangeSensors<'a> {
    pub(crate) obstacles: &'a ObstacleField,
    /// Radius of the robot's hull (m).
    pub(crate) radius_m: f64,
    /// Where they are (m).
    pub(crate) place: Position,
    /// Angle from where the robot believes to look to where it looks, counterclockwise (rad).
    pub(crate) turn_rad: f64,
}

impl RangeSensors<'_> {
    /// How far the robot could drive straight in `direction` (of any length above zero) before its hull touches an
    /// obstacle (m), at most `range_m`.
    pub(crate) fn clearance_m(&self, direction: Position, range_m: f64) -> f64 {
        self.obstacles.clearance_m(self.place, direction.turned(self.turn_rad), range_m, self.radius_m)
    }
}
