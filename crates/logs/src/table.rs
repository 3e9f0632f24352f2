//! A table with columns by name, read row by row: a CSV file or several of them, or a table in memory. Errors name the line or
//! row, and the column.

use std::borrow::Cow;
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::Path;

use csv::StringRecord;
use sextant_kernel::text::{of_cell, shortened};

use super::csv_file::{CsvFile, CsvStyle, Heading};

use super::error::RobotLogError;
use super::field_names::FieldNames;
use super::header::{self, Header, Known, Others};
use super::log_part::{LogPart, RowAddress};
use super::memory_table::{Cell, MemoryTable};
use super::table_file::TableFile;
use super::table_source::TableSource;

/// A table whose header was read.
pub(super) struct Table<'a> {
    head: Head,
    body: Body<'a>,
}

/// The rows of a table.
enum Body<'a> {
    Files {
        files: Vec<TableFile>,
        heading: Heading,
        /// The first file, which is open already: it may be a pipe.
        first: Option<CsvFile>,
    },
    Memory(&'a MemoryTable<'a>),
}

/// What is known of a table besides its rows.
pub(super) struct Head {
    pub(super) part: LogPart,
    header: Header,
    style: CsvStyle,
}

/// A column by name, and its index in a row if the table has it.
#[derive(Clone, Copy)]
pub(super) struct Column {
    pub(super) name: &'static str,
    pub(super) at: Option<usize>,
}

impl Column {
    /// Whether the table has the column.
    pub(super) fn exists(self) -> bool {
        self.at.is_some()
    }
}

/// A row of a table.
pub(super) struct Row<'a> {
    pub(super) head: &'a Head,
    cells: Cells<'a>,
    /// Where the row is: its offset in the file (octets), without a byte order mark, or its number in the table, from 0.
    pub(super) offset: u64,
}

/// The cells of a row.
enum Cells<'a> {
    File(&'a StringRecord),
    Memory { table: &'a MemoryTable<'a>, row: usize },
}

