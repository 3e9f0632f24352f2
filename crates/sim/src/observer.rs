//! Who watches a simulation.

use std::time::Duration;

use sextant_channel::{Contact, Dbm, Position, Reception, Stop};
use sextant_kernel::{NodeId, SimTime};

use crate::FrameOutcome;

/// A frame that was on air.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameOnAir<'a> {
    /// First symbol on air.
    pub start: SimTime,
    /// Time on air.
    pub airtime: Duration,
    /// Who sent it; robots are numbered after the nodes.
    pub source: NodeId,
    /// The MAC frame (MPDU), check sequence included.
    pub bytes: &'a [u8],
    /// The best that became of it at any robot; of a frame that a robot sent, at any node.
    pub outcome: FrameOutcome,
    /// Power at that station [dBm], where a signal was measured.
    pub power: Option<Dbm>,
    /// The robots that received it, by number.
    pub heard: &'a [HeardFrame],
}

/// A frame at a robot that received it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardFrame {
    /// Which robot.
    pub robot: usize,
    /// Power there [dBm].
    pub power: Dbm,
}

/// Watches a simulation while it runs: a recording, a progress bar. What it does not override is not told.
pub trait Observer {
    /// A robot is at `position` at `time`: where a drive begins or ends.
    fn moved(&mut self, _robot: usize, _time: SimTime, _position: Position) {}

    /// A robot met an obstacle.
    fn met(&mut self, _contact: Contact) {}

    /// A robot has listened at stop `index` of the log, from `stop.time` until `end`, and heard `receptions`.
    fn stopped(&mut self, _index: u32, _stop: &Stop, _end: SimTime, _receptions: &[Reception]) {}

    /// A frame was on air; told at its end, and only if [`Observer::wants_frames`].
    fn framed(&mut self, _frame: FrameOnAir<'_>) {}

    /// Whether frames are to be told.
    fn wants_frames(&self) -> bool {
        false
    }

    /// Asked after each stop; `false` ends the simulation there.
    fn goes_on(&mut self, _progress: Progress) -> bool {
        true
    }
}

/// How far a simulation is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Progress {
    /// Now.
    pub time: SimTime,
    /// Stops so far, of all robots.
    pub stops: usize,
    /// Nodes heard at least once.
    pub nodes_heard: usize,
    /// All nodes.
    pub nodes: usize,
}

/// Watches nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Unobserved;

impl Observer for Unobserved {}
