//! Rows of tables.

use std::borrow::Cow;

/// The type of the cells of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// Integers.
    Integer,
    /// Real numbers, times in seconds among them.
    Real,
    /// Texts.
    Text,
}

/// A column of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableColumn {
    /// Its name, with the unit at its end.
    pub name: Cow<'static, str>,
    /// The type of its cells.
    pub kind: CellKind,
}

impl TableColumn {
    /// A column called `name` of cells of a `kind`.
    pub(super) fn new(name: impl Into<Cow<'static, str>>, kind: CellKind) -> Self {
        Self { name: name.into(), kind }
    }
}

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// There is no value.
    Missing,
    /// An integer.
    Integer(i64),
    /// A real number.
    Real(f64),
    /// A time in nanoseconds, which is written in seconds.
    Nanos(u64),
    /// A text.
    Text(String),
}

impl Cell {
    /// The value as a real number, if it is one.
    #[must_use]
    pub fn real(&self) -> Option<f64> {
        match *self {
            Self::Real(value) => value.is_finite().then_some(value),
            // Exact below 104 days.
            Self::Nanos(nanos) => Some(nanos as f64 / 1e9),
            Self::Integer(value) => Some(value as f64),
            Self::Missing | Self::Text(_) => None,
        }
    }
}

/// As it is written in a CSV file: a missing value is empty, and so is a number that is none.
impl std::fmt::Display for Cell {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Missing => Ok(()),
            Self::Integer(value) => write!(f, "{value}"),
            Self::Real(value) if value.is_finite() => write!(f, "{value}"),
            Self::Real(_) => Ok(()),
            Self::Nanos(nanos) => {
                let (seconds, rest) = (nanos / 1_000_000_000, nanos % 1_000_000_000);
                if rest == 0 {
                    return write!(f, "{seconds}");
                }
                let digits = format!("{rest:09}");
                write!(f, "{seconds}.{}", digits.trim_end_matches('0'))
            }
            Self::Text(text) => f.write_str(text),
        }
    }
}

/// A row of a table.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TableRow<'a> {
    /// Name of the table: `stops`, `map-ml-tm`, `networks/lora/receptions`.
    pub table: &'a str,
    /// Its columns, the same in each row of a table.
    pub columns: &'a [TableColumn],
    /// The cells, one a column.
    pub cells: &'a [Cell],
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_written_in_seconds_to_the_nanosecond() {
        let text = |nanos| Cell::Nanos(nanos).to_string();
        assert_eq!([text(0), text(2_500_000_000), text(1)], ["0", "2.5", "0.000000001"]);
    }

    #[test]
    fn numbers_that_are_none_are_empty() {
        assert_eq!([Cell::Real(f64::NAN).to_string(), Cell::Missing.to_string()], ["", ""]);
    }
}
