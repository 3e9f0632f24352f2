//! Events of a station that sleeps between checks of the channel.

use sextant_mac::{Class, sleep};

/// An event of a station's link.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Event {
    /// What its protocol machine waits for.
    Station(sleep::Event),
    /// It wakes up while somebody sends.
    CheckDue,
    /// It begins an attempt that is aimed at the wake-up of its receiver.
    AttemptDue,
    /// It has waited before the next attempt.
    BackoffOver,
    /// It has listened long enough.
    ListeningOver,
}

impl Event {
    /// Class of the event among those of the same instant.
    #[inline]
    pub(crate) const fn class(self) -> Class {
        match self {
            Self::Station(event) => event.class(),
            Self::CheckDue | Self::AttemptDue | Self::BackoffOver => Class::Timer,
            Self::ListeningOver => Class::Application,
        }
    }
}
