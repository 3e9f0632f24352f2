//! The columns of the table of a sweep.

use sextant::summary::{Measure, Unit};

/// The type of the values of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Integers of at most 63 bits and a sign.
    Integer,
    /// Integers from 0 on, of at most 64 bits.
    Unsigned,
    /// Real numbers.
    Real,
    /// Texts.
    Text,
}

/// A column of the table of a sweep.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name.
    pub name: String,
    /// The type of its values.
    pub kind: ColumnKind,
}

impl Column {
    /// A column `name` of `kind`.
    pub fn new(name: impl Into<String>, kind: ColumnKind) -> Self {
        Self { name: name.into(), kind }
    }
}

impl From<&Measure> for Column {
    fn from(measure: &Measure) -> Self {
        let kind = if measure.unit() == Unit::Count { ColumnKind::Integer } else { ColumnKind::Real };
        Self::new(measure.column(), kind)
    }
}

/// What all values of a setting are. A cell without a value says nothing.
#[derive(Clone, Copy, Debug)]
pub(super) struct ValueKinds {
    are_integers: bool,
    are_unsigned: bool,
    are_reals: bool,
    are_any: bool,
}

impl Default for ValueKinds {
    fn default() -> Self {
        Self { are_integers: true, are_unsigned: true, are_reals: true, are_any: false }
    }
}

impl ValueKinds {
    /// Adds a TOML value.
    pub(super) fn add(&mut self, value: &str) {
        if value.is_empty() {
            return;
        }
        self.are_any = true;
        self.are_integers &= value.parse::<i64>().is_ok();
        self.are_unsigned &= value.parse::<u64>().is_ok();
        self.are_reals &= value.parse::<f64>().is_ok();
    }

    /// The narrowest kind of a column that has them all.
    pub(super) fn kind(self) -> ColumnKind {
        match self {
            Self { are_any: false, .. } => ColumnKind::Text,
            Self { are_integers: true, .. } => ColumnKind::Integer,
            Self { are_unsigned: true, .. } => ColumnKind::Unsigned,
            Self { are_reals: true, .. } => ColumnKind::Real,
            Self { .. } => ColumnKind::Text,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kind_of_a_column_is_the_narrowest_that_fits() {
        let kind = |values: &[&str]| {
            let mut all = ValueKinds::default();
            values.iter().for_each(|value| all.add(value));
            all.kind()
        };
        assert_eq!(kind(&["1", "-2", ""]), ColumnKind::Integer);
        assert_eq!(kind(&["1", "18446744073709551615"]), ColumnKind::Unsigned);
        assert_eq!(kind(&["1", "2.5"]), ColumnKind::Real);
        assert_eq!(kind(&["1", "\"suburban\""]), ColumnKind::Text);
        assert_eq!(kind(&[""]), ColumnKind::Text);
    }
}
