//! Events of a station's link of IEEE 802.11ad.

use sextant_mac::{Class, dmg};

/// An event of a station's link. It fits in one byte, which an event of the machines and the machine would not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// The initiator may transmit.
    InitiatorReady,
    /// A frame of the initiator is out.
    InitiatorTransmitted,
    /// The initiator has waited.
    InitiatorWaited,
    /// The responder may transmit.
    ResponderReady,
    /// A frame of the responder is out.
    ResponderTransmitted,
    /// The responder has waited.
    ResponderWaited,
    /// The station has listened long enough.
    ListeningOver,
}

impl Event {
    /// An event of the initiator of a station, as far as it can be scheduled.
    pub(crate) fn initiator(event: dmg::Event) -> Self {
        match event {
            dmg::Event::TransmitReady => Self::InitiatorReady,
            dmg::Event::TransmissionEnded => Self::InitiatorTransmitted,
            dmg::Event::WaitExpired => Self::InitiatorWaited,
            dmg::Event::CarrierBusy | dmg::Event::CarrierIdle => unreachable!("the air tells of the carrier"),
        }
    }

    /// An event of the responder of a station, as far as it can be scheduled.
    pub(crate) fn responder(event: dmg::Event) -> Self {
        match event {
            dmg::Event::TransmitReady => Self::ResponderReady,
            dmg::Event::TransmissionEnded => Self::ResponderTransmitted,
            dmg::Event::WaitExpired => Self::ResponderWaited,
            dmg::Event::CarrierBusy | dmg::Event::CarrierIdle => unreachable!("the air tells of the carrier"),
        }
    }

    /// Class of the event among those of the same instant.
    pub(crate) const fn class(self) -> Class {
        match self {
            Self::InitiatorReady | Self::ResponderReady => dmg::Event::TransmitReady.class(),
            Self::InitiatorTransmitted | Self::ResponderTransmitted => dmg::Event::TransmissionEnded.class(),
            Self::InitiatorWaited | Self::ResponderWaited => dmg::Event::WaitExpired.class(),
            Self::ListeningOver => Class::Application,
        }
    }
}
