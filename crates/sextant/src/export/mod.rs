//! The tables of a recording as files for spreadsheets, pandas and databases.

mod csv;
mod error;
#[cfg(feature = "parquet")]
mod parquet;
mod stations;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;
use sextant_kernel::Watch;
use sextant_recording::output::{FileIdentity, open_folder, write_file};
use sextant_recording::{RecordingError, SCENARIO_ATTACHMENT, TablePiece, TableRow, read_tables, station};

pub use error::ExportError;

/// Rows between two looks at whether to go on.
const LOOK: u64 = 4096;

/// The file format of the tables.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ExportFormat {
    /// Comma-separated values (RFC 4180) with a header.
    #[default]
    Csv,
    /// Apache Parquet, if the feature `parquet` is on.
    Parquet,
}

/// A folder with the tables of a recording.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Exported {
    /// The tables, by name.
    pub tables: Vec<ExportedTable>,
    /// The files of the recording, as they are.
    pub files: Vec<PathBuf>,
    /// Topics that are no tables, such as meshes of obstacles.
    pub left_out: BTreeSet<String>,
}

/// A table that was written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct ExportedTable {
    /// Its name.
    pub table: String,
    /// Number of rows, without the header.
    pub rows: u64,
    /// The file.
    pub file: PathBuf,
}

/// A table that is being written.
trait TableFile {
    /// Adds a row.
    fn row(&mut self, row: &TableRow<'_>) -> Result<(), ExportError>;

    /// Completes the file, which has its final name then.
    fn finish(self: Box<Self>) -> Result<(), ExportError>;
}

/// Writes every table of the recording `path` into `folder`, one file each, and the files in it. A table without a row has
/// no file. Memory does not grow with the recording. Once `watch` stops the work, tables that are not complete are
/// removed.
///
/// # Errors
/// If the recording cannot be read or is damaged, a file cannot be written, the format is not built in, or the work was
/// stopped.
pub fn export(path: &Path, folder: &Path, format: ExportFormat, watch: &dyn Watch) -> Result<Exported, ExportError> {
    format.check()?;
    open_folder(folder)?;
    let recording = FileIdentity::of(path);
    let mut writing =
        Writing { recording, folder, format, tables: BTreeMap::new(), files: Vec::new(), collectors: Vec::new() };
    let mut failure = None;
    let mut rows: u64 = 0;
    let read = read_tables(path, &mut |piece| {
        rows += 1;
        if rows.is_multiple_of(LOOK) {
            watch.check()?;
        }
        // The reader knows its own errors only.
        writing.take(&piece).map_err(|error| {
            failure = Some(error);
            RecordingError::Interrupted(sextant_kernel::Interrupted)
        })
    });
    match (failure, read) {
        (Some(failure), _) => Err(failure),
        (None, Err(error)) => Err(error.into()),
        (None, Ok(left_out)) => writing.finish(left_out.topics),
    }
}

impl ExportFormat {
    fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
        }
    }

    /// An error if this build has no such format.
    fn check(self) -> Result<(), ExportError> {
        match self {
            Self::Parquet if cfg!(not(feature = "parquet")) => Err(ExportError::NoParquet),
            Self::Csv | Self::Parquet => Ok(()),
        }
    }

    fn create(self, path: &Path, row: &TableRow<'_>) -> Result<Box<dyn TableFile>, ExportError> {
        match self {
            Self::Csv => Ok(Box::new(csv::CsvTable::create(path, row.columns)?)),
            #[cfg(feature = "parquet")]
            Self::Parquet => Ok(Box::new(parquet::ParquetTable::create(path, row.columns)?)),
            #[cfg(not(feature = "parquet"))]
            Self::Parquet => Err(ExportError::NoParquet),
        }
    }
}

/// The files that are being written.
struct Writing<'a> {
    /// The recording that is read.
    recording: FileIdentity,
    folder: &'a Path,
    format: ExportFormat,
    tables: BTreeMap<String, OpenTable>,
    files: Vec<PathBuf>,
    /// The robots and sinks of the scenario: kind and name.
    collectors: Vec<(&'static str, String)>,
}

