//! How frames are sent, and how they end.

use sextant_kernel::{SimTime, StationId};

/// To whom a frame goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Destination {
    /// All stations of the network that hear it.
    All,
    /// One station, which must acknowledge it.
    Station(StationId),
}

/// What a frame carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Payload<'a> {
    /// These octets.
    Octets(&'a [u8]),
    /// Octets that say nothing, so that the MPDU has this size (octets). In a broadcast by a sector sweep each frame has it:
    /// at least 41 octets.
    Filler(u8),
}

/// Number of a frame among those that its station was given to send, from zero.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct FrameId(pub u32);

/// Why a frame is not taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SendError {
    /// The transmit queue is full: the frame is lost.
    #[error("the transmit queue is full: it holds {0} frames beside the one under way")]
    QueueFull(usize),
    /// The payload is too large.
    #[error("the payload has {found} octets; allowed: at most {allowed}")]
    Oversized {
        /// Its size (octets).
        found: usize,
        /// The largest size (octets).
        allowed: usize,
    },
    /// The frame goes to its own sender, or to a station that is not there.
    #[error("{0} cannot receive the frame")]
    NoSuchStation(StationId),
    /// The station is not in this network, or has no means to send: with beacons, only nodes send data.
    #[error("this station sends no data in this network")]
    ReceivesOnly,
    /// The network has no channel access: programs command its radios.
    #[error("the network has no channel access: with `mac.program`, programs command the radios")]
    NoChannelAccess,
    /// A frame of this size has no room for its header.
    #[error("the frame has {found} octets; allowed: at least {allowed}")]
    Undersized {
        /// Its size (octets).
        found: usize,
        /// The smallest size (octets).
        allowed: usize,
    },
    /// The links of the network sweep sectors; they carry data to all, and not to one station.
    #[error("this network sweeps sectors and carries data to all stations only; the frame is for {0}")]
    BroadcastsOnly(StationId),
}

/// How a frame ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SendOutcome {
    /// It was sent to all; who heard it is not known.
    Sent,
    /// It was sent and acknowledged.
    Acknowledged,
    /// It was sent as often as allowed and never acknowledged.
    NoAcknowledgement,
    /// The channel was busy too often.
    ChannelAccessFailure,
}

/// The end of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SendReport {
    /// The frame.
    pub frame: FrameId,
    /// To whom it went.
    pub to: Destination,
    /// How it ended.
    pub outcome: SendOutcome,
    /// Number of attempts. It differs from the transmissions where a receiver is woken first: one that does not answer costs
    /// an attempt, and the frame is not sent.
    pub attempts: u32,
    /// Number of transmissions.
    pub transmissions: u32,
    /// When the application gave it to the link.
    pub offered: SimTime,
}
