//! A CSV file being written.

use std::path::Path;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;
use sextant_recording::output::{CsvFile, EmptyCell, write_whole};

/// A CSV file in memory, with cells for numbers, times and positions.
pub(crate) struct Output(CsvFile);

impl Output {
    /// A file with this header.
    pub(crate) fn new(header: &[&str]) -> Self {
        Self(CsvFile::new(header, EmptyCell::Quoted))
    }

    /// Adds a cell with a text.
    pub(crate) fn text(&mut self, text: &str) -> &mut Self {
        self.0.cell(text);
        self
    }

    /// Adds a cell with a number, with as many digits as it takes to read the same number back.
    pub(crate) fn number(&mut self, number: f64) -> &mut Self {
        self.text(&number.to_string())
    }

    /// Adds a cell with a time (s).
    pub(crate) fn instant(&mut self, time: SimTime) -> &mut Self {
        self.text(&instant::format(time))
    }

    /// Adds three cells with a position (m).
    pub(crate) fn position(&mut self, position: Position) -> &mut Self {
        self.number(position.x_m).number(position.y_m).number(position.z_m)
    }

    /// Ends the row.
    pub(crate) fn end(&mut self) {
        self.0.end_row();
    }

    /// Writes the file `path`, completely or not at all.
    pub(crate) fn save(&self, path: &Path) -> Result<(), RobotLogError> {
        write_whole(path, self.0.bytes()).map_err(|why| RobotLogError::write(path, why))
    }
}
