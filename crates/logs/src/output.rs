//! A CSV file being written.

use std::path::Path;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::error::RobotLogError;
use super::instant;
use sextant_recording::output::write_whole;

/// A CSV file in memory. Cells are quoted where needed, and lines end with a line feed.
pub(super) struct Output {
    content: Vec<u8>,
    begun: bool,
}

impl Output {
    /// A file with this header.
    pub(super) fn new(header: &[&str]) -> Self {
        let mut output = Self { content: Vec::new(), begun: false };
        for name in header {
            output.text(name);
        }
        output.end();
        output
    }

    /// Adds a cell with a text.
    pub(super) fn text(&mut self, text: &str) -> &mut Self {
        if std::mem::replace(&mut self.begun, true) {
            self.content.push(b',');
        }
        if text.contains(['"', ',', '\n', '\r']) || text.is_empty() {
            self.content.push(b'"');
            self.content.extend(text.replace('"', "\"\"").bytes());
            self.content.push(b'"');
        } else {
            self.content.extend(text.bytes());
        }
        self
    }

    /// Adds a cell with a number, with as many digits as it takes to read the same number back.
    pub(super) fn number(&mut self, number: f64) -> &mut Self {
        self.text(&number.to_string())
    }

    /// Adds a cell with a time (s).
    pub(super) fn instant(&mut self, time: SimTime) -> &mut Self {
        self.text(&instant::format(time))
    }

    /// Adds three cells with a position (m).
    pub(super) fn position(&mut self, position: Position) -> &mut Self {
        self.number(position.x_m).number(position.y_m).number(position.z_m)
    }

    /// Ends the row.
    pub(super) fn end(&mut self) {
        self.content.push(b'\n');
        self.begun = false;
    }

    /// Writes the file `path`, completely or not at all.
    pub(super) fn save(&self, path: &Path) -> Result<(), RobotLogError> {
        write_whole(path, &self.content).map_err(|why| RobotLogError::write(path, why))
    }
}
