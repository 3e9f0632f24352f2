//! The state of one station's link.

use sextant_kernel::{EventKey, SimTime};
use sextant_mac::dmg::{Initiator, Responder, SweepFrame};
use sextant_mac::{EnergyMeter, RadioState};

use crate::air::{Aim, Transmission};
use crate::service::outcome::FrameOutcome;

/// The state of one station's link.
pub(super) struct Stack {
    pub(super) initiator: Initiator,
    pub(super) responder: Responder,
    pub(super) radio: RadioStack,
    /// The sweep under way among those of a steered antenna.
    pub(super) tilt: u8,
    /// Number of the first sector of each DMG antenna, at this tilt, among all sectors of the antenna.
    pub(super) first_sectors: [u8; 4],
    /// The pending end of a time to listen.
    pub(super) listening_over: Option<EventKey>,
    /// The best outcome so far of the frames of the answer under way, at the station that swept.
    pub(super) outcome: FrameOutcome,
    /// Frames of the answer under way.
    pub(super) frames: u64,
}

/// What the two machines of a station share: they never transmit at once.
pub(super) struct RadioStack {
    pub(super) meter: EnergyMeter,
    pub(super) state: RadioState,
    pub(super) aim: Aim,
    /// Whether the air knows the receiver as one that listens.
    pub(super) is_tuned: bool,
    /// The frame on air.
    pub(super) on_air: Option<(Transmission, SweepFrame)>,
    /// The pending timer of each machine.
    pub(super) timers: [Option<EventKey>; 2],
    /// Backoffs drawn so far.
    pub(super) draws: u64,
}

/// Which machine of a station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Initiator,
    Responder,
}

impl RadioStack {
    pub(super) fn new() -> Self {
        let state = RadioState::Receive;
        Self {
            meter: EnergyMeter::new(state, SimTime::ZERO),
            state,
            aim: Aim::Omnidirectional,
            is_tuned: false,
            on_air: None,
            timers: [None; 2],
            draws: 0,
        }
    }
}
