//! A CSV file being written: the one place that knows when a cell needs quotes.

use std::path::Path;

use sextant_kernel::text;

use super::error::OutputError;
use super::whole::write_file;

/// A CSV file in memory (RFC 4180, but lines end with a line feed). Cells are quoted where needed, and what a spreadsheet would
/// take for a formula is marked ([`sextant_kernel::text::cell`]).
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CsvFile {
    content: Vec<u8>,
    empty: EmptyCell,
    has_begun: bool,
}

/// How an empty cell is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EmptyCell {
    /// As nothing: there is no value.
    Bare,
    /// As two quotes: the value is an empty text.
    Quoted,
}

impl CsvFile {
    /// A file with this header.
    pub fn new(header: impl IntoIterator<Item = impl AsRef<str>>, empty: EmptyCell) -> Self {
        let mut file = Self::headless(empty);
        file.row(header);
        file
    }

    /// A file without a header.
    #[must_use]
    pub fn headless(empty: EmptyCell) -> Self {
        Self { content: Vec::new(), empty, has_begun: false }
    }

    /// Adds a cell to the row.
    pub fn cell(&mut self, text: &str) -> &mut Self {
        if std::mem::replace(&mut self.has_begun, true) {
            self.content.push(b',');
        }
        let text = &*text::cell(text);
        let is_quoted = text.contains(['"', ',', '\n', '\r']) || text.is_empty() && self.empty == EmptyCell::Quoted;
        if is_quoted {
            self.content.push(b'"');
            self.content.extend(text.replace('"', "\"\"").bytes());
            self.content.push(b'"');
        } else {
            self.content.extend(text.bytes());
        }
        self
    }

    /// Ends the row.
    pub fn end_row(&mut self) {
        self.content.push(b'\n');
        self.has_begun = false;
    }

    /// Adds cells to the row and ends it.
    pub fn row(&mut self, cells: impl IntoIterator<Item = impl AsRef<str>>) {
        for cell in cells {
            self.cell(cell.as_ref());
        }
        self.end_row();
    }

    /// What the file has so far.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        &self.content
    }

    /// Takes what the file has so far, so that the rest follows it elsewhere.
    #[must_use]
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.content)
    }

    /// Writes the file at `path`, completely or not at all.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), OutputError> {
        write_file(path, &self.content)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn formulas_are_marked() {
        let mut file = CsvFile::headless(EmptyCell::Bare);
        file.row(["=cmd|' /C calc'!A0", "-3.5", "-x", "@a,b"]);
        assert_eq!(String::from_utf8(file.take()).unwrap(), "'=cmd|' /C calc'!A0,-3.5,'-x,\"'@a,b\"\n");
    }

    #[test]
    fn cells_are_quoted_where_needed() {
        let text = |empty| {
            let mut file = CsvFile::new(["cell", "error"], empty);
            file.row(["1", "no, \"never\""]);
            file.cell("a\nb").cell("").end_row();
            String::from_utf8(file.bytes().to_vec()).unwrap()
        };
        assert_eq!(text(EmptyCell::Bare), "cell,error\n1,\"no, \"\"never\"\"\"\n\"a\nb\",\n");
        assert_eq!(text(EmptyCell::Quoted), "cell,error\n1,\"no, \"\"never\"\"\"\n\"a\nb\",\"\"\n");
    }
}
