//! What an engine leaves behind.

use sextant_channel::ReceptionLog;
use sextant_kernel::SimTime;

use crate::faults::Death;
use crate::service::packets::NetworkRecord;
use crate::service::sensed::Sensations;

/// What an engine leaves behind.
#[derive(Debug)]
pub struct Ended<A> {
    /// The applications, by station.
    pub applications: Vec<A>,
    /// What the robots wrote into the log of each network.
    pub logs: Vec<ReceptionLog>,
    /// Length of the path of each robot (m).
    pub path_lengths_m: Vec<f64>,
    /// What became of the packets in each network, and of the energy.
    pub networks: Vec<NetworkRecord>,
    /// When it ended.
    pub end: SimTime,
    /// Number of events.
    pub events: u64,
    /// What the sensors of the nodes said.
    pub sensed: Sensations,
    /// The nodes that died, in the order of their deaths.
    pub deaths: Vec<Death>,
    /// Whether the observer ended it.
    pub interrupted: bool,
}
