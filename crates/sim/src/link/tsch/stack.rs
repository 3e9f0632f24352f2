//! The state of one station's link.

use sextant_channel::Dbm;
use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::tsch::{Asn, Chance, Msf, Schedule, Sender, SlotClock};

use super::usage::Usage;
use crate::air::Transmission;
use crate::link::ieee802154::DataPacket;
use crate::link::payloads::Content;
use crate::link::track::PacketTrack;
use crate::link::tsch::cell_history::CellHistory;
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::report::{Destination, FrameId};

/// What a frame is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FrameKind {
    /// A packet of the application.
    Data,
    /// An empty frame to the time source.
    KeepAlive,
    /// An enhanced beacon.
    Beacon,
    /// A message about cells.
    SixP(SixPRole),
}

/// What a message about cells is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SixPRole {
    /// It asks.
    Request,
    /// It says yes: cells change when it is acknowledged.
    Answer,
    /// It says no.
    Refusal,
}

/// A frame that waits or is under way.
#[derive(Debug)]
pub(super) struct SlotFrame {
    pub(super) kind: FrameKind,
    pub(super) id: FrameId,
    pub(super) to: Destination,
    pub(super) content: Content,
    pub(super) mpdu_octets: u8,
    pub(super) offered: SimTime,
    pub(super) sequence: u8,
    pub(super) transmissions: u32,
    /// The best outcome of its transmissions.
    pub(super) outcome: FrameOutcome,
    pub(super) track: Option<Box<PacketTrack>>,
}

impl SlotFrame {
    /// The packet, as it is counted and traced.
    pub(super) fn packet(&self) -> DataPacket {
        let &Self { id, sequence, to, mpdu_octets, offered, .. } = self;
        DataPacket { id, sequence: Some(sequence), to, mpdu_octets, offered }
    }
}

/// The slot in which a station sends next.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planned {
    pub(super) chance: Chance,
    pub(super) at: SimTime,
    pub(super) key: EventKey,
}

/// What a station sends in its slot, from the first symbol of its frame to the end of what follows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sending {
    pub(super) chance: Chance,
    /// The place of its channel in the sequence.
    pub(super) place: usize,
    /// The frame on air; `None` while it waits for an acknowledgement.
    pub(super) transmission: Option<Transmission>,
    /// The pending end of that wait, if no acknowledgement is under way.
    pub(super) missed: Option<EventKey>,
}

/// A slot in which a station listens and somebody sends on its channel.
#[derive(Clone, Copy, Debug)]
pub(super) struct Listening {
    pub(super) asn: Asn,
    pub(super) opened: SimTime,
    pub(super) closes: SimTime,
    /// The end of the frame that the receiver was locked on to.
    pub(super) followed: Option<SimTime>,
    /// Whether it acknowledges a frame.
    pub(super) answers: bool,
}

/// An acknowledgement that a station sends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Answer {
    pub(super) to: StationId,
    pub(super) place: usize,
    pub(super) sequence: u8,
    pub(super) correction_us: i16,
    /// The pending start.
    pub(super) starts: Option<EventKey>,
    pub(super) transmission: Option<Transmission>,
}

/// Whether a station is in the network.
#[derive(Clone, Copy, Debug)]
pub(super) enum Membership {
    /// It follows the slots.
    Joined,
    /// It listens for an enhanced beacon.
    Scanning {
        /// The place in the sequence of the channel on which it listens.
        place: usize,
        /// The pending change to another one.
        change: EventKey,
    },
    /// It is not there, or has died.
    Out,
}

/// The state of one station's link.
pub(super) struct Stack {
    pub(super) clock: SlotClock,
    pub(super) tx_power: Dbm,
    pub(super) membership: Membership,
    /// The station that its clock follows.
    pub(super) time_source: Option<StationId>,
    /// How far it is from a sink, in time sources.
    pub(super) join_metric: u8,
    /// When its clock was last corrected.
    pub(super) corrected: SimTime,
    pub(super) schedule: Schedule,
    /// The cells of the schedules that it followed so far.
    pub(super) history: CellHistory,
    /// The station with which it agrees on cells.
    pub(super) parent: Option<StationId>,
    /// How it agrees on them, if it does, ...
    pub(super) msf: Option<Box<Msf>>,
    /// ... and when it acts on them next, with the pending event.
    pub(super) agreement: Option<(SimTime, EventKey)>,
    pub(super) sender: Sender<SlotFrame>,
    pub(super) planned: Option<Planned>,
    /// The last slot in which it sent.
    pub(super) used: Option<Asn>,
    pub(super) sending: Option<Sending>,
    pub(super) listening: Option<Listening>,
    pub(super) answer: Option<Answer>,
    /// Why the air of its present channel knows the receiver as deaf; in all others it is asleep.
    pub(super) deafness: Option<Deafness>,
    /// Whether an empty frame to its time source waits.
    pub(super) keeps_alive: bool,
    /// Whether its next beacon is pending.
    pub(super) beacons: bool,
    /// The pending look at its clock.
    pub(super) check: Option<EventKey>,
    /// Sequence number of the newest frame.
    pub(super) sequence: u8,
    /// Number of packets offered so far.
    pub(super) frames: u32,
    /// Number of back-offs drawn so far.
    pub(super) backoffs: u64,
    /// Number of other draws so far.
    pub(super) draws: u64,
    pub(super) is_traced: bool,
    pub(super) usage: Usage,
}

impl Stack {
    /// Whether it follows the slots.
    #[inline]
    pub(super) fn is_joined(&self) -> bool {
        matches!(self.membership, Membership::Joined)
    }

    /// Whether it has a frame or an acknowledgement on air.
    pub(super) fn is_on_air(&self) -> bool {
        self.sending.is_some_and(|sending| sending.transmission.is_some())
            || self.answer.is_some_and(|answer| answer.transmission.is_some())
    }

    /// The next number of a frame.
    pub(super) fn next_sequence(&mut self) -> u8 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }
}
