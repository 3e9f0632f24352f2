//! Events of a station whose program commands its radio.

use sextant_mac::{Class, program};

/// An event of a station's link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// An event of its radio.
    Radio(program::Event),
    /// The start-of-frame delimiter of what it has on air ends.
    Delimited,
    /// The station has listened long enough.
    ListeningOver,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[inline]
    pub(crate) const fn class(self) -> Class {
        match self {
            Self::Radio(event) => event.class(),
            Self::Delimited => Class::Timer,
            Self::ListeningOver => Class::Application,
        }
    }
}
