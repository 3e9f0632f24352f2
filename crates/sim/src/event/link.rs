//! Events of links, of every technology.

use sextant_mac::Class;

use super::{ieee80211ad, ieee802154, programmed, sleeping, tsch};

/// An event of a link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LinkEvent {
    /// Of a link of IEEE 802.15.4.
    Ieee802154(ieee802154::Event),
    /// Of a link of IEEE 802.11ad.
    Ieee80211ad(ieee80211ad::Event),
    /// Of a station whose program commands its radio.
    Programmed(programmed::Event),
    /// Of a link with time-slotted channel hopping.
    Tsch(tsch::Event),
    /// Of a station that sleeps between checks of the channel.
    Sleeping(sleeping::Event),
}

impl LinkEvent {
    /// Class of the event among those of the same instant.
    #[inline]
    pub(crate) const fn class(self) -> Class {
        match self {
            Self::Ieee802154(event) => event.class(),
            Self::Ieee80211ad(event) => event.class(),
            Self::Programmed(event) => event.class(),
            Self::Tsch(event) => event.class(),
            Self::Sleeping(event) => event.class(),
        }
    }
}
