//! The tables of a recording as files for spreadsheets, pandas and databases.

mod csv;
mod error;
#[cfg(feature = "parquet")]
mod parquet;
mod stage;
mod stations;

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::Serialize;
use sextant_kernel::Watch;
use sextant_recording::output::{FileIdentity, open_folder, write_file};
use sextant_recording::{LeftOut, RecordingError, SCENARIO_ATTACHMENT, TablePiece, TableRow, read_tables, station};

pub use error::ExportError;
pub use sextant_logs::INCOMPLETE;
use stage::Stage;
pub use stations::station_names;

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
    /// The files of the recording that could not be written.
    pub failed: Vec<FailedFile>,
    /// Topics that are no tables, such as meshes of obstacles.
    pub left_out: BTreeSet<String>,
    /// What the user should know if the recording is incomplete. [`INCOMPLETE`] has it too.
    pub concern: Option<String>,
    /// Other files in the folder, which were there before.
    pub stayed: Vec<PathBuf>,
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

/// A file of a recording that could not be written.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FailedFile {
    /// Its name in the recording.
    pub name: String,
    /// Why not.
    pub why: String,
}

/// A table that is being written.
trait TableFile {
    /// Adds a row.
    fn row(&mut self, row: &TableRow<'_>) -> Result<(), ExportError>;

    /// Completes the file, which has its final name then.
    fn finish(self: Box<Self>) -> Result<(), ExportError>;
}

/// Writes every table of the recording `path` into `folder`, one file each, and the files in it. A table without a row has
/// no file. Memory does not grow with the recording. A file of the recording that cannot be written is named in the result,
/// and the others are written. All files get their places when the last one is written: if the work fails or `watch` stops it,
/// the folder is as it was before.
///
/// # Errors
/// If the recording cannot be read or is damaged, a table cannot be written, the format is not built in, or the work was
/// stopped.
pub fn export(path: &Path, folder: &Path, format: ExportFormat, watch: &dyn Watch) -> Result<Exported, ExportError> {
    format.check()?;
    let stage = Stage::open(folder)?;
    let mut writing = Writing::new(FileIdentity::of(path), folder, format, &stage);
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
    let read = match (failure, read) {
        (Some(failure), _) => Err(failure),
        (None, read) => read.map_err(ExportError::from),
    };
    writing.finish(read?)
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
    stage: &'a Stage,
    tables: BTreeMap<String, OpenTable>,
    files: Vec<PathBuf>,
    failed: Vec<FailedFile>,
    /// What each path in the folder is of, in small letters, because some file systems do not distinguish them from capital
    /// ones.
    taken: BTreeMap<String, Named>,
    /// The robots and sinks of the scenario: kind and name.
    collectors: Vec<(&'static str, String)>,
}

/// What a file in the folder is of.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Named {
    Table(String),
    File(String),
}

struct OpenTable {
    file: Box<dyn TableFile>,
    path: PathBuf,
    rows: u64,
}

/// The folder of files of a recording whose names could be those of tables.
const FILES: &str = "files";

impl<'a> Writing<'a> {
    fn new(recording: FileIdentity, folder: &'a Path, format: ExportFormat, stage: &'a Stage) -> Self {
        Self {
            recording,
            folder,
            format,
            stage,
            tables: BTreeMap::new(),
            files: Vec::new(),
            failed: Vec::new(),
            taken: BTreeMap::new(),
            collectors: Vec::new(),
        }
    }

    fn take(&mut self, piece: &TablePiece<'_>) -> Result<(), ExportError> {
        match piece {
            TablePiece::Row(row) => self.row(row),
            TablePiece::Attachment { name, data } => {
                if *name == SCENARIO_ATTACHMENT {
                    self.collectors = stations::of_scenario(data);
                }
                self.file(name, data);
                Ok(())
            }
        }
    }

    fn row(&mut self, row: &TableRow<'_>) -> Result<(), ExportError> {
        if !self.tables.contains_key(row.table) {
            let named = Named::Table(row.table.to_owned());
            let path = self.place(&below(row.table), self.format.extension(), named);
            if FileIdentity::of(&path) == self.recording {
                return Err(ExportError::Input { path });
            }
            let staged = self.stage.place(&path);
            staged.parent().map_or(Ok(()), open_folder)?;
            let file = self.format.create(&staged, row)?;
            self.tables.insert(row.table.to_owned(), OpenTable { file, path, rows: 0 });
        }
        let Some(table) = self.tables.get_mut(row.table) else { return Ok(()) };
        table.rows += 1;
        table.file.row(row)
    }

    /// Writes a file of the recording, or remembers why not.
    fn file(&mut self, name: &str, data: &[u8]) {
        match self.written(name, data) {
            Ok(path) if self.files.contains(&path) => {}
            Ok(path) => self.files.push(path),
            Err(why) => self.failed.push(FailedFile { name: name.to_owned(), why }),
        }
    }

    fn written(&mut self, name: &str, data: &[u8]) -> Result<PathBuf, String> {
        let mut below = below(name);
        if below.file_name().is_none() {
            return Err("its name is that of no file".to_owned());
        }
        let extension =
            below.extension().map(|extension| extension.to_string_lossy().into_owned()).unwrap_or_default();
        if below.components().count() == 1 && extension.eq_ignore_ascii_case(self.format.extension()) {
            below = Path::new(FILES).join(below);
        }
        let path = self.place(&below.with_extension(""), &extension, Named::File(name.to_owned()));
        if FileIdentity::of(&path) == self.recording {
            return Err(ExportError::Input { path }.to_string());
        }
        let staged = self.stage.place(&path);
        let written = staged.parent().map_or(Ok(()), open_folder).and_then(|()| write_file(&staged, data));
        written.map(|()| path).map_err(|error| error.to_string())
    }

