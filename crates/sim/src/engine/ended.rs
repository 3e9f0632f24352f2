//! What an engine leaves behind.

use sextant_channel::ReceptionLog;
use sextant_kernel::SimTime;

use crate::batteries::BatteryRecord;
use crate::faults::Death;
use crate::link::books::Books;
use crate::service::sensed::Sensations;
use crate::station::RobotPose;

/// What an engine leaves behind.
#[derive(Debug)]
pub(crate) struct Ended<A> {
    /// The applications, by station.
    pub(crate) applications: Vec<A>,
    /// What the robots wrote into the log of each network.
    pub(crate) logs: Vec<ReceptionLog>,
    /// Length of the path of each robot (m).
    pub(crate) path_lengths_m: Vec<f64>,
    /// Where each robot is at the end.
    pub(crate) end_poses: Vec<RobotPose>,
    /// What became of the packets in each network, and of the energy.
    pub(crate) networks: Vec<Books>,
    /// When it ended.
    pub(crate) end: SimTime,
    /// Number of events.
    pub(crate) events: u64,
    /// What the sensors of the nodes said.
    pub(crate) sensed: Sensations,
    /// The nodes that died, in the order of their deaths.
    pub(crate) deaths: Vec<Death>,
    /// What is left of the batteries, by node; empty without batteries.
    pub(crate) batteries: Vec<BatteryRecord>,
    /// Radius of the halos (m), if nodes rested beyond those of the listeners.
    pub(crate) halo_m: Option<f64>,
    /// Whether the observer ended it.
    pub(crate) interrupted: bool,
}
