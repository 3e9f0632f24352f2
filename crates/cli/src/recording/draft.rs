//! A file that bears another name until it is whole.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

use super::error::RecordingError;

/// A file that bears another name until it is whole.
pub(super) struct Draft {
    /// Name until then.
    pub(super) part: PathBuf,
    /// Name from then on.
    pub(super) path: PathBuf,
}

impl Draft {
    /// The file `path`, called `path` + `suffix` until it is whole.
    pub(super) fn new(path: &Path, suffix: &str) -> Self {
        let mut part = path.as_os_str().to_owned();
        part.push(suffix);
        Self { part: part.into(), path: path.to_owned() }
    }

    /// Creates it, empty.
    pub(super) fn open(&self) -> Result<BufWriter<File>, RecordingError> {
        if self.path.is_dir() {
            return Err(RecordingError::create(&self.path, "it is a folder"));
        }
        if self.path.exists() && !self.path.is_file() {
            return Err(RecordingError::create(&self.path, "it is a device or a pipe, not a file"));
        }
        let file = File::create(&self.part).map_err(|why| RecordingError::create(&self.part, why))?;
        Ok(BufWriter::new(file))
    }

    /// Syncs what was written, names the file, and syncs the folder, in this order: whoever sees the name sees a
    /// whole file, even after a power cut. `unwritten` says what a failed write is called.
    pub(super) fn name(
        &self,
        output: BufWriter<File>,
        unwritten: impl Fn(&Path, io::Error) -> RecordingError,
    ) -> Result<(), RecordingError> {
        let file = output.into_inner().map_err(|why| unwritten(&self.part, why.into_error()))?;
        file.sync_all().map_err(|why| unwritten(&self.part, why))?;
        drop(file);
        std::fs::rename(&self.part, &self.path).map_err(|why| RecordingError::Rename {
            part: self.part.clone(),
            path: self.path.clone(),
            why: why.to_string(),
        })?;
        sync_folder_of(&self.path).map_err(|why| unwritten(&self.path, why))
    }
}

#[cfg(unix)]
fn sync_folder_of(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    File::open(folder)?.sync_all()
}

/// Other systems cannot open a folder as a file; they order renames by themselves.
#[cfg(not(unix))]
fn sync_folder_of(_path: &Path) -> io::Result<()> {
    Ok(())
}
