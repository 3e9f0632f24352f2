//! The state of one station's link, apart from its channel access machine.

use std::time::Duration;

use sextant_channel::{Dbm, Milliwatts};
use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::csma::Contention;
use sextant_mac::{Cycles, EnergyMeter, RadioState};

use super::frame_queue::{QueuedFrame, Waiting};
use super::radio::Levels;
use crate::air::Transmission;
use crate::event::ieee802154::Event;
use crate::link::clock::Clock;
use crate::link::track::PacketTrack;
use crate::service::outcome::{Deafness, FrameOutcome};

/// What channel access waits for, and when that comes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Due {
    pub(super) at: SimTime,
    pub(super) event: Event,
}

/// Backoffs and assessments ahead of the queue, up to the assessment that is in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plan {
    /// The first of them.
    pub(super) first: Due,
    /// What contention is at the start of that assessment, ...
    pub(super) contention: Contention,
    /// ... when that is, ...
    pub(super) start: SimTime,
    /// ... how many events are before it, ...
    pub(super) steps: u64,
    /// ... what the radio did in between, ...
    pub(super) cycles: Cycles,
    /// ... and the clock of the station then.
    pub(super) clock: Clock,
}

/// The state of one station's link, apart from its channel access machine.
pub(super) struct Stack {
    /// The clock that times everything that the station does by itself.
    pub(super) clock: Clock,
    /// By how much its receiver is ready for an answer before the clock says so.
    pub(super) lead: Duration,
    /// Transmit power.
    pub(super) tx_power: Dbm,
    /// Power at or above which carrier sense finds the channel busy.
    pub(super) cca_threshold: Milliwatts,
    pub(super) meter: EnergyMeter,
    /// The state that channel access asks for.
    pub(super) wanted: RadioState,
    /// The state while the station sends an acknowledgement or a beacon, which goes before channel access.
    pub(super) overriding: Option<RadioState>,
    /// When the station last began or ended to send an acknowledgement or a beacon.
    pub(super) overridden_until: SimTime,
    /// Whether what the receiver hears at rest is looked at.
    pub(super) listening: bool,
    /// Why the air knows the receiver as deaf; `None` if it listens.
    pub(super) deafness: Option<Deafness>,
    /// Whether the station has died.
    pub(super) is_dead: bool,
    /// Whether channel access waits for an acknowledgement.
    pub(super) awaits_ack: bool,
    /// Whether the station has listened long enough, and stops as soon as it may.
    pub(super) leaving: bool,
    /// The pending end of a time to listen.
    pub(super) listening_over: Option<EventKey>,
    /// Sequence number of the frame under way.
    pub(super) sequence: u8,
    /// The best outcome so far of the frame under way.
    pub(super) outcome: FrameOutcome,
    /// How often the frame under way was sent.
    pub(super) transmissions: u32,
    /// The data frame on air.
    pub(super) transmission: Option<Transmission>,
    /// The frame under way.
    pub(super) frame: Option<QueuedFrame>,
    /// Frames that wait for the one under way.
    pub(super) waiting: Waiting,
    /// Number of frames offered so far.
    pub(super) frames: u32,
    /// The event in the queue that channel access waits for; that of a quiet station is only set while it is there.
    pub(super) timer: Option<EventKey>,
    /// Whether nobody sees what the radio does between its frames, so that channel access runs ahead of the queue.
    pub(super) is_quiet: bool,
    /// What channel access of a quiet station waits for next.
    pub(super) due: Option<Due>,
    /// What of it is in the queue.
    pub(super) queued: Option<Due>,
    /// How it comes to that, if nobody has asked for its state since.
    pub(super) plan: Option<Plan>,
    /// The pending event of following beacons.
    pub(super) tracking: Option<EventKey>,
    /// The acknowledgement on air, with its sequence number.
    pub(super) acknowledgement: Option<(Transmission, u8)>,
    /// The sender of the frame that was received last: whom an acknowledgement answers.
    pub(super) answered: Option<StationId>,
    /// The track of the frame under way, if packets are traced.
    pub(super) track: Option<Box<PacketTrack>>,
}

impl Stack {
    pub(super) fn new(state: RadioState, sequence: u8, clock: Clock, levels: &Levels) -> Self {
        Self {
            clock,
            lead: Duration::ZERO,
            tx_power: levels.tx_power,
            cca_threshold: levels.cca_threshold.to_milliwatts(),
            meter: EnergyMeter::new(state, SimTime::ZERO),
            wanted: state,
            overriding: None,
            overridden_until: SimTime::ZERO,
            listening: false,
            deafness: Some(Deafness::Off),
            is_dead: false,
            awaits_ack: false,
            leaving: false,
            listening_over: None,
            sequence,
            outcome: FrameOutcome::WORST,
            transmissions: 0,
            transmission: None,
            frame: None,
            waiting: Waiting::default(),
            frames: 0,
            timer: None,
            is_quiet: false,
            due: None,
            queued: None,
            plan: None,
            tracking: None,
            acknowledgement: None,
            answered: None,
            track: None,
        }
    }

    /// The state of the radio.
    pub(super) fn state(&self) -> RadioState {
        self.overriding.unwrap_or(self.wanted)
    }

    /// Why frames that reach the radio are not worked out. They are if its receiver is on, and what it hears is looked at.
    pub(super) fn deafness_now(&self) -> Option<Deafness> {
        match self.state() {
            RadioState::Transmit | RadioState::Turnaround => Some(Deafness::Transmitting),
            RadioState::Sleep if self.is_dead => Some(Deafness::Off),
            RadioState::Sleep | RadioState::Idle => Some(Deafness::Asleep),
            RadioState::Receive if self.awaits_ack || self.listening => None,
            RadioState::Receive => Some(Deafness::Off),
        }
    }
}
