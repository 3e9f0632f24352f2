//! The result of a simulation.

use sextant_channel::{NetworkLogs, ReceptionLog};
use sextant_kernel::SimTime;
use sextant_mac::EnergySpent;

use crate::applications::controller::{Ending, StopsLeftOut};
use crate::batteries::BatteryRecord;
use crate::faults::Death;
use crate::halo::SimulatedPart;
use crate::service::packets::{NetworkRecord, Packets};
use crate::service::sensed::Sensations;
use crate::station::RobotPose;

/// The result of a simulation: everything that robots heard, and the outcomes of the packets.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The logs of the robots in the networks that they survey: everything that a mapper may know.
    pub logs: NetworkLogs,
    /// A record of each robot.
    pub robots: Vec<RobotRecord>,
    /// The outcomes of the packets of all nodes together, with estimates for those that were not simulated.
    pub packets: Packets,
    /// Energy of the radios of all nodes together.
    pub energy: EnergySpent,
    /// What became of the packets in each network, and of the energy, by station.
    pub networks: Vec<NetworkRecord>,
    /// What the sensors of the nodes said.
    pub sensed: Sensations,
    /// The nodes that died, in the order of their deaths.
    pub deaths: Vec<Death>,
    /// What is left of the batteries, by node; empty if there are none.
    pub batteries: Vec<BatteryRecord>,
    /// Time at which the last robot finished, or the time was over.
    pub end: SimTime,
    /// Number of events.
    pub events: u64,
    /// What was simulated of the nodes' traffic.
    pub simulated: SimulatedPart,
    /// Whether an observer ended the simulation early.
    pub interrupted: bool,
}

impl Survey {
    /// The log of the robots in the first network that they survey.
    #[must_use]
    pub fn log(&self) -> &ReceptionLog {
        self.logs.first()
    }
}

/// The record of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotRecord {
    /// Its name.
    pub name: String,
    /// Number of stops to listen, or of a mobile anchor to send; with another application, of those in the logs.
    pub stops: usize,
    /// Length of its path (m).
    pub path_length_m: f64,
    /// Why it finished; `None` if it was interrupted, or has another application.
    pub ending: Option<Ending>,
    /// Time at which it finished.
    pub end: Option<SimTime>,
    /// Number of packets that it heard from each node while it surveyed.
    pub packets: Vec<u32>,
    /// Stops of its planned path that were left out.
    pub left_out: StopsLeftOut,
    /// Where it is at the end of the simulation.
    pub end_pose: RobotPose,
}
