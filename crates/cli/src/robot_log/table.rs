//! A CSV file with columns by name; errors name line and column.

use std::path::{Path, PathBuf};

use sextant_channel::Position;
use sextant_kernel::{RobotId, SimTime};

use super::error::RobotLogError;
use super::instant;
use crate::robot_names::RobotNames;

/// A CSV file in memory and the names of its columns.
pub(super) struct Table {
    path: PathBuf,
    content: Vec<u8>,
    columns: Vec<String>,
}

/// A column by name, and its index in a row if the file has it.
#[derive(Clone, Copy)]
pub(super) struct Column {
    name: &'static str,
    at: Option<usize>,
}

/// A row of a table.
pub(super) struct Row<'a> {
    table: &'a Table,
    record: csv::StringRecord,
    /// Offset of the row in the file (octets).
    pub(super) offset: usize,
}

impl Table {
    /// Reads the file `path`. It must have all `required` columns, may have the `optional` ones, and no others.
    pub(super) fn read(
        path: &Path,
        required: &[&'static str],
        optional: &[&'static str],
    ) -> Result<Self, RobotLogError> {
        let mut content = std::fs::read(path).map_err(|why| RobotLogError::read(path, why))?;
        if content.starts_with(b"\xef\xbb\xbf") {
            content.drain(..3);
        }
        let mut table = Self { path: path.to_owned(), content, columns: Vec::new() };
        let header = table.reader().headers().cloned().map_err(|why| table.malformed(&why))?;
        let columns: Vec<String> = header.iter().map(|name| name.trim().to_owned()).collect();
        let problem = |problem: String| RobotLogError::Row { path: path.to_owned(), line: 1, problem };
        let known = || [required, optional].concat();
        for (at, name) in columns.iter().enumerate() {
            if !known().contains(&name.as_str()) {
                let hint =
                    nearest(name, &known()).map_or_else(String::new, |near| format!("did you mean `{near}`? "));
                return Err(problem(format!("unknown column `{name}`; {hint}known columns: {}", known().join(", "))));
            }
            if columns[..at].contains(name) {
                return Err(problem(format!("column `{name}` appears twice")));
            }
        }
        if let Some(missing) = required.iter().find(|name| !columns.iter().any(|column| column == *name)) {
            return Err(problem(format!(
                "column `{missing}` is missing; the first line must name the columns: {}",
                required.join(",")
            )));
        }
        table.columns = columns;
        Ok(table)
    }

    /// The column `name`.
    pub(super) fn column(&self, name: &'static str) -> Column {
        Column { name, at: self.columns.iter().position(|column| column == name) }
    }

    /// Calls `visit` with each row below the header.
    pub(super) fn rows(
        &self,
        mut visit: impl FnMut(&Row<'_>) -> Result<(), RobotLogError>,
    ) -> Result<(), RobotLogError> {
        let mut reader = self.reader();
        let mut row = Row { table: self, record: csv::StringRecord::new(), offset: 0 };
        while reader.read_record(&mut row.record).map_err(|why| self.malformed(&why))? {
            let byte = row.record.position().map_or(0, csv::Position::byte);
            row.offset = usize::try_from(byte).expect("an offset in memory");
            visit(&row)?;
        }
        Ok(())
    }

    /// Line of the row that begins at `offset`, counted from 1. The reader's own count is wrong after a blank line and
    /// after a line that ends in two characters.
    pub(super) fn line(&self, offset: usize) -> usize {
        let blank = self.content[offset..].iter().take_while(|byte| matches!(byte, b'\r' | b'\n')).count();
        1 + self.content[..offset + blank].iter().filter(|&&byte| byte == b'\n').count()
    }

    fn reader(&self) -> csv::Reader<&[u8]> {
        csv::Reader::from_reader(self.content.as_slice())
    }

    fn malformed(&self, why: &csv::Error) -> RobotLogError {
        let offset = why.position().and_then(|position| usize::try_from(position.byte()).ok()).unwrap_or(0);
        let problem = match why.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                format!("{len} cells, but the header has {expected_len} columns")
            }
            csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
            _ => why.to_string(),
        };
        RobotLogError::Row { path: self.path.clone(), line: self.line(offset), problem }
    }
}

impl Row<'_> {
    /// The text of the cell, with the spaces around it; empty if there is no such column.
    pub(super) fn text(&self, column: Column) -> &str {
        column.at.and_then(|at| self.record.get(at)).unwrap_or("")
    }

    /// The text of the cell, without the spaces around it; `None` if it is empty or there is no such column.
    pub(super) fn filled(&self, column: Column) -> Option<&str> {
        Some(self.text(column).trim()).filter(|text| !text.is_empty())
    }

    /// A whole number of at most `max`; `None` if the cell is empty.
    pub(super) fn whole(&self, column: Column, max: u32) -> Result<Option<u32>, RobotLogError> {
        let parse = |text: &str| {
            let number = text.parse().ok().filter(|&number| number <= max);
            number.ok_or_else(|| self.wrong(column, format!("a whole number from 0 to {max}")))
        };
        self.filled(column).map(parse).transpose()
    }

    /// A finite number; `None` if the cell is empty.
    pub(super) fn finite(&self, column: Column) -> Result<Option<f64>, RobotLogError> {
        let parse = |text: &str| {
            let number = text.parse().ok().filter(|number: &f64| number.is_finite());
            number.ok_or_else(|| self.wrong(column, "a finite number"))
        };
        self.filled(column).map(parse).transpose()
    }

    /// A time.
    pub(super) fn instant(&self, column: Column) -> Result<SimTime, RobotLogError> {
        instant::parse(self.text(column).trim()).ok_or_else(|| self.wrong(column, instant::ALLOWED))
    }

    /// A position. Its height is 0 if the file has no column for it.
    pub(super) fn position(&self, [x, y, z]: [Column; 3]) -> Result<Position, RobotLogError> {
        let coordinate = |column| {
            let value_m = self.finite(column)?.filter(|value_m| value_m.abs() <= Position::FARTHEST_M);
            value_m.ok_or_else(|| self.wrong(column, "a number of metres from -1e9 to 1e9"))
        };
        let z_m = if z.at.is_some() { coordinate(z)? } else { 0.0 };
        Ok(Position::new(coordinate(x)?, coordinate(y)?, z_m))
    }

    /// The robot that the cell names. If the file has a column for robots, each cell must name one; otherwise it is
    /// robot 0.
    pub(super) fn robot(&self, column: Column, robots: &mut RobotNames) -> Result<RobotId, RobotLogError> {
        if column.at.is_none() {
            return Ok(RobotId(0));
        }
        let name = self.filled(column).ok_or_else(|| self.wrong(column, "the name of a robot"))?;
        Ok(robots.id(name))
    }

    /// The error that the cell is not what is `allowed`.
    pub(super) fn wrong(&self, column: Column, allowed: impl Into<String>) -> RobotLogError {
        RobotLogError::Cell {
            path: self.table.path.clone(),
            line: self.table.line(self.offset),
            column: column.name,
            found: self.text(column).to_owned(),
            allowed: allowed.into(),
        }
    }
}

/// The known name that is most similar to `name`, if any is similar enough.
fn nearest<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let distance = |candidate: &&str| strsim::damerau_levenshtein(&name.to_lowercase(), candidate);
    known
        .iter()
        .copied()
        .filter(|candidate| distance(candidate) <= 2 || candidate.starts_with(name))
        .min_by_key(distance)
}
