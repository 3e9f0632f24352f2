//! The columns of the table of a sweep.

use sextant::summary::{Measure, Unit};

/// The type of the values of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Integers.
    Integer,
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
