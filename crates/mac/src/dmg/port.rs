//! The interface of the machines of the sector level sweep: events and radio.

use std::time::Duration;

use super::frame::SweepFrame;
use super::sector::TxSector;
use crate::{Class, RadioState};

/// An event of a machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The timer for the start of a frame: its first bit goes out now, unless the channel was taken in the meantime.
    TransmitReady,
    /// The last bit of the frame of this station is out.
    TransmissionEnded,
    /// The channel becomes busy at this station: the first of the signals that it can sense starts now, and the station
    /// notices it within `CCA_DETECTION`.
    CarrierBusy,
    /// The channel becomes idle at this station: the last of the signals that it can sense ends now.
    CarrierIdle,
    /// Any other timer.
    WaitExpired,
}

impl Event {
    /// Class of the event among those of the same instant. What [`Initiator::receive`](super::Initiator::receive) and
    /// [`Responder::receive`](super::Responder::receive) are told belongs to the end of a signal too.
    #[must_use]
    #[inline]
    pub const fn class(self) -> Class {
        match self {
            Self::TransmissionEnded | Self::CarrierIdle => Class::EndOfSignal,
            Self::TransmitReady | Self::CarrierBusy => Class::StartOfSignal,
            Self::WaitExpired => Class::Timer,
        }
    }
}

/// Where the antenna of a station points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aim {
    /// In all directions alike, to listen.
    QuasiOmni,
    /// Along one of its transmit sectors.
    Sector(TxSector),
}

/// The interface of a machine to its timer, its radio and its random numbers.
pub trait Radio {
    /// Number of slots to wait, drawn uniformly from `0..=max_inclusive`.
    fn slots(&mut self, max_inclusive: u32) -> u32;

    /// Sets the timer: `event` is due `span` from now, ordered by [`Event::class`] among events of the same instant.
    /// `span` may be zero. Never called while the timer is pending.
    fn after(&mut self, span: Duration, event: Event);

    /// Cancels the pending timer.
    fn cancel_timer(&mut self);

    /// The radio changes its state now; also told before each frame that it sends. In [`RadioState::Transmit`] and
    /// [`RadioState::Idle`] it is deaf.
    fn enter(&mut self, state: RadioState);

    /// The antenna points there from now on. At the start it is quasi-omnidirectional.
    fn aim(&mut self, aim: Aim);

    /// Puts the first bit of `frame` on the air; [`Event::TransmissionEnded`] is due `airtime` from now.
    fn start_transmission(&mut self, frame: SweepFrame, airtime: Duration);

    /// Sends a frame on a sector of the antenna.
    fn transmit(&mut self, frame: SweepFrame, sector: TxSector) {
        self.aim(Aim::Sector(sector));
        self.enter(RadioState::Transmit);
        self.start_transmission(frame, frame.airtime());
    }

    /// Listens in all directions.
    fn listen(&mut self) {
        self.aim(Aim::QuasiOmni);
        self.enter(RadioState::Receive);
    }
}
