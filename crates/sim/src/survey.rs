//! What a simulation brought.

use sextant_channel::ReceptionLog;
use sextant_kernel::SimTime;
use sextant_mac::EnergySpent;

use crate::Ending;

/// What a simulation brought: all that robots heard, and what became of the packets.
#[derive(Clone, Debug)]
pub struct Survey {
    /// What the robots recorded: all that a mapper may know.
    pub log: ReceptionLog,
    /// What each robot did.
    pub robots: Vec<RobotRecord>,
    /// What became of the packets.
    pub packets: Packets,
    /// What the radios of all nodes spent together.
    pub energy: EnergySpent,
    /// When the last robot had finished.
    pub end: SimTime,
    /// Events that happened.
    pub events: u64,
    /// Whether an observer ended the simulation early.
    pub interrupted: bool,
}

/// What a robot did.
#[derive(Clone, Debug, PartialEq)]
pub struct RobotRecord {
    /// Its name.
    pub name: String,
    /// How often it stopped to listen.
    pub stops: usize,
    /// How far it drove [m].
    pub path_length_m: f64,
    /// Why it finished; `None` if it was interrupted.
    pub ending: Option<Ending>,
    /// When it finished.
    pub end: Option<SimTime>,
    /// Packets that it heard of each node while it listened.
    pub packets: Vec<u32>,
}

/// What became of the packets. Each packet offered ends in one place: `offered` is the sum of
/// `lost_channel_access`, `lost_queue`, `pending`, `received`, `lost_collision`, `lost_signal`, `out_of_range` and
/// `not_listened`. With several robots (or transmissions of one packet) the best fate counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Packets {
    /// Handed to a MAC by a node's application.
    pub offered: u64,
    /// Put on air at least once.
    pub sent: u64,
    /// Received by a robot.
    pub received: u64,
    /// A robot listened, but another signal destroyed the packet.
    pub lost_collision: u64,
    /// Never sent: the channel was busy too often.
    pub lost_channel_access: u64,
    /// Never sent: the node had not got rid of the packet before.
    pub lost_queue: u64,
    /// A robot listened in range, but the signal was too weak.
    pub lost_signal: u64,
    /// All robots that listened were beyond the radius of communication.
    pub out_of_range: u64,
    /// No robot listened.
    pub not_listened: u64,
    /// Still in a MAC at the end.
    pub pending: u64,
    /// Given up for a busy channel, retransmissions included: beyond `lost_channel_access` those that had been
    /// on air before. Not part of the sum.
    pub channel_access_failures: u64,
}
