//! What a simulation is like between two of its events.

use sextant_kernel::SimTime;

use crate::service::packets::Packets;
use crate::station::RobotPose;

/// How far a simulation has gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reached {
    /// The time; where the simulation has ended, its end.
    pub time: SimTime,
    /// Whether it has ended: by itself, or because an observer ended it.
    pub has_ended: bool,
}

/// What a simulation is like at one time: what happens at that instant is still to come.
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The time; where the simulation has ended, its end.
    pub time: SimTime,
    /// Whether it has ended: by itself, or because an observer ended it.
    pub has_ended: bool,
    /// The robots.
    pub robots: Vec<RobotSnapshot>,
    /// Number of stops so far, of all robots.
    pub stops: usize,
    /// Number of pairs of a stop and a node that was heard there.
    pub receptions: usize,
    /// Number of nodes heard at least once.
    pub nodes_heard: usize,
    /// What became of the packets of all nodes so far. Those that were not simulated, because nobody was near, join them at
    /// the end.
    pub packets: Packets,
}

/// A robot at one time.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotSnapshot {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub pose: RobotPose,
}
