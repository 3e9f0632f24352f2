//! The surroundings of a robot when it starts.

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::Seed;

/// The surroundings of a robot when it starts, and the source of its random draws. Only controllers that plan their
/// path use the obstacles.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// The obstacles.
    pub obstacles: &'a ObstacleField,
    /// Where the robot starts (m).
    pub start: Position,
    /// Radius of its hull (m).
    pub radius_m: f64,
    /// Seed of the run.
    pub seed: Seed,
    /// Number of the robot in its scenario. It selects the random draws of this robot.
    pub robot: u64,
}
