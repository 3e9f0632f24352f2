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
    /// Days.
    Day,
    /// Degrees.
    Degree,
    /// Joules.
    Joule,
    /// Amperes.
    Ampere,
    /// Watts.
    Watt,
    /// Bits per second.
    BitPerSecond,
    /// Decibels.
    Decibel,
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
            Self::Day => "days",
            Self::Degree => "degrees",
            Self::Joule => "joules",
            Self::Ampere => "amperes",
            Self::Watt => "watts",
            Self::BitPerSecond => "bits per second",
            Self::Decibel => "decibels",
        }
    }

    /// The symbol of the unit, as the number stands in the summary; empty of counts, and `1` of shares.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::Count | Self::MeanCount => "",
            Self::Share | Self::Outcome => "1",
            Self::PerSecond => "1/s",
            Self::Plain => "of the field",
            Self::Metre => "m",
            Self::Second => "s",
            Self::Day => "d",
            Self::Degree => "°",
            Self::Joule => "J",
            Self::Ampere => "A",
            Self::Watt => "W",
            Self::BitPerSecond => "bit/s",
            Self::Decibel => "dB",
        }
    }

    /// The factor to the unit in which people read numbers of this size, and that unit: milliseconds for 0.002 s.
    #[must_use]
    pub fn for_size(self, size: f64) -> (f64, &'static str) {
        let steps: &[(f64, &'static str)] = match self {
            Self::Second => &[(1.0, "s"), (1e-3, "ms"), (1e-6, "µs")],
            Self::Joule => &[(1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ")],
            Self::Watt => &[(1.0, "W"), (1e-3, "mW"), (1e-6, "µW")],
            Self::Ampere => &[(1.0, "A"), (1e-3, "mA"), (1e-6, "µA")],
            Self::BitPerSecond => &[(1e6, "Mbit/s"), (1e3, "kbit/s"), (1.0, "bit/s")],
            Self::Count
            | Self::MeanCount
            | Self::Share
            | Self::Outcome
            | Self::PerSecond
            | Self::Plain
            | Self::Metre
            | Self::Day
            | Self::Degree
            | Self::Decibel => return self.for_people(),
        };
        // Zero has no size; it is printed in the first unit.
        let fits = steps.iter().find(|(step, _)| size.abs() >= *step);
        let (step, symbol) = if size.abs() > 0.0 { *fits.unwrap_or(&steps[steps.len() - 1]) } else { steps[0] };
        (1.0 / step, symbol)
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
            Self::Day => (1.0, "d"),
            Self::Degree => (1.0, "°"),
            Self::Decibel => (1.0, "dB"),
            Self::Joule => (1000.0, "mJ"),
            Self::Ampere => (1e6, "µA"),
            Self::Watt => (1e6, "µW"),
            Self::BitPerSecond => (1e-3, "kbit/s"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_numbers_have_units_that_fit() {
        for (unit, size, expected) in [
            (Unit::Second, 0.0021, "ms"),
            (Unit::Second, 1.0, "s"),
            (Unit::Second, 0.0, "s"),
            (Unit::Second, 3e-7, "µs"),
            (Unit::Joule, -12.0, "J"),
            (Unit::BitPerSecond, 146_000.0, "kbit/s"),
            (Unit::Metre, 0.0021, "m"),
            (Unit::Share, 0.5, "%"),
        ] {
            assert_eq!(unit.for_size(size).1, expected, "{size} {unit:?}");
        }
        assert!((0.0021 * Unit::Second.for_size(0.0021).0 - 2.1).abs() < 1e-12);
    }
}
