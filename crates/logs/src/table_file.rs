//! A file of a table: the only one, or one of several that are one table, each with cells that its name gives.

use std::path::{Path, PathBuf};

use csv::{Position, StringRecord};

use super::csv_file::{CsvFile, CsvStyle, Heading};
use super::error::RobotLogError;
use super::table::{Head, Row};

/// A file of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct TableFile {
    pub(super) path: PathBuf,
    /// Cells of each of its rows that are not in the file: the column and the text.
    pub(super) cells: Vec<(String, String)>,
}

impl TableFile {
    /// A table of one file.
    pub(super) fn alone(path: &Path) -> Self {
        Self { path: path.to_owned(), cells: Vec::new() }
    }

    /// Opens the file.
    pub(super) fn open(&self, heading: Heading) -> Result<(Head, CsvFile), RobotLogError> {
        let csv = CsvFile::open(&self.path, heading)?;
        let csv = csv.map_err(|why| Head::of_file(&self.path, CsvStyle::default()).malformed(&why))?;
        Ok((Head::of_file(&self.path, csv.style), csv))
    }

    /// Calls `visit` with each row of the open file `csv`, whose cells are those of the columns of the table with the head
    /// `whole`.
    pub(super) fn rows(
        &self,
        mut csv: CsvFile,
        whole: &Head,
        visit: &mut impl FnMut(&Row<'_>) -> Result<(), RobotLogError>,
    ) -> Result<(), RobotLogError> {
        let head = whole.for_file(&self.path, csv.style);
        let is_whole = self.cells.is_empty() && csv.names == whole.all_written();
        let places: Vec<Option<usize>> = if is_whole {
            Vec::new()
        } else {
            whole.all_written().iter().map(|name| csv.names.iter().position(|other| other == name)).collect()
        };
        let given: Vec<&str> = whole.all_written().iter().map(|name| self.cell(name)).collect();
        let (mut record, mut row) = (StringRecord::new(), StringRecord::new());
        while csv.read(&mut record).map_err(|why| head.malformed(&why))? {
            let offset = record.position().map_or(0, Position::byte);
            if is_whole {
                visit(&Row::of_file(&head, &record, offset))?;
                continue;
            }
            row.clear();
            for (place, given) in places.iter().zip(&given) {
                row.push_field(place.map_or(*given, |place| record.get(place).unwrap_or_default()));
            }
            visit(&Row::of_file(&head, &row, offset))?;
        }
        Ok(())
    }

    /// The cell that the name of the file gives for a column; empty if it gives none.
    fn cell(&self, column: &str) -> &str {
        self.cells.iter().find(|(name, _)| name == column).map_or("", |(_, text)| text)
    }
}
