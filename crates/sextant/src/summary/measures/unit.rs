//! Units of measures.

/// The unit of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A count.
    Count,
    /// A mean of counts.
    MeanCount,
    /// A share or a rate, 0 to 1.
    Share,
    /// Whether something happened in a run: 1 if it did, and 0 if not.
    Outcome,
    /// A number per second.
    PerSecond,
    /// A number in the unit of a field.
    Plain,
    /// Metres.
    Metre,
    /// Seconds.
    Second,
    /// Degrees.
    Degree,
    /// Joules.
    Joule,
    /// Bits per second.
    BitPerSecond,
}

impl Unit {
    /// The unit in words, as the number stands in the summary.
    #[must_use]
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Count => "a count",
            Self::MeanCount => "a mean of counts",
            Self::Share => "a share, 0 to 1",
            Self::Outcome => "1 if it happened in the run, and 0 if not",
            Self::PerSecond => "a number per second",
            Self::Plain => "a number in the unit of the field",
            Self::Metre => "metres",
            Self::Second => "seconds",
            Self::Degree => "degrees",
            Self::Joule => "joules",
            Self::BitPerSecond => "bits per second",
        }
    }

    /// The factor to the unit in printed tables, and that unit.
    #[must_use]
    pub fn for_people(self) -> (f64, &'static str) {
        match self {
            Self::Count | Self::MeanCount | Self::Plain => (1.0, ""),
            Self::Share | Self::Outcome => (100.0, "%"),
            Self::PerSecond => (1.0, "1/s"),
            Self::Metre => (1.0, "m"),
            Self::Second => (1.0, "s"),
            Self::Degree => (1.0, "°"),
            Self::Joule => (1000.0, "mJ"),
            Self::BitPerSecond => (1e-3, "kbit/s"),
        }
    }
}
