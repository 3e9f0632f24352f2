//! The drives of robots between their stops.

use sextant_kernel::RobotId;

use crate::geometry::position::Position;

/// The straight line from a stop of a robot to its next one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// The robot that drove.
    pub robot: RobotId,
    /// The earlier stop (m).
    pub from: Position,
    /// The later stop (m).
    pub to: Position,
}

impl Drive {
    /// Length of the line (m).
    #[must_use]
    pub fn length_m(&self) -> f64 {
        self.from.distance_m(self.to)
    }
}
