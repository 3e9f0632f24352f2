//! Whether the places of several robots are in one frame.

/// The frames of coordinates of the robots of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RobotFrames {
    /// All robots have one.
    #[default]
    Shared,
    /// Each robot has its own. The places of two robots are not compared, so what is odd is looked for in the part of each.
    OfEachRobot,
}
