//! The result of a simulation.

use sextant_channel::ReceptionLog;
use sextant_kernel::SimTime;
use sextant_mac::EnergySpent;

use crate::Ending;

/// The result of a simulation: everything that robots heard, and the outcomes of the packets.
#[derive(Clone, Debug)]
pub struct Survey {
    /// The log of the robots: everything that a mapper may know.
    pub log: ReceptionLog,
    /// A record of each robot.
    pub robots: Vec<RobotRecord>,
    /// The outcomes of the packets.
    pub packets: Packets,
    /// Energy of the radios of all nodes together.
    pub energy: EnergySpent,
    /// Time at which the last robot finished.
    pub end: SimTime,
    /// Number of events.
    pub events: u64,
    /// Whether an observer ended the simulation early.
    pub interrupted: bool,
}

/// The record of a robot.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotRecord {
    /// Its name.
    pub name: String,
    /// Number of stops to listen.
    pub stops: usize,
    /// Length of its path (m).
    pub path_length_m: f64,
    /// Why it finished; `None` if it was interrupted.
    pub ending: Option<Ending>,
    /// Time at which it finished.
    pub end: Option<SimTime>,
    /// Number of packets that it heard from each node while it listened.
    pub packets: Vec<u32>,
}

/// The outcomes of the packets. Each packet offered is counted once: `offered` is the sum of
/// `lost_channel_access`, `lost_queue`, `pending`, `received`, `lost_collision`, `lost_signal`, `out_of_range` and
/// `not_listened`. With several robots, or several transmissions of one packet, the best outcome counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Packets {
    /// Given to a MAC by a node's application.
    pub offered: u64,
    /// Sent at least once.
    pub sent: u64,
    /// Received by a robot.
    pub received: u64,
    /// A robot listened, but another signal destroyed the packet.
    pub lost_collision: u64,
    /// Never sent: the channel was busy too often.
    pub lost_channel_access: u64,
    /// Never sent: the node had not finished the previous packet.
    pub lost_queue: u64,
    /// A robot listened in range, but the signal was too weak.
    pub lost_signal: u64,
    /// All robots that listened were beyond the radius of communication.
    pub out_of_range: u64,
    /// No robot listened.
    pub not_listened: u64,
    /// Still in a MAC at the end.
    pub pending: u64,
    /// Given up because of a busy channel, retransmissions included: those in `lost_channel_access`, and those that
    /// were on air before. Not part of the sum.
    pub channel_access_failures: u64,
}
