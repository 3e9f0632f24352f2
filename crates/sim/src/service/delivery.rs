//! What an application gets.

use sextant_channel::{Db, Dbm, Position};
use sextant_kernel::StationId;

use super::network_id::NetworkId;

/// A frame that was received for a station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delivery<'a> {
    /// The network in which it was received.
    pub network: NetworkId,
    /// The station that sent it.
    pub from: StationId,
    /// Sequence number of the frame; all frames of a broadcast by a sector sweep have the same.
    pub sequence: u8,
    /// What it carries.
    pub payload: &'a [u8],
    /// Power at the receiver.
    pub rssi: Dbm,
    /// The sector from which it was sent, by its identity in logs ([`Antenna::identity`](sextant_channel::Antenna::identity));
    /// `None` if the sender's antenna has no sectors, or the network no sector sweeps.
    pub sector: Option<u8>,
    /// Ratio of signal to interference and noise at which it was received; `None` in a network without sector sweeps.
    pub snr: Option<Db>,
}

/// How a drive ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveEnd {
    /// The robot is at its destination.
    Arrived,
    /// An obstacle is in the way, and the robot has stopped in front of it. The point of contact on the obstacle (m).
    Blocked(Position),
}
