//! The state of one station's link.

use std::collections::VecDeque;

use sextant_kernel::{EventKey, SimTime, StationId};
use sextant_mac::dmg::{Initiator, Responder, SectorLayout, SweepFrame, TxSector};
use sextant_mac::{EnergyMeter, RadioState};

use super::broadcast::Broadcast;
use super::tracks::Tracks;
use crate::air::{Aim, Transmission};
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::sweep::SweepKind;

/// The state of one station's link.
pub(super) struct Stack {
    pub(super) initiator: Initiator,
    pub(super) responder: Responder,
    pub(super) radio: RadioStack,
    /// What its initiator does, or will do once the responder is idle.
    pub(super) task: Option<RadioTask>,
    /// The sweep that comes next.
    pub(super) next_sweep: Option<SweepKind>,
    /// Broadcasts that wait, the first one first.
    pub(super) waiting: VecDeque<Broadcast>,
    /// Broadcasts that the application has given so far.
    pub(super) broadcasts: u32,
    /// The stations to which the broadcast under way was delivered, in their order.
    pub(super) reached: Vec<StationId>,
    /// The sweep under way among those of a steered antenna.
    pub(super) tilt: u8,
    /// The numbers of the sectors of the sweep under way.
    pub(super) numbers: SectorNumbers,
    /// The pending end of a time to listen.
    pub(super) listening_over: Option<EventKey>,
    /// Whether an answer is under way.
    pub(super) is_answering: bool,
    /// The best outcome so far of its frames, at the station that swept.
    pub(super) outcome: FrameOutcome,
    /// Whether any of them was sent.
    pub(super) has_answered: bool,
    /// The tracks of what is under way, if packets are traced.
    pub(super) tracks: Option<Box<Tracks>>,
}

/// The numbers of the sectors of a sweep among all sectors of the antenna.
#[derive(Clone, Copy, Debug)]
pub(super) struct SectorNumbers {
    /// The sectors of each sweep, as they are called on air.
    pub(super) layout: SectorLayout,
    /// Number of the first one, at the tilt of the sweep.
    pub(super) first: u8,
}

impl SectorNumbers {
    /// The number of a sector; `None` if the sweep does not have it.
    pub(super) fn of(&self, sector: TxSector) -> Option<u8> {
        let index = u8::try_from(self.layout.index(sector)?).expect("at most 128 sectors");
        Some(self.first + index)
    }
}

/// What the two machines of a station share: they never transmit at once.
pub(super) struct RadioStack {
    pub(super) meter: EnergyMeter,
    pub(super) state: RadioState,
    pub(super) aim: Aim,
    /// Why the air knows the receiver as deaf; `None` if it listens.
    pub(super) deafness: Option<Deafness>,
    /// The frame on air.
    pub(super) on_air: Option<(Transmission, SweepFrame)>,
    /// The pending timer of each machine.
    pub(super) timers: [Option<EventKey>; 2],
    /// Backoffs drawn so far.
    pub(super) draws: u64,
}

/// What the initiator of a station does.
#[derive(Clone, Copy, Debug)]
pub(super) enum RadioTask {
    /// A sweep of its sectors.
    Sweep(SweepKind),
    /// A broadcast from each of its sectors.
    Broadcast(Broadcast),
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
            deafness: Some(Deafness::Off),
            on_air: None,
            timers: [None; 2],
            draws: 0,
        }
    }
}
