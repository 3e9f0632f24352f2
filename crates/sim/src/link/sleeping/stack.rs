//! The state of one station's link.

use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

use sextant_channel::{Dbm, Milliwatts};
use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::sleep::{Sent, Sleeper};

use super::checks::Checks;
use super::usage::Usage;
use crate::air::Transmission;
use crate::link::ieee802154::DataPacket;
use crate::link::payloads::Content;
use crate::link::track::PacketTrack;
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::report::{Destination, FrameId};

/// A packet that waits or is under way.
#[derive(Debug)]
pub(super) struct OpenFrame {
    pub(super) id: FrameId,
    pub(super) to: Destination,
    pub(super) content: Content,
    pub(super) mpdu_octets: u8,
    pub(super) offered: SimTime,
    pub(super) sequence: u8,
    /// Attempts in which something was sent.
    pub(super) attempts: u32,
    /// The last attempt in which the packet itself was sent, and not only what wakes its receiver, ...
    pub(super) sent_in: Option<u32>,
    /// ... and the number of these.
    pub(super) transmissions: u32,
    /// How often in succession the channel was busy.
    pub(super) busy: u32,
    /// How often the channel was looked at before an attempt.
    pub(super) looks: u32,
    /// The best outcome so far.
    pub(super) outcome: FrameOutcome,
    /// Those to which a packet to all was delivered.
    pub(super) delivered: Vec<StationId>,
    pub(super) track: Option<Box<PacketTrack>>,
}

impl OpenFrame {
    /// The packet, as it is counted and traced.
    pub(super) fn packet(&self) -> DataPacket {
        let &Self { id, sequence, to, mpdu_octets, offered, .. } = self;
        DataPacket { id, sequence: Some(sequence), to, mpdu_octets, offered }
    }
}

/// What a station does for the packet that is first in its queue.
#[derive(Clone, Copy, Debug)]
pub(super) enum Work {
    /// Nothing: it waits until the station is free.
    None,
    /// It waits before the next attempt.
    BackingOff(EventKey),
    /// It waits until its receiver is about to wake up.
    Aiming {
        key: EventKey,
        /// From the start of its first frame to that of the last one, at most.
        span: Duration,
    },
    /// The protocol machine sends it.
    Sending,
}

/// What a station has on air.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnAir {
    pub(super) transmission: Transmission,
    pub(super) sent: Sent,
}

/// A check that will take place, because somebody sends in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PlannedCheck {
    pub(super) number: u64,
    pub(super) key: EventKey,
}

/// What a sender knows of a receiver.
#[derive(Clone, Copy, Debug)]
pub(super) struct KnownPhase {
    /// An instant at which the receiver was about to be reached, by true time: it comes again at each interval.
    pub(super) at: SimTime,
    /// When it was told.
    pub(super) told: SimTime,
}

/// The state of one station's link.
pub(super) struct Stack {
    pub(super) sleeper: Sleeper,
    pub(super) checks: Checks,
    /// Checks before this one are over: counted, or left out.
    pub(super) handled: u64,
    pub(super) planned: Option<PlannedCheck>,
    pub(super) timer: Option<EventKey>,
    /// Whether it is in the network, and alive.
    pub(super) is_there: bool,
    pub(super) tx_power: Dbm,
    pub(super) cca_threshold: Milliwatts,
    pub(super) usage: Usage,
    pub(super) deafness: Option<Deafness>,
    pub(super) waiting: VecDeque<OpenFrame>,
    pub(super) work: Work,
    pub(super) on_air: Option<OnAir>,
    /// When what it sent last began, acknowledgements apart.
    pub(super) last_start: SimTime,
    /// When its last acknowledgement began.
    pub(super) answer_start: SimTime,
    /// Whose frame it acknowledges, and its sequence number.
    pub(super) answered: Option<(StationId, u8)>,
    pub(super) phases: BTreeMap<StationId, KnownPhase>,
    /// Sequence number of the newest frame.
    pub(super) sequence: u8,
    /// Number of packets offered so far.
    pub(super) frames: u32,
    /// Number of waits drawn so far.
    pub(super) draws: u64,
    /// Whether the packet that is first in the queue waited while the station received something.
    pub(super) is_held: bool,
    pub(super) is_traced: bool,
}

impl Stack {
    /// The next number of a frame.
    pub(super) fn next_sequence(&mut self) -> u8 {
        self.sequence = self.sequence.wrapping_add(1);
        self.sequence
    }
}
