//! A table with columns by name, read row by row: a CSV file or several of them, or a table in memory. Errors name the line or
//! row, and the column.

use std::borrow::Cow;
use std::path::Path;

use csv::StringRecord;
use sextant_kernel::text::{of_cell, shortened};

use super::csv_file::{CsvFile, CsvStyle, Heading};
use super::cut_end;
use super::header::{self, KnownColumns, Others};
use super::memory_table::{Cell, MemoryTable};
use super::table_file::TableFile;
use super::table_head::Head;
use super::table_source::TableSource;
use crate::error::log_part::LogPart;
use crate::error::robot_log_error::RobotLogError;
use crate::options::field_names::FieldNames;

/// A table whose header was read.
pub(crate) struct Table<'a> {
    head: Head,
    body: TableBody<'a>,
}

/// The rows of a table.
enum TableBody<'a> {
    Files {
        files: Vec<TableFile>,
        heading: Heading,
        /// The first file, which is open already: it may be a pipe.
        first: Option<Box<CsvFile>>,
    },
    Memory(&'a MemoryTable<'a>),
}

/// A column by name, and its index in a row if the table has it.
#[derive(Clone, Copy)]
pub(crate) struct Column {
    pub(crate) name: &'static str,
    pub(crate) at: Option<usize>,
}

impl Column {
    /// Whether the table has the column.
    pub(crate) fn exists(self) -> bool {
        self.at.is_some()
    }
}

/// A row of a table.
pub(crate) struct TableRow<'a> {
    pub(crate) head: &'a Head,
    cells: Cells<'a>,
    /// Where the row is: its offset in the file (octets), without a byte order mark, or its number in the table, from 0.
    pub(crate) offset: u64,
}

/// The cells of a row.
enum Cells<'a> {
    File(&'a StringRecord),
    Memory { table: &'a MemoryTable<'a>, row: usize },
}

impl<'a> Table<'a> {
    /// Opens a table. It must have all `required` columns and may have the `optional` ones; others are ignored, unless one
    /// looks like a known column that is absent.
    pub(crate) fn open(
        source: impl Into<TableSource<'a>>,
        required: &[&'static str],
        optional: &[&'static str],
    ) -> Result<Self, RobotLogError> {
        let known = KnownColumns { required, optional, names: &FieldNames::default(), others: Others::Ignored };
        Self::open_known(source, known)
    }

    /// The same with names of the user for columns.
    pub(crate) fn open_known(
        source: impl Into<TableSource<'a>>,
        known: KnownColumns<'_>,
    ) -> Result<Self, RobotLogError> {
        match source.into() {
            TableSource::File(path) => Self::open_files(vec![TableFile::alone(&path)], known),
            TableSource::Files(files) => Self::open_files(files, known),
            TableSource::Memory(table) => {
                let part = LogPart::Table(table.name().to_owned());
                let head = Head::of(part, CsvStyle::default()).with_columns(table.column_names(), known)?;
                Ok(Self { head, body: TableBody::Memory(table) })
            }
        }
    }

    /// Files that are one table: it has all columns that any of them has, and the cells that their names give.
    fn open_files(files: Vec<TableFile>, known: KnownColumns<'_>) -> Result<Self, RobotLogError> {
        let heading = if known.names.has_numbers() { Heading::Numbered } else { Heading::Named };
        let mut names: Vec<String> = Vec::new();
        let mut whole: Option<Head> = None;
        let mut first = None;
        for file in &files {
            let (of_file, csv) = open_file(file, heading)?;
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
                (whole, first) = (Some(of_file), Some(Box::new(csv)));
            } else {
                let more: Vec<String> = of_file_names.filter(|name| !names.contains(name)).cloned().collect();
                names.extend(more);
            }
        }
        let head = whole.unwrap_or_else(|| Head::of_file(Path::new(""), CsvStyle::default()));
        let head = head.with_columns(names.iter().map(String::as_str), known)?;
        Ok(Self { head, body: TableBody::Files { files, heading, first } })
    }

    /// The column `name`.
    pub(crate) fn column(&self, name: &'static str) -> Column {
        Column { name, at: self.head.header().find(name) }
    }

    /// The indices and names of the columns that are not known.
    pub(crate) fn unknown(&self) -> impl Iterator<Item = (usize, &str)> {
        let header = self.head.header();
        header.unknown().map(|at| (at, header.all_written()[at].as_str()))
    }

    /// What the user should know of how it is written: the columns that are ignored, and files that may be cut at their ends.
    pub(crate) fn notes(&self) -> Vec<String> {
        self.notes_besides(&[])
    }

    /// The same where columns with the names `understood` are read elsewhere.
    pub(crate) fn notes_besides(&self, understood: &[&str]) -> Vec<String> {
        let ignored = self.head.header().ignored_names(understood);
        let ignored = ignored.map(|names| format!("{}: ignored columns: {names}", self.head.name()));
        let files = match &self.body {
            TableBody::Files { files, .. } => files.as_slice(),
            TableBody::Memory(_) => &[],
        };
        ignored.into_iter().chain(files.iter().filter_map(|file| cut_end::note(&file.path))).collect()
    }

    /// A note that the columns `unused` are ignored beside those that are `used`.
    pub(crate) fn ignored_beside(&self, unused: &str, what: &str, used: &str) -> String {
        format!("{}: {unused} ignored, because {what} are read from {used}", self.head.name())
    }

    /// How the user can say that a column with another name is the known one `key`, for an error.
    pub(crate) fn hint(&self, key: &str) -> String {
        self.head.header().hint(key)
    }

    /// Name of the file without its folder, or of the table in memory.
    pub(crate) fn name(&self) -> String {
        self.head.name()
    }

    /// What the table must do about columns that are missing, for an error.
    pub(crate) const fn must_have(&self) -> &'static str {
        header::must_have(&self.head.part)
    }

