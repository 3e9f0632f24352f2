//! The state of one station's link, apart from its channel access machine.

use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::{EnergyMeter, RadioState};

use super::clock::Clock;
use super::frame_queue::{QueuedFrame, Waiting};
use crate::air::Transmission;
use crate::service::outcome::FrameOutcome;

/// The state of one station's link, apart from its channel access machine.
pub(super) struct Stack {
    /// The clock that times everything that the station does by itself.
    pub(super) clock: Clock,
    pub(super) meter: EnergyMeter,
    /// The state that channel access asks for.
    pub(super) wanted: RadioState,
    /// The state while the station sends an acknowledgement or a beacon, which goes before channel access.
    pub(super) overriding: Option<RadioState>,
    /// When the station last began or ended to send an acknowledgement or a beacon.
    pub(super) overridden_until: SimTime,
    /// Whether what the receiver hears at rest is looked at.
    pub(super) listening: bool,
    /// Whether the air knows the receiver as one that listens.
    pub(super) is_tuned: bool,
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
    /// The data frame on air.
    pub(super) transmission: Option<Transmission>,
    /// The frame under way.
    pub(super) frame: Option<QueuedFrame>,
    /// Frames that wait for the one under way.
    pub(super) waiting: Waiting,
    /// Number of frames offered so far.
    pub(super) frames: u32,
    pub(super) timer: Option<EventKey>,
    /// The pending event of following beacons.
    pub(super) tracking: Option<EventKey>,
    pub(super) backoffs: u64,
    /// The acknowledgement on air, with its sequence number.
    pub(super) acknowledgement: Option<(Transmission, u8)>,
    /// The sender of the frame that was received last: whom an acknowledgement answers.
    pub(super) answered: Option<StationId>,
}

impl Stack {
    pub(super) fn new(state: RadioState, sequence: u8, clock: Clock) -> Self {
        Self {
            clock,
            meter: EnergyMeter::new(state, SimTime::ZERO),
            wanted: state,
            overriding: None,
            overridden_until: SimTime::ZERO,
            listening: false,
            is_tuned: false,
            awaits_ack: false,
            leaving: false,
            listening_over: None,
            sequence,
            outcome: FrameOutcome::NotListened,
            transmission: None,
            frame: None,
            waiting: Waiting::default(),
            frames: 0,
            timer: None,
            tracking: None,
            backoffs: 0,
            acknowledgement: None,
            answered: None,
        }
    }

    /// The state of the radio.
    pub(super) fn state(&self) -> RadioState {
        self.overriding.unwrap_or(self.wanted)
    }

    /// Whether frames that reach the radio are worked out: its receiver is on, and what it hears is looked at.
    pub(super) fn is_receiving(&self) -> bool {
        self.overriding.is_none() && self.wanted == RadioState::Receive && (self.awaits_ack || self.listening)
    }
}
