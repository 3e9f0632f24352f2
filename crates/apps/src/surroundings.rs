//! What a robot has round it when it starts.

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::Seed;

/// What a robot has round it when it starts, and where its randomness comes from. Controllers with a planned path look
/// at the obstacles, others do not.
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
    /// Number of the robot in its scenario: the address of its random draws.
    pub robot: u64,
}