    /// The error that the header lacks something.
    pub(crate) fn wrong_header(&self, problem: impl Into<String>) -> RobotLogError {
        self.head.wrong_header(problem)
    }

    /// Calls `visit` with each row. Returns what is known of the table besides.
    pub(crate) fn rows(
        self,
        mut visit: impl FnMut(&TableRow<'_>) -> Result<(), RobotLogError>,
    ) -> Result<Head, RobotLogError> {
        let Self { head, body } = self;
        match body {
            TableBody::Files { files, heading, mut first } => {
                for file in &files {
                    let csv = match first.take() {
                        Some(csv) => *csv,
                        None => open_file(file, heading)?.1,
                    };
                    rows_of_file(file, csv, &head, &mut visit)?;
                }
            }
            TableBody::Memory(table) => {
                for row in 0..table.rows() {
                    visit(&TableRow { head: &head, cells: Cells::Memory { table, row }, offset: row as u64 })?;
                }
            }
        }
        Ok(head)
    }
}

impl TableRow<'_> {
    /// The text of the cell, with the spaces around it; empty if there is no such column.
    pub(crate) fn text(&self, column: Column) -> Cow<'_, str> {
        self.cell(column).text()
    }

    /// The text of the cell in the column with this index, with the spaces around it.
    pub(crate) fn text_at(&self, at: usize) -> Cow<'_, str> {
        self.cell_at(at).text()
    }

    /// What the cell holds; nothing if there is no such column.
    pub(crate) fn cell(&self, column: Column) -> Cell<'_> {
        column.at.map_or(Cell::Empty, |at| self.cell_at(at))
    }

    fn cell_at(&self, at: usize) -> Cell<'_> {
        match self.cells {
            Cells::File(record) => {
                let text = record.get(at).unwrap_or("");
                Cell::Text(of_cell(if self.head.has_blanks() { without_blanks(text) } else { text }))
            }
            Cells::Memory { table, row } => table.cell(at, row),
        }
    }

    /// A number that stands for the text of the cell: cells of the column with equal numbers have equal texts. `None` if it
    /// has none.
    pub(crate) fn token(&self, column: Column) -> Option<u64> {
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

/// Opens a file of a table.
fn open_file(file: &TableFile, heading: Heading) -> Result<(Head, CsvFile), RobotLogError> {
    let csv = CsvFile::open(&file.path, heading)?;
    let csv = csv.map_err(|why| Head::of_file(&file.path, CsvStyle::default()).malformed(&why))?;
    Ok((Head::of_file(&file.path, csv.style), csv))
}

/// Calls `visit` with each row of the open `file`, whose cells are those of the columns of the table with the head `whole`.
fn rows_of_file(
    file: &TableFile,
    mut csv: CsvFile,
    whole: &Head,
    visit: &mut impl FnMut(&TableRow<'_>) -> Result<(), RobotLogError>,
) -> Result<(), RobotLogError> {
    let head = whole.for_file(&file.path, csv.style);
    let is_whole = file.cells.is_empty() && csv.names == whole.all_written();
    let places: Vec<Option<usize>> = if is_whole {
        Vec::new()
    } else {
        whole.all_written().iter().map(|name| csv.names.iter().position(|other| other == name)).collect()
    };
    let given: Vec<&str> = whole.all_written().iter().map(|name| file.cell(name)).collect();
    let (mut record, mut row) = (StringRecord::new(), StringRecord::new());
    while csv.read(&mut record).map_err(|why| head.malformed(&why))? {
        let offset = record.position().map_or(0, csv::Position::byte);
        if is_whole {
            visit(&TableRow { head: &head, cells: Cells::File(&record), offset })?;
            continue;
        }
        row.clear();
        for (place, given) in places.iter().zip(&given) {
            row.push_field(place.map_or(*given, |place| record.get(place).unwrap_or_default()));
        }
        visit(&TableRow { head: &head, cells: Cells::File(&row), offset })?;
    }
    Ok(())
}
