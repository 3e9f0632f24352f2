//! What became of a frame.

/// What became of a frame at a receiver, from the least to the best: of several receivers the greatest counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FrameOutcome {
    /// Nobody listened when it started, or not until its end.
    NotListened,
    /// The receiver was beyond the radius of communication.
    OutOfRange,
    /// Too weak, or drowned by noise alone.
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
