//! What is read from the files of a robot.

use sextant_channel::ReceptionLog;

use super::doctor::{ClockOffset, Finding};
use crate::place::local_plane::LocalPlane;

/// What is read from the files of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotLog {
    /// The reception log.
    pub log: ReceptionLog,
    /// The plane of its places, if they are given by latitude and longitude.
    pub plane: Option<LocalPlane>,
    /// What the user should know about how it was read.
    pub notes: Vec<String>,
    /// What is odd in it.
    pub findings: Vec<Finding>,
    /// How late the packets are by the clock of the path, if both were read and tell it.
    pub clock: Option<ClockOffset>,
}
