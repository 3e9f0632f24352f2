//! Events of a station's link of IEEE 802.15.4.

use sextant_mac::{Class, coordinator, csma, device, responder};

/// An event of a station's link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// An event of channel access.
    Csma(csma::Event),
    /// The CCA is over.
    CcaEnded,
    /// An event of following beacons.
    Tracking(device::Event),
    /// An event of an acknowledgement that the station sends.
    Responder(responder::Event),
    /// An event of a beacon that the station sends.
    Coordinator(coordinator::Event),
    /// The next beacon of the station is due one turnaround from now.
    BeaconDue,
    /// The active part of the superframe of the station is over.
    ActivePartEnded,
    /// The station has listened long enough.
    ListeningOver,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[inline]
    pub(crate) const fn class(self) -> Class {
        match self {
            Self::Csma(event) => event.class(),
            Self::CcaEnded => Class::EndOfCca,
            Self::Tracking(event) => event.class(),
            Self::Responder(event) => event.class(),
            Self::Coordinator(event) => event.class(),
            Self::BeaconDue | Self::ActivePartEnded | Self::ListeningOver => Class::Application,
        }
    }
}
