//! The state of one station's link.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::tsch::{Asn, Chance, Msf, Schedule, Sender, SlotClock, SlotKind};
use sextant_mac::{EnergyMeter, RadioState};

use crate::air::Transmission;
use crate::link::payloads::Content;
use crate::link::track::{DataPacket, PacketTrack};
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::report::{Destination, FrameId};
use crate::service::slots::SlotUse;

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
    /// What a trace says of it.
    pub(super) fn packet(&self) -> DataPacket {
        let &Self { id, sequence, to, mpdu_octets, offered, .. } = self;
        DataPacket { id, sequence, to, mpdu_octets, offered }
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

/// How a radio was used since a slot, but for slots in which it listened and nobody sent.
#[derive(Clone, Copy, Debug)]
pub(super) struct Usage {
    pub(super) slots: SlotUse,
    transmitting: Duration,
    receiving: Duration,
    turning: Duration,
    since: SimTime,
    /// Slots count from this one on, ...
    from: Asn,
    /// ... and these of them are no longer those of the schedule: it sent in them, or somebody sent to it.
    taken: u64,
    /// When the scan under way began.
    scans_since: Option<SimTime>,
}

impl Usage {
    pub(super) fn new(since: SimTime, from: Asn) -> Self {
        Self {
            slots: SlotUse::default(),
            transmitting: Duration::ZERO,
            receiving: Duration::ZERO,
            turning: Duration::ZERO,
            since,
            from,
            taken: 0,
            scans_since: None,
        }
    }

    /// A slot of the schedule was used otherwise than for listening in vain.
    #[inline]
    pub(super) fn take_slot(&mut self) {
        self.taken += 1;
    }

    /// The radio turned around and sent for so long.
    #[inline]
    pub(super) fn sent(&mut self, turnaround: Duration, airtime: Duration) {
        self.turning += turnaround;
        self.transmitting += airtime;
    }

    /// The receiver was on for so long.
    #[inline]
    pub(super) fn received(&mut self, span: Duration) {
        self.receiving += span;
    }

    /// The slots so far, up to but not including `until`, in which it listened and nobody sent, are counted: each with a window of
    /// this length.
    pub(super) fn count_idle(&mut self, schedule: &Schedule, until: Asn, window: Duration) {
        let idle = schedule.listens_within(self.from, until).saturating_sub(std::mem::take(&mut self.taken));
        self.slots.counts.add(SlotKind::IdleListen, idle);
        let nanos = (SimTime::ZERO + window).as_nanos().saturating_mul(idle);
        self.receiving += Duration::from_nanos(nanos);
        self.from = self.from.max(until);
    }

    /// Slots count again from this one on.
    pub(super) fn go_on(&mut self, from: Asn) {
        self.from = from;
        self.taken = 0;
    }

    /// A scan begins.
    pub(super) fn begin_scan(&mut self, now: SimTime) {
        self.scans_since = Some(now);
    }

    /// The scan under way, if one is, is counted up to `now`; returns whether one was.
    pub(super) fn count_scan(&mut self, now: SimTime) -> bool {
        let since = self.scans_since.take();
        if let Some(since) = since {
            let span = now.saturating_since(since.max(self.since));
            self.receiving += span;
            self.slots.scanned += span;
        }
        since.is_some()
    }

    /// All so far is forgotten.
    pub(super) fn restart(&mut self, now: SimTime, from: Asn) {
        let scans_since = self.scans_since.map(|_| now);
        let slots = SlotUse { lost: self.slots.lost, joined_after: self.slots.joined_after, ..SlotUse::default() };
        *self = Self { slots, scans_since, ..Self::new(now, from) };
    }

    /// The meter of the radio, and its slots with what share of the time it was on.
    pub(super) fn close(mut self, now: SimTime) -> (EnergyMeter, SlotUse) {
        let mut meter = EnergyMeter::new(RadioState::Transmit, self.since);
        let mut at = self.since;
        for (span, next) in [
            (self.transmitting, RadioState::Receive),
            (self.receiving, RadioState::Turnaround),
            (self.turning, RadioState::Sleep),
        ] {
            at += span;
            meter.enter(next, at);
        }
        meter.enter(RadioState::Sleep, now.max(at));
        self.slots.on = self.transmitting + self.receiving;
        self.slots.span = now.saturating_since(self.since);
        (meter, self.slots)
    }
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