    /// The path in the folder of what is `named`, by its way without the extension. One that is taken gets a number.
    fn place(&mut self, stem: &Path, extension: &str, named: Named) -> PathBuf {
        let mut number = 1;
        loop {
            let mut below = stem.as_os_str().to_owned();
            if number > 1 {
                below.push(format!("-{number}"));
            }
            if !extension.is_empty() {
                below.push(format!(".{extension}"));
            }
            let key = below.to_string_lossy().to_lowercase();
            // The last of several files of one name counts, as for whoever reads the recording.
            if self.taken.get(&key).is_none_or(|other| *other == named) {
                self.taken.insert(key, named);
                return self.folder.join(below);
            }
            number += 1;
        }
    }

    /// The folders with reception logs, as beginnings of names: the folder itself, and one for each further network.
    fn log_folders(&self) -> Vec<String> {
        let of_networks = self.tables.keys().filter_map(|table| table.strip_suffix("/stops"));
        std::iter::once(String::new()).chain(of_networks.map(|folder| format!("{folder}/"))).collect()
    }

    fn finish(mut self, besides: LeftOut) -> Result<Exported, ExportError> {
        let nodes = self.tables.get("stations").map_or(0, |table| table.rows);
        let collectors = std::mem::take(&mut self.collectors);
        for (index, (kind, name)) in (usize::try_from(nodes).unwrap_or(0)..).zip(collectors) {
            let (table, columns, cells) = station(index, kind, &name);
            self.row(&TableRow { table: &table, columns: &columns, cells: &cells })?;
        }
        let LeftOut { topics, concern } = besides;
        if let Some(concern) = &concern {
            for folder in self.log_folders() {
                self.file(&format!("{folder}{INCOMPLETE}"), format!("{concern}\n").as_bytes());
            }
        }
        let (stage, before) = (self.stage, self.stage.files());
        let mut exported = Exported { failed: self.failed, left_out: topics, concern, ..Exported::default() };
        for (table, OpenTable { file, path, rows }) in self.tables {
            file.finish()?;
            exported.tables.push(ExportedTable { table, rows, file: path });
        }
        exported.tables.iter().try_for_each(|table| stage.publish(&table.file))?;
        for file in self.files {
            match stage.publish(&file) {
                Ok(()) => exported.files.push(file),
                Err(error) => {
                    let name = file.strip_prefix(self.folder).unwrap_or(&file).to_string_lossy().into_owned();
                    exported.failed.push(FailedFile { name, why: error.to_string() });
                }
            }
        }
        let is_new =
            |path: &PathBuf| exported.files.contains(path) || exported.tables.iter().any(|t| t.file == *path);
        let is_recording = |path: &PathBuf| FileIdentity::of(path) == self.recording;
        exported.stayed = before.into_iter().filter(|path| !is_new(path) && !is_recording(path)).collect();
        Ok(exported)
    }
}

/// The path below the folder of a table or file called `name`. Steps out of the folder are none, and letters that a file
/// system may reject are replaced.
fn below(name: &str) -> PathBuf {
    let plain = |letter: char| if letter.is_alphanumeric() || "-_.+ ".contains(letter) { letter } else { '_' };
    let parts = name.split(['/', '\\']).filter(|part| !matches!(*part, "" | "." | ".."));
    parts.map(|part| part.chars().map(plain).collect::<String>()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes files with these names into an empty folder, and returns their places below it, then the names that failed.
    fn placed(names: &[&str]) -> (Vec<String>, Vec<String>) {
        let folder = tempfile::tempdir().unwrap();
        let recording = FileIdentity::of(&folder.path().join("run.mcap"));
        let stage = Stage::open(folder.path()).unwrap();
        let mut writing = Writing::new(recording, folder.path(), ExportFormat::Csv, &stage);
        names.iter().for_each(|name| writing.file(name, name.as_bytes()));
        let exported = writing.finish(LeftOut::default()).unwrap();
        let below = |path: &PathBuf| {
            assert!(path.is_file(), "{path:?}");
            path.strip_prefix(folder.path()).unwrap().to_string_lossy().into_owned()
        };
        (exported.files.iter().map(below).collect(), exported.failed.into_iter().map(|failed| failed.name).collect())
    }

    #[test]
    fn files_stay_in_the_folder_and_one_without_a_place_does_not_stop_the_others() {
        let long = "a".repeat(300);
        let names = ["a:b.toml", "files/../../x.csv", "", "..", "/", &long, "run.mcap", "x", "x/y", "last.txt"];
        let (files, failed) = placed(&names);
        assert_eq!(files, ["a_b.toml", "files/x.csv", "x", "last.txt"]);
        assert_eq!(failed, ["", "..", "/", &long, "run.mcap", "x/y"]);
    }

    #[test]
    fn no_file_takes_the_name_of_a_table_or_of_another_file() {
        let (files, failed) = placed(&["stops.csv", "a:b.toml", "a?b.toml", "A_B.toml", "a:b.toml", "note", "NOTE"]);
        assert_eq!(files, ["files/stops.csv", "a_b.toml", "a_b-2.toml", "A_B-3.toml", "note", "NOTE-2"]);
        assert_eq!(failed, [""; 0]);
    }

    #[test]
    #[cfg(not(feature = "parquet"))]
    fn the_error_without_parquet_names_the_feature() {
        let error = ExportFormat::Parquet.check().unwrap_err();
        assert!(error.advice().is_some_and(|advice| advice.contains("--features parquet")), "{error:?}");
    }
}
