//! The column of times in a table, in any of the usual units.

use sextant_kernel::SimTime;

use super::table::{Column, Table};
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant::{self, COLUMNS};
use crate::time::time_zone::TimeZone;

/// The column of times of a file.
#[derive(Clone, Copy)]
pub(crate) struct Times {
    pub(crate) column: Column,
    /// How many of its units are a second, as a power of ten.
    places: usize,
    /// The zone of dates that do not say theirs.
    zone: Option<TimeZone>,
}

impl Times {
    /// The column of times of `table`, if it has one. Of several, the one in seconds counts, or that in the greater unit;
    /// `notes` say so. Dates that do not say their zone are in `zone`.
    pub(crate) fn find(table: &Table<'_>, zone: Option<TimeZone>, notes: &mut Vec<String>) -> Option<Self> {
        let mut found = COLUMNS.into_iter().zip([0, 3, 6, 9]).map(|(name, places)| (table.column(name), places));
        let (column, places) = found.by_ref().find(|(column, _)| column.exists())?;
        let unused: Vec<String> =
            found.filter(|(other, _)| other.exists()).map(|(other, _)| format!("`{}`", other.name)).collect();
        if !unused.is_empty() {
            notes.push(table.ignored_beside(&unused.join(", "), "the times", column.name));
        }
        Some(Self { column, places, zone })
    }

    /// The same, for a file that must have it.
    pub(crate) fn of(
        table: &Table<'_>,
        zone: Option<TimeZone>,
        notes: &mut Vec<String>,
    ) -> Result<Self, RobotLogError> {
        Self::find(table, zone, notes).ok_or_else(|| {
            table.wrong_header(format!(
                "column `t_s` is missing; times need the column t_s (or t_ms, t_us, t_ns){}",
                table.hint("t_s")
            ))
        })
    }

    /// The time `text`.
    pub(crate) fn parse(self, text: &str) -> Option<SimTime> {
        match self.places {
            0 => instant::parse(text).or_else(|| instant::parse_date(text, self.zone)),
            places => instant::parse_scaled(text, places),
        }
    }

    /// The time of a whole number of units.
    pub(crate) fn of_whole(self, value: i64) -> Option<SimTime> {
        const UNITS: [u64; 4] = [1_000_000_000, 1_000_000, 1000, 1];
        let unit_ns = UNITS[(self.places / 3).min(3)];
        u64::try_from(value).ok()?.checked_mul(unit_ns).map(SimTime::from_nanos)
    }

    /// The time that is so many nanoseconds after 1970. As in a file, dates are for the column of seconds.
    pub(crate) fn of_instant(self, nanos: i64) -> Option<SimTime> {
        u64::try_from(nanos).ok().filter(|_| self.places == 0).map(SimTime::from_nanos)
    }

    /// The allowed values of a cell that holds `text`.
    pub(crate) fn allowed(self, text: &str) -> &'static str {
        /// Seconds since 1970 have fewer digits until the year 5138.
        const DIGITS_OF_PARTS: usize = 12;
        let digits = text.split('.').next().unwrap_or_default();
        let is_scaled = digits.len() >= DIGITS_OF_PARTS && digits.bytes().all(|octet| octet.is_ascii_digit());
        match self.places {
            0 if instant::parse_date(text, Some(TimeZone::UTC)).is_some() => instant::ALLOWED_ZONED,
            0 if is_scaled => instant::ALLOWED_SCALED,
            0 => instant::ALLOWED,
            3 => "milliseconds as a decimal number, at least 0",
            6 => "microseconds as a decimal number, at least 0",
            _ => "nanoseconds as a decimal number, at least 0",
        }
    }
}
