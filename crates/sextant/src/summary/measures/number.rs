//! A number with its name and unit.

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

/// A number that is read from a `T`, if it applies.
#[derive(Debug)]
pub struct Number<T> {
    /// Name of its column.
    pub column: &'static str,
    /// Its unit in the column.
    pub unit: Unit,
    pub(super) read: fn(&T) -> Option<f64>,
}

pub(super) fn count(count: u64) -> f64 {
    count as f64
}

/// Declares numbers of a `T` by column, unit and a function that reads them, and lists them in `ALL`.
macro_rules! numbers {
    ($of:ty { $($name:ident $column:literal $unit:ident $read:expr;)* }) => {
        $(
            #[doc = concat!("Column `", $column, "`.")]
            pub static $name: Number<$of> = Number { column: $column, unit: Unit::$unit, read: $read };
        )*

        /// All of them, in the order of the columns.
        pub static ALL: &[&Number<$of>] = &[$(&$name),*];
    };
}
pub(super) use numbers;