struct OpenTable {
    file: Box<dyn TableFile>,
    path: PathBuf,
    rows: u64,
}

impl Writing<'_> {
    fn take(&mut self, piece: &TablePiece<'_>) -> Result<(), ExportError> {
        match piece {
            TablePiece::Row(row) => self.row(row),
            TablePiece::Attachment { name, data } => {
                if *name == SCENARIO_ATTACHMENT {
                    self.collectors = stations::of_scenario(data);
                }
                self.file(name, data)
            }
        }
    }

    fn row(&mut self, row: &TableRow<'_>) -> Result<(), ExportError> {
        if !self.tables.contains_key(row.table) {
            let path = self.place(&format!("{}.{}", row.table, self.format.extension()))?;
            let file = self.format.create(&path, row)?;
            self.tables.insert(row.table.to_owned(), OpenTable { file, path, rows: 0 });
        }
        let Some(table) = self.tables.get_mut(row.table) else { return Ok(()) };
        table.rows += 1;
        table.file.row(row)
    }

    fn file(&mut self, name: &str, data: &[u8]) -> Result<(), ExportError> {
        let path = self.place(name)?;
        write_file(&path, data)?;
        self.files.push(path);
        Ok(())
    }

    /// The path in the folder of a table or file called `name`. Steps out of the folder are none, and letters that a file
    /// system may reject are replaced.
    fn place(&self, name: &str) -> Result<PathBuf, ExportError> {
        let plain = |letter: char| if letter.is_alphanumeric() || "-_.+ ".contains(letter) { letter } else { '_' };
        let parts = name.split(['/', '\\']).filter(|part| !matches!(*part, "" | "." | ".."));
        let parts: PathBuf = parts.map(|part| part.chars().map(plain).collect::<String>()).collect();
        let path = self.folder.join(parts);
        if let Some(folder) = path.parent() {
            open_folder(folder)?;
        }
        if FileIdentity::of(&path) == self.recording {
            return Err(ExportError::Input { path });
        }
        Ok(path)
    }

    fn finish(mut self, left_out: BTreeSet<String>) -> Result<Exported, ExportError> {
        let nodes = self.tables.get("stations").map_or(0, |table| table.rows);
        let collectors = std::mem::take(&mut self.collectors);
        for (index, (kind, name)) in (usize::try_from(nodes).unwrap_or(0)..).zip(collectors) {
            let (table, columns, cells) = station(index, kind, &name);
            self.row(&TableRow { table: &table, columns: &columns, cells: &cells })?;
        }
        let mut exported = Exported { tables: Vec::new(), files: self.files, left_out };
        for (table, OpenTable { file, path, rows }) in self.tables {
            file.finish()?;
            exported.tables.push(ExportedTable { table, rows, file: path });
        }
        Ok(exported)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_tables_stay_in_the_folder() {
        let folder = tempfile::tempdir().unwrap();
        let writing = Writing {
            recording: FileIdentity::of(&folder.path().join("run.csv")),
            folder: folder.path(),
            format: ExportFormat::Csv,
            tables: BTreeMap::new(),
            files: Vec::new(),
            collectors: Vec::new(),
        };
        assert_eq!(writing.place("map-a:b.csv").unwrap(), folder.path().join("map-a_b.csv"));
        assert!(matches!(writing.place("run.csv"), Err(ExportError::Input { .. })));
        assert_eq!(writing.place("files/../../x.csv").unwrap(), folder.path().join("files/x.csv"));
    }

    #[test]
    #[cfg(not(feature = "parquet"))]
    fn the_error_without_parquet_names_the_feature() {
        let error = ExportFormat::Parquet.check().unwrap_err();
        assert!(error.advice().is_some_and(|advice| advice.contains("--features parquet")), "{error:?}");
    }
}
