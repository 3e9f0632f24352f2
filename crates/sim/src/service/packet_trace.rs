//! The trace of a packet: everything that its link did with it.

use std::time::Duration;

use sextant_channel::{Db, Dbm};
use sextant_kernel::{SimTime, StationId};

use super::network_id::NetworkId;
use super::outcome::FrameOutcome;
use super::report::{Destination, SendOutcome};

/// What a packet is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketKind {
    /// A data frame of IEEE 802.15.4.
    Data,
    /// A payload to all by a sweep of sectors: one frame from each.
    Broadcast,
    /// A sweep of sectors.
    Sweep,
    /// The answer to a sweep: one frame from each sector.
    Answer,
}

impl PacketKind {
    /// Its name in recordings: `data`, `broadcast`, `sweep`, `answer`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Data => "data",
            Self::Broadcast => "broadcast",
            Self::Sweep => "sweep",
            Self::Answer => "answer",
        }
    }
}

/// How the link ended its work on a packet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketEnd {
    /// It was sent to all.
    Sent,
    /// It was sent, and the answer to it came.
    Acknowledged,
    /// It was sent as often as allowed, and no answer came.
    NoAcknowledgement,
    /// The channel was busy too often, before the first transmission or before another one.
    ChannelAccessFailure,
    /// The transmit queue was full.
    QueueFull,
    /// Its station died.
    Died,
    /// It had not ended at the end of the simulation.
    Pending,
}

impl PacketEnd {
    /// Its name in recordings: `sent`, `acknowledged`, `no_acknowledgement`, `channel_access_failure`, `queue_full`,
    /// `died`, `pending`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sent => "sent",
            Self::Acknowledged => "acknowledged",
            Self::NoAcknowledgement => "no_acknowledgement",
            Self::ChannelAccessFailure => "channel_access_failure",
            Self::QueueFull => "queue_full",
            Self::Died => "died",
            Self::Pending => "pending",
        }
    }

    /// As what a packet counts that its link has not ended, with this best outcome so far: one that was received counts so.
    pub(crate) fn fate_of_left(self, outcome: FrameOutcome) -> PacketFate {
        match (self, outcome) {
            (_, FrameOutcome::Received) => PacketFate::Sent(outcome),
            (Self::Died, _) => PacketFate::Died,
            _ => PacketFate::Pending,
        }
    }
}

impl From<SendOutcome> for PacketEnd {
    fn from(outcome: SendOutcome) -> Self {
        match outcome {
            SendOutcome::Sent => Self::Sent,
            SendOutcome::Acknowledged => Self::Acknowledged,
            SendOutcome::NoAcknowledgement => Self::NoAcknowledgement,
            SendOutcome::ChannelAccessFailure => Self::ChannelAccessFailure,
        }
    }
}

/// As what a packet counts: see [`Packets`](super::packets::Packets).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PacketFate {
    /// It was sent, or strobes that announced it were, with this best outcome.
    Sent(FrameOutcome),
    /// Never sent: the channel was busy too often.
    LostChannelAccess,
    /// Never sent: the transmit queue was full.
    LostQueue,
    /// Still in a MAC or in its queue when its station died.
    Died,
    /// Still in a MAC or in its queue at the end.
    Pending,
}

impl PacketFate {
    /// Its name in recordings, that of its count in the summary: `received`, `lost_collision`, `lost_signal`,
    /// `out_of_range`, `not_listened`, `lost_channel_access`, `lost_queue`, `died`, `pending`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Sent(FrameOutcome::Received) => "received",
            Self::Sent(FrameOutcome::Collided) => "lost_collision",
            Self::Sent(FrameOutcome::Weak) => "lost_signal",
            Self::Sent(FrameOutcome::OutOfRange) => "out_of_range",
            Self::Sent(FrameOutcome::NotListened(_)) => "not_listened",
            Self::LostChannelAccess => "lost_channel_access",
            Self::LostQueue => "lost_queue",
            Self::Died => "died",
            Self::Pending => "pending",
        }
    }
}

/// A clear channel assessment, with the backoff before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AssessmentTrace {
    /// Start of the backoff; that of the assessment if none preceded it, as before the second one of slotted access.
    pub backoff: SimTime,
    /// Start of the assessment.
    pub start: SimTime,
    /// Whether it found the channel busy.
    pub busy: bool,
}

/// A transmission of a packet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransmissionTrace {
    /// Number of the attempt, from zero. Copies of a frame in one attempt, which wake a receiver, share it.
    pub attempt: u32,
    /// First symbol on air.
    pub start: SimTime,
    /// Time on air.
    pub airtime: Duration,
    /// The outcome at the station that it is for, or the best one if it is for all.
    pub outcome: FrameOutcome,
    /// The station with that outcome, if it heard a signal.
    pub receiver: Option<StationId>,
    /// Power there.
    pub power: Option<Dbm>,
    /// Least ratio of signal to interference and noise there while the receiver followed the frame; the ratio to the noise
    /// alone if it followed another frame.
    pub sinr: Option<Db>,
    /// If another signal destroyed it, the station whose signal was the strongest one there during the frame. `None`
    /// if that was no station of the band.
    pub collided_with: Option<StationId>,
    /// End of its acknowledgement, if that was received.
    pub acknowledged: Option<SimTime>,
}

/// Everything that a link did with a packet.
#[derive(Clone, Debug, PartialEq)]
pub struct PacketTrace {
    /// The network in which it was offered.
    pub network: NetworkId,
    /// The station that offered it: nodes come first, then robots, then sinks.
    pub source: StationId,
    /// What it is.
    pub kind: PacketKind,
    /// Number among the packets of this kind that its station offered, from zero.
    pub number: u32,
    /// Sequence number on the air, if it has one and was first in its queue.
    pub sequence: Option<u8>,
    /// To whom it goes.
    pub to: Destination,
    /// Size of its frame with header and check sequence (octets).
    pub octets: u16,
    /// When it was offered.
    pub offered: SimTime,
    /// Whether it counts in the summary: it was offered after the warm-up.
    pub counts: bool,
    /// When it was first in its queue.
    pub begun: Option<SimTime>,
    /// The assessments of the channel, in their order.
    pub assessments: Vec<AssessmentTrace>,
    /// The transmissions that have ended, in their order.
    pub transmissions: Vec<TransmissionTrace>,
    /// End of the first transmission that was received.
    pub delivered: Option<SimTime>,
    /// Energy of the transmitter in these transmissions (J).
    pub tx_energy_j: f64,
    /// How the link ended its work.
    pub end: PacketEnd,
    /// When it did; for a pending packet, the end of the simulation.
    pub ended: SimTime,
    /// As what it counts.
    pub fate: PacketFate,
    /// Payload of a data frame; empty if it says nothing.
    pub payload: Vec<u8>,
}

impl PacketTrace {
    /// How often it was sent: copies in one attempt are one transmission.
    #[must_use]
    pub fn attempts(&self) -> u32 {
        self.transmissions.last().map_or(0, |last| last.attempt + 1)
    }

    /// Time from its offer to the end of the first transmission that was received.
    #[must_use]
    pub fn delay(&self) -> Option<Duration> {
        self.delivered.map(|delivered| delivered - self.offered)
    }
}
