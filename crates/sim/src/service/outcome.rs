//! The outcome of a frame.

/// The outcome of a frame at a receiver, from the worst to the best: if there are several receivers, the best counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FrameOutcome {
    /// No receiver listened from its start to its end.
    NotListened,
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
    /// Its name in recordings: `not_listened`, `out_of_range`, `weak`, `collided`, `received`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::NotListened => "not_listened",
            Self::OutOfRange => "out_of_range",
            Self::Weak => "weak",
            Self::Collided => "collided",
            Self::Received => "received",
        }
    }
}
