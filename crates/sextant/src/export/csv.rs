//! Tables as CSV files.

use std::io::Write;
use std::path::Path;

use sextant_recording::output::{CsvFile, EmptyCell, OutputError, PartFile};
use sextant_recording::{TableColumn, TableRow};

use super::{ExportError, TableFile};

/// A CSV file of which one row is in memory.
pub(super) struct CsvTable {
    row: CsvFile,
    file: PartFile,
}

impl CsvTable {
    pub(super) fn create(path: &Path, columns: &[TableColumn]) -> Result<Self, ExportError> {
        let row = CsvFile::new(columns.iter().map(|column| &column.name), EmptyCell::Bare);
        let mut table = Self { row, file: PartFile::create(path)? };
        table.write()?;
        Ok(table)
    }

    fn write(&mut self) -> Result<(), ExportError> {
        let bytes = self.row.take();
        let written = self.file.write_all(&bytes);
        Ok(written.map_err(|error| OutputError::new(self.file.path(), &error))?)
    }
}

impl TableFile for CsvTable {
    fn row(&mut self, row: &TableRow<'_>) -> Result<(), ExportError> {
        self.row.row(row.cells.iter().map(ToString::to_string));
        self.write()
    }

    fn finish(self: Box<Self>) -> Result<(), ExportError> {
        Ok(self.file.finish()?)
    }
}
