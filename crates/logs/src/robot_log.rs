//! What is read from the files of a robot.

use std::collections::BTreeMap;

use sextant_channel::ReceptionLog;
use sextant_kernel::{RobotId, SimTime};

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
    /// The middle of the time of each stop that is a part of a path, by its robot and its start: the place of such a stop is the mean
    /// over its time. Empty if robots stood at their stops.
    pub middles: BTreeMap<(RobotId, SimTime), SimTime>,
    /// The name of the file whose odometry is the path, if it is one: odometry drifts.
    pub odometry: Option<String>,
}