impl<'a> Table<'a> {
    /// Opens a table. It must have all `required` columns and may have the `optional` ones; others are ignored, unless one
    /// looks like a known column that is absent.
    pub(super) fn open(
        source: impl Into<TableSource<'a>>,
        required: &[&'static str],
        optional: &[&'static str],
    ) -> Result<Self, RobotLogError> {
        let known = Known { required, optional, names: &FieldNames::default(), others: Others::Ignored };
        Self::open_known(source, known)
    }

    /// The same with names of the user for columns.
    pub(super) fn open_known(source: impl Into<TableSource<'a>>, known: Known<'_>) -> Result<Self, RobotLogError> {
        match source.into() {
            TableSource::File(path) => Self::open_files(vec![TableFile::alone(&path)], known),
            TableSource::Files(files) => Self::open_files(files, known),
            TableSource::Memory(table) => {
                let part = LogPart::Table(table.name().to_owned());
                let mut head = Head { part, header: Header::default(), style: CsvStyle::default() };
                let header = Header::new(table.column_names(), known, &head.part);
                head.header = header.map_err(|problem| head.wrong_header(problem))?;
                Ok(Self { head, body: Body::Memory(table) })
            }
        }
    }

    /// Files that are one table: it has all columns that any of them has, and the cells that their names give.
    fn open_files(files: Vec<TableFile>, known: Known<'_>) -> Result<Self, RobotLogError> {
        let heading = if known.names.has_numbers() { Heading::Numbered } else { Heading::Named };
        let mut names: Vec<String> = Vec::new();
        let mut whole: Option<Head> = None;
        let mut first = None;
        for file in &files {
            let (of_file, csv) = file.open(heading)?;
            let is_known = |name: &String| {
                known.names.gives(name) || known.required.iter().chain(known.optional).any(|known| known == name)
            };
            if let Some(values) = csv.values_for_names()
                && !csv.names.iter().any(is_known)
            {
                let hint = known.names.numbers_hint(&[known.required, known.optional].concat());
                return Err(of_file.wrong_header(format!(
                    "the first line is `{}`: values, and no names of columns{hint}",
                    shortened(&values)
                )));
            }
            if let Some(of_name) = file.cells.iter().find(|(name, _)| csv.names.contains(name)) {
                let problem =
                    format!("the column `{}` is in the file, and in its name too; allowed: one of them", of_name.0);
                return Err(of_file.wrong_header(problem));
            }
            let of_file_names = csv.names.iter().chain(file.cells.iter().map(|(name, _)| name));
            if whole.is_none() {
                names = of_file_names.cloned().collect();
                (whole, first) = (Some(of_file), Some(csv));
            } else {
                let more: Vec<String> = of_file_names.filter(|name| !names.contains(name)).cloned().collect();
                names.extend(more);
            }
        }
        let mut head = whole.unwrap_or_else(|| Head::of_file(Path::new(""), CsvStyle::default()));
        let header = Header::new(names.iter().map(String::as_str), known, &head.part);
        head.header = header.map_err(|problem| head.wrong_header(problem))?;
        Ok(Self { head, body: Body::Files { files, heading, first } })
    }

    /// The column `name`.
    pub(super) fn column(&self, name: &'static str) -> Column {
        Column { name, at: self.head.header.find(name) }
    }

    /// The indices and names of the columns that are not known.
    pub(super) fn unknown(&self) -> impl Iterator<Item = (usize, &str)> {
        let header = &self.head.header;
        header.unknown().map(|at| (at, header.all_written()[at].as_str()))
    }

    /// A note on the columns that are ignored, if there are any.
    pub(super) fn ignored(&self) -> Option<String> {
        let names = self.head.header.ignored_names()?;
        Some(format!("{}: ignored columns: {names}", self.head.name()))
    }

    /// A note that the columns `unused` are ignored beside those that are `used`.
    pub(super) fn ignored_beside(&self, unused: &str, what: &str, used: &str) -> String {
        format!("{}: {unused} ignored, because {what} are read from {used}", self.head.name())
    }

    /// How the user can say that a column with another name is the known one `key`, for an error.
    pub(super) fn hint(&self, key: &str) -> String {
        self.head.header.hint(key)
    }

    /// Name of the file without its folder, or of the table in memory.
    pub(super) fn name(&self) -> String {
        self.head.name()
    }

    /// What the table must do about columns that are missing, for an error.
    pub(super) const fn must_have(&self) -> &'static str {
        header::must_have(&self.head.part)
    }

    /// The error that the header lacks something.
    pub(super) fn wrong_header(&self, problem: impl Into<String>) -> RobotLogError {
        self.head.wrong_header(problem)
    }

    /// Calls `visit` with each row. Returns what is known of the table besides.
    pub(super) fn rows(
        self,
        mut visit: impl FnMut(&Row<'_>) -> Result<(), RobotLogError>,
    ) -> Result<Head, RobotLogError> {
        let Self { head, body } = self;
        match body {
            Body::Files { files, heading, mut first } => {
                for file in &files {
                    let csv = match first.take() {
                        Some(csv) => csv,
                        None => file.open(heading)?.1,
                    };
                    file.rows(csv, &head, &mut visit)?;
                }
            }
            Body::Memory(table) => {
                for row in 0..table.rows() {
                    visit(&Row { head: &head, cells: Cells::Memory { table, row }, offset: row as u64 })?;
                }
            }
        }
        Ok(head)
    }
}

impl Head {
    /// That of a file whose columns are not known yet.
    pub(super) fn of_file(path: &Path, style: CsvStyle) -> Self {
        Self { part: path.into(), header: Header::default(), style }
    }

    /// That of a file whose rows have the columns of this table.
    pub(super) fn for_file(&self, path: &Path, style: CsvStyle) -> Self {
        Self { part: path.into(), header: self.header.clone(), style }
    }

    /// The names of the columns as written.
    pub(super) fn all_written(&self) -> &[String] {
        self.header.all_written()
    }

    /// Whether a comma in a number is its decimal mark.
    pub(super) const fn has_decimal_comma(&self) -> bool {
        self.style.decimal_comma
    }

    /// The name of the column `known` as the file has it.
    pub(super) fn written<'a>(&'a self, known: &'a str) -> &'a str {
        self.header.written(known)
    }

    /// The name of the column with this index.
    pub(super) fn written_at(&self, at: usize) -> &str {
        &self.header.all_written()[at]
    }

    /// Name of the file without its folder, or of the table in memory.
    pub(super) fn name(&self) -> String {
        self.part.name()
    }

    /// The address of the row at `offset`.
    pub(super) fn address(&self, offset: u64) -> RowAddress {
        match &self.part {
            LogPart::File(path) => RowAddress::File { path: path.clone(), line: self.line(path, offset) },
            LogPart::Table(name) => RowAddress::Table { name: name.clone(), row: usize::try_from(offset).ok() },
        }
    }

    /// The error that the header is wrong.
    pub(super) fn wrong_header(&self, problem: impl Into<String>) -> RobotLogError {
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
    pub(super) fn wrong_row(&self, offset: u64, problem: impl Into<String>) -> RobotLogError {
        RobotLogError::Row { at: self.address(offset), problem: problem.into() }
    }

    pub(super) fn malformed(&self, why: &csv::Error) -> RobotLogError {
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
            csv::ErrorKind::Utf8 { .. } => "not UTF-8 text".to_owned(),
            _ => why.to_string(),
        };
        self.wrong_row(offset, problem)
    }
}

impl<'a> Row<'a> {
    /// The row of a file with these cells, which begins at `offset`.
    pub(super) const fn of_file(head: &'a Head, record: &'a StringRecord, offset: u64) -> Self {
        Self { head, cells: Cells::File(record), offset }
    }
}

impl Row<'_> {
    /// The text of the cell, with the spaces around it; empty if there is no such column.
    pub(super) fn text(&self, column: Column) -> Cow<'_, str> {
        self.cell(column).text()
    }

    /// The text of the cell in the column with this index, with the spaces around it.
    pub(super) fn text_at(&self, at: usize) -> Cow<'_, str> {
        self.cell_at(at).text()
    }

    /// What the cell holds; nothing if there is no such column.
    pub(super) fn cell(&self, column: Column) -> Cell<'_> {
        column.at.map_or(Cell::Empty, |at| self.cell_at(at))
    }

    fn cell_at(&self, at: usize) -> Cell<'_> {
        match self.cells {
            Cells::File(record) => {
                let text = record.get(at).unwrap_or("");
                Cell::Text(of_cell(if self.head.style.has_blanks { without_blanks(text) } else { text }))
            }
            Cells::Memory { table, row } => table.cell(at, row),
        }
    }

    /// A number that stands for the text of the cell: cells of the column with equal numbers have equal texts. `None` if it
    /// has none.
    pub(super) fn token(&self, column: Column) -> Option<u64> {
        match self.cells {
            Cells::File(_) => None,
            Cells::Memory { table, row } => table.token(column.at?, row),
        }
    }
}

/// The text of a cell with blanks around it, and with quotes if these are within the blanks.
fn without_blanks(text: &str) -> &str {
    let text = text.trim();
    let unquoted = text.strip_prefix('"').and_then(|text| text.strip_suffix('"'));
    unquoted.unwrap_or(text)
}
