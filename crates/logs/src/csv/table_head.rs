//! What is known of a table besides its rows: where it is, its columns, and the addresses of rows for errors.

use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use super::csv_file::CsvStyle;
use super::header::{Header, KnownColumns};
use crate::error::log_part::{LogPart, RowAddress};
use crate::error::robot_log_error::RobotLogError;

/// What is known of a table besides its rows.
pub(crate) struct Head {
    pub(crate) part: LogPart,
    header: Header,
    style: CsvStyle,
}

impl Head {
    /// That of a table whose columns are not known yet.
    pub(crate) fn of(part: LogPart, style: CsvStyle) -> Self {
        Self { part, header: Header::default(), style }
    }

    /// The same of a file.
    pub(crate) fn of_file(path: &Path, style: CsvStyle) -> Self {
        Self::of(path.into(), style)
    }

    /// The same with columns of these names.
    ///
    /// # Errors
    /// If `known` ones are missing or look misspelt.
    pub(crate) fn with_columns<'n>(
        mut self,
        names: impl Iterator<Item = &'n str>,
        known: KnownColumns<'_>,
    ) -> Result<Self, RobotLogError> {
        let header = Header::new(names, known, &self.part);
        self.header = header.map_err(|problem| self.wrong_header(problem))?;
        Ok(self)
    }

    /// Its columns.
    pub(crate) const fn header(&self) -> &Header {
        &self.header
    }

    /// That of a file whose rows have the columns of this table.
    pub(crate) fn for_file(&self, path: &Path, style: CsvStyle) -> Self {
        Self { part: path.into(), header: self.header.clone(), style }
    }

    /// The names of the columns as written.
    pub(crate) fn all_written(&self) -> &[String] {
        self.header.all_written()
    }

    /// Whether blanks around cells are no part of them.
    pub(crate) const fn has_blanks(&self) -> bool {
        self.style.has_blanks
    }

    /// Whether a comma in a number is its decimal mark.
    pub(crate) const fn has_decimal_comma(&self) -> bool {
        self.style.decimal_comma
    }

    /// The name of the column `known` as the file has it.
    pub(crate) fn written<'a>(&'a self, known: &'a str) -> &'a str {
        self.header.written(known)
    }

    /// The name of the column with this index.
    pub(crate) fn written_at(&self, at: usize) -> &str {
        &self.header.all_written()[at]
    }

    /// Name of the file without its folder, or of the table in memory.
    pub(crate) fn name(&self) -> String {
        self.part.name()
    }

    /// The address of the row at `offset`.
    pub(crate) fn address(&self, offset: u64) -> RowAddress {
        match &self.part {
            LogPart::File(path) => RowAddress::File { path: path.clone(), line: self.line(path, offset) },
            LogPart::Table(name) => RowAddress::Table { name: name.clone(), row: usize::try_from(offset).ok() },
        }
    }

    /// The error that the header is wrong.
    pub(crate) fn wrong_header(&self, problem: impl Into<String>) -> RobotLogError {
        let at = match &self.part {
            LogPart::File(path) => RowAddress::File { path: path.clone(), line: 1 },
            LogPart::Table(name) => RowAddress::Table { name: name.clone(), row: None },
        };
        RobotLogError::Row { at, problem: problem.into() }
    }

    /// Line of the row of the file `path` that begins at `offset`, counted from 1. The reader's own count is wrong after a
    /// blank line and after a line that ends in two characters, so the file is read once more, up to the row.
    fn line(&self, path: &Path, offset: u64) -> usize {
        let lines = || -> std::io::Result<usize> {
            let mut input = BufReader::new(File::open(path)?);
            let mut line = 1;
            let mut before = (&mut input).take(self.style.skipped + offset);
            loop {
                let octets = before.fill_buf()?;
                if octets.is_empty() {
                    break;
                }
                line += octets.iter().filter(|&&octet| octet == b'\n').count();
                let length = octets.len();
                before.consume(length);
            }
            // Blank lines before a row belong to it.
            for octet in input.bytes() {
                match octet? {
                    b'\n' => line += 1,
                    b'\r' => {}
                    _ => break,
                }
            }
            Ok(line)
        };
        lines().unwrap_or(1)
    }

    /// The error that the row at `offset` is wrong as a whole.
    pub(crate) fn wrong_row(&self, offset: u64, problem: impl Into<String>) -> RobotLogError {
        RobotLogError::Row { at: self.address(offset), problem: problem.into() }
    }

    pub(crate) fn malformed(&self, why: &csv::Error) -> RobotLogError {
        let offset = why.position().map_or(0, csv::Position::byte);
        let problem = match why.kind() {
            csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                let hint = if *len > *expected_len && !self.style.decimal_comma {
                    "; a decimal comma needs `;` or a tab between the cells"
                } else {
                    ""
                };
                format!("{len} cells, but the header has {expected_len} columns{hint}")
            }
            csv::ErrorKind::Utf8 { err, .. } => {
                let column = self.header.all_written().get(err.field());
                let cell =
                    column.map_or_else(|| "a cell".to_owned(), |column| format!("the cell of column `{column}`"));
                format!(
                    "{cell} is not UTF-8 text; from Latin-1, `iconv -f ISO-8859-1 -t UTF-8 FILE > NEW.csv` saves the file as UTF-8"
                )
            }
            _ => why.to_string(),
        };
        self.wrong_row(offset, problem)
    }
}
