//! The outcome of a frame.

/// Why a receiver did not listen to a frame, from the worst to the best: if there are several receivers, the one that was
/// nearest to listening counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Deafness {
    /// Its receiver was not in use: a robot between its stops, a node that died, a station whose application looks at
    /// nothing, a radio that its program turned off or tuned to another channel, or no receiver at all.
    Off,
    /// Its radio was asleep or idle: between frames, in a backoff, or outside a superframe.
    Asleep,
    /// It sent something itself during the frame, such as an acknowledgement, or turned around for that.
    Transmitting,
}

impl Deafness {
    /// Its name in recordings: `off`, `asleep`, `transmitting`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Off => "off",
            Self::Asleep => "asleep",
            Self::Transmitting => "transmitting",
        }
    }
}

/// The outcome of a frame at a receiver, from the worst to the best: if there are several receivers, the best counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FrameOutcome {
    /// No receiver listened from its start to its end.
    NotListened(Deafness),
    /// The receiver was beyond the radius of communication.
    OutOfRange,
    /// Too weak, or lost to noise alone.
    Weak,
    /// Lost to another signal.
    Collided,
    /// Received.
    Received,
}

impl FrameOutcome {
    /// The outcome before anything is known: no other is worse.
    pub(crate) const WORST: Self = Self::NotListened(Deafness::Off);

    /// Its name in recordings: `not_listened`, `out_of_range`, `weak`, `collided`, `received`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotListened(_) => "not_listened",
            Self::OutOfRange => "out_of_range",
            Self::Weak => "weak",
            Self::Collided => "collided",
            Self::Received => "received",
        }
    }

    /// Why no receiver listened, if none did.
    #[must_use]
    pub fn deafness(self) -> Option<Deafness> {
        match self {
            Self::NotListened(deafness) => Some(deafness),
            Self::OutOfRange | Self::Weak | Self::Collided | Self::Received => None,
        }
    }
}
