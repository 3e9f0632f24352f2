//! What is read from the files of a robot.

use sextant_channel::ReceptionLog;

use super::local_plane::LocalPlane;

/// What is read from the files of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLog {
    /// The reception log.
    pub log: ReceptionLog,
    /// The plane of its places, if they are given by latitude and longitude.
    pub plane: Option<LocalPlane>,
    /// What the user should know about how it was read.
    pub notes: Vec<String>,
}
