//! Events of links, of every technology.

use sextant_mac::Class;

use super::{ieee80211ad, ieee802154, programmed, sleeping, tsch};

/// Makes the enum of the events of all technologies: each technology is one line.
macro_rules! link_events {
    ($($(#[$doc:meta])+ $name:ident in $folder:ident;)+) => {
        /// An event of a link.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub(crate) enum LinkEvent {
            $($(#[$doc])+ $name($folder::Event),)+
        }

        impl LinkEvent {
            /// Class of the event among those of the same instant.
            #[inline]
            pub(crate) const fn class(self) -> Class {
                match self {
                    $(Self::$name(event) => event.class(),)+
                }
            }
        }
    };
}

link_events! {
    /// Of a link of IEEE 802.15.4.
    Ieee802154 in ieee802154;
    /// Of a link of IEEE 802.11ad.
    Ieee80211ad in ieee80211ad;
    /// Of a station whose program commands its radio.
    Programmed in programmed;
    /// Of a link with time-slotted channel hopping.
    Tsch in tsch;
    /// Of a station that sleeps between checks of the channel.
    Sleeping in sleeping;
}
