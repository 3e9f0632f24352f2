//! The values of cells.

use std::borrow::Cow;

use sextant_kernel::text::shortened;
use sextant_kernel::{RobotId, SimTime};

use super::memory_table::{Cell, whole};
use super::table::{Column, TableRow};
use super::times::Times;
use crate::error::robot_log_error::RobotLogError;
use sextant_recording::RobotNames;

impl TableRow<'_> {
    /// The text of the cell, without the spaces around it; `None` if it is empty or there is no such column.
    pub(crate) fn filled(&self, column: Column) -> Option<Cow<'_, str>> {
        let text = match self.cell(column) {
            Cell::Text(text) => text.trim().into(),
            other => other.text(),
        };
        Some(text).filter(|text| !text.is_empty())
    }

    /// The number in the cell, which may be one that is not finite: `None` if the cell is empty, `Some(None)` if it holds
    /// something else.
    fn number(&self, column: Column) -> Option<Option<f64>> {
        match self.cell(column) {
            Cell::Empty => None,
            Cell::Text(text) => {
                let text = Some(text.trim()).filter(|text| !text.is_empty())?;
                Some(self.decimal(text).parse().ok())
            }
            Cell::Float(value) => Some(Some(value)),
            Cell::Whole(value) => Some(Some(value as f64)),
            Cell::Instant(_) | Cell::Other(_) => Some(None),
        }
    }

    /// A number as it is written in a program: with a decimal point.
    pub(crate) fn decimal<'t>(&self, text: &'t str) -> Cow<'t, str> {
        let is_decimal = self.head.has_decimal_comma() && !text.contains('.') && text.matches(',').count() == 1;
        if is_decimal { text.replace(',', ".").into() } else { text.into() }
    }

    /// A whole number of at most `max`; `None` if the cell is empty.
    pub(crate) fn whole(&self, column: Column, max: u32) -> Result<Option<u32>, RobotLogError> {
        let number: Option<u32> = match self.cell(column) {
            Cell::Empty => return Ok(None),
            Cell::Text(text) => match text.trim() {
                "" => return Ok(None),
                text => text.parse().ok(),
            },
            Cell::Float(value) => whole(value).and_then(|value| value.try_into().ok()),
            Cell::Whole(value) => value.try_into().ok(),
            Cell::Instant(_) | Cell::Other(_) => None,
        };
        let number = number.filter(|&number| number <= max);
        number.map(Some).ok_or_else(|| self.wrong(column, format!("a whole number from 0 to {max}")))
    }

    /// A finite number; `None` if the cell is empty.
    pub(crate) fn finite(&self, column: Column) -> Result<Option<f64>, RobotLogError> {
        let Some(number) = self.number(column) else { return Ok(None) };
        let number = number.filter(|number| number.is_finite());
        number.map(Some).ok_or_else(|| self.wrong(column, "a finite number"))
    }

    /// A finite number that was measured; `None` if the cell is empty or NaN.
    pub(crate) fn measured(&self, column: Column) -> Result<Option<f64>, RobotLogError> {
        if self.is_blank(column) { Ok(None) } else { self.finite(column) }
    }

    /// Whether the cell is empty or NaN.
    pub(crate) fn is_blank(&self, column: Column) -> bool {
        self.number(column).is_none_or(|number| number.is_some_and(f64::is_nan))
    }

    /// Whether the cell is a number that is 0.
    pub(crate) fn is_zero(&self, column: Column) -> bool {
        self.number(column).flatten().is_some_and(|number| number.abs() <= 0.0)
    }

    /// The identity of a sector; `None` if the cell is empty.
    pub(crate) fn sector(&self, column: Column) -> Result<Option<u8>, RobotLogError> {
        let sector = self.whole(column, u32::from(u8::MAX))?;
        Ok(sector.and_then(|sector| u8::try_from(sector).ok()))
    }

    /// A time.
    pub(crate) fn instant(&self, times: Times) -> Result<SimTime, RobotLogError> {
        let time = match self.cell(times.column) {
            Cell::Empty | Cell::Other(_) => None,
            Cell::Text(text) => times.parse(&self.decimal(text.trim())),
            Cell::Whole(value) => times.of_whole(value),
            // As the shortest decimal that is this number.
            Cell::Float(value) => times.parse(&value.to_string()),
            Cell::Instant(nanos) => times.of_instant(nanos),
        };
        time.ok_or_else(|| self.wrong(times.column, times.allowed(self.text(times.column).trim())))
    }

    /// Whether the time in the cell is a number below 0: before any path begins.
    pub(crate) fn is_before_zero(&self, times: Times) -> bool {
        self.filled(times.column).is_some_and(|text| self.decimal(&text).parse::<f64>().is_ok_and(|time| time < 0.0))
    }

    /// The name of a node.
    pub(crate) fn node(&self, column: Column) -> Result<Cow<'_, str>, RobotLogError> {
        Some(self.text(column))
            .filter(|name| !name.is_empty() && self.may_be_name(column))
            .ok_or_else(|| self.wrong(column, "the name of a node"))
    }

    /// A name, without the spaces around it: a text, or a number as it is written.
    pub(crate) fn name(&self, column: Column, allowed: &str) -> Result<Cow<'_, str>, RobotLogError> {
        let name = self.filled(column).filter(|_| self.may_be_name(column));
        name.ok_or_else(|| self.wrong(column, allowed))
    }

    /// Whether the cell is of a type that names can have.
    fn may_be_name(&self, column: Column) -> bool {
        !matches!(self.cell(column), Cell::Other(_))
    }

    /// The robot that the cell names. If the file has a column for robots, each cell must name one; otherwise it is
    /// robot 0.
    pub(crate) fn robot(&self, column: Column, robots: &mut RobotNames) -> Result<RobotId, RobotLogError> {
        if !column.exists() {
            return Ok(RobotId(0));
        }
        let name = self.name(column, "the name of a robot")?;
        Ok(robots.id(&name))
    }

    /// The error that the cell is not what is `allowed`.
    pub(crate) fn wrong(&self, column: Column, allowed: impl Into<String>) -> RobotLogError {
        self.wrong_cell(self.head.written(column.name), &self.text(column), allowed)
    }

    /// The error that the cell in the column with this index is not what is `allowed`.
    pub(crate) fn wrong_at(&self, at: usize, allowed: impl Into<String>) -> RobotLogError {
        self.wrong_cell(self.head.written_at(at), &self.text_at(at), allowed)
    }

    fn wrong_cell(&self, column: &str, found: &str, allowed: impl Into<String>) -> RobotLogError {
        RobotLogError::Cell {
            at: self.head.address(self.offset),
            column: column.to_owned(),
            found: shortened(found).into_owned(),
            allowed: allowed.into(),
        }
    }
}
