//! Frames and packets of programs.

use sextant_kernel::{SimTime, StationId};

use crate::link::track::PacketTrack;
use crate::service::outcome::FrameOutcome;
use crate::service::report::{Destination, FrameId};

/// A frame that a program sends: a data frame of IEEE 802.15.4.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RadioFrame<'a> {
    /// For whom it is.
    pub to: Destination,
    /// What it carries: at most 116 octets between short addresses.
    pub payload: &'a [u8],
    /// Whether it asks the station that it is for to acknowledge it.
    pub acknowledged: bool,
    /// The packet that it carries; none if it is a part of the protocol of the program.
    pub packet: Option<FrameId>,
}

/// A frame that waits for its instant or is on air.
#[derive(Clone, Copy, Debug)]
pub(super) struct Outgoing {
    pub(super) to: Destination,
    /// The slot of its payload.
    pub(super) payload: u32,
    pub(super) sequence: u8,
    pub(super) acknowledged: bool,
    pub(super) packet: Option<FrameId>,
}

/// A packet that a program carries.
#[derive(Debug)]
pub(super) struct OpenPacket {
    pub(super) id: FrameId,
    pub(super) to: Destination,
    pub(super) sequence: u8,
    pub(super) mpdu_octets: u8,
    pub(super) offered: SimTime,
    pub(super) transmissions: u32,
    pub(super) assessments: u32,
    /// The best outcome of its transmissions.
    pub(super) outcome: FrameOutcome,
    /// The stations to which it was delivered.
    pub(super) delivered: Vec<StationId>,
    pub(super) track: Option<Box<PacketTrack>>,
}
