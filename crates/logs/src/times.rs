//! The column of times in a CSV file, in any of the usual units.

use sextant_kernel::SimTime;

use super::error::RobotLogError;
use super::instant::{self, COLUMNS};
use super::table::{Column, Table};

/// The column of times of a file.
#[derive(Clone, Copy)]
pub(super) struct Times {
    pub(super) column: Column,
    /// How many of its units are a second, as a power of ten.
    places: usize,
}

impl Times {
    /// The column of times of `table`, if it has one. Of several, the one in seconds counts, or that in the greater unit;
    /// `notes` say so.
    pub(super) fn find(table: &Table, notes: &mut Vec<String>) -> Option<Self> {
        let mut found = COLUMNS.into_iter().zip([0, 3, 6, 9]).map(|(name, places)| (table.column(name), places));
        let (column, places) = found.by_ref().find(|(column, _)| column.exists())?;
        let unused: Vec<String> =
            found.filter(|(other, _)| other.exists()).map(|(other, _)| format!("`{}`", other.name)).collect();
        if !unused.is_empty() {
            notes.push(table.ignored_beside(&unused.join(", "), "the times", column.name));
        }
        Some(Self { column, places })
    }

    /// The same, for a file that must have it.
    pub(super) fn of(table: &Table, notes: &mut Vec<String>) -> Result<Self, RobotLogError> {
        Self::find(table, notes).ok_or_else(|| {
            table.wrong_header(format!(
                "column `t_s` is missing; times need the column t_s (or t_ms, t_us, t_ns){}",
                table.hint("t_s")
            ))
        })
    }

    /// The time `text`.
    pub(super) fn parse(self, text: &str) -> Option<SimTime> {
        match self.places {
            0 => instant::parse(text).or_else(|| instant::parse_date(text, false)),
            places => instant::parse_scaled(text, places),
        }
    }

    /// The allowed values of a cell.
    pub(super) const fn allowed(self) -> &'static str {
        match self.places {
            0 => instant::ALLOWED,
            3 => "milliseconds as a decimal number, at least 0",
            6 => "microseconds as a decimal number, at least 0",
            _ => "nanoseconds as a decimal number, at least 0",
        }
    }
}
