//! The order in which events of the same instant happen on the air.

use sextant_kernel::{Rank, StationId};

/// Class of an event among those of the same instant; the lower one happens first.
///
/// Instants of IEEE 802.15.4 coincide often, because 320, 192 and 128 us have the common divisor
/// 64 us. Every interval is half-open, `[start, end)`: a CCA that ends exactly when a signal starts
/// reads idle, and so does a CCA that starts exactly when a signal ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Class {
    /// A signal ends, or a receiver stops being deaf.
    EndOfSignal = 1,
    /// A clear channel assessment ends.
    EndOfCca = 2,
    /// A signal starts.
    StartOfSignal = 3,
    /// A clear channel assessment starts.
    StartOfCca = 4,
    /// Any other timer of a protocol.
    Timer = 5,
    /// Traffic and robots: the users of the network.
    Application = 6,
}

impl Class {
    /// The rank of an event of this class at `station`, for the event queue.
    #[must_use]
    #[inline]
    pub const fn rank(self, station: StationId) -> Rank {
        Rank::new(self as u8, station)
    }
}
