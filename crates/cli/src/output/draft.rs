//! A file that bears another name until it is whole.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A file that bears another name until it is whole.
#[derive(Debug)]
pub(crate) struct Draft {
    /// Name until then.
    pub(crate) part: PathBuf,
    /// Name from then on.
    pub(crate) path: PathBuf,
}

/// Why a draft did not become a file.
#[derive(Debug)]
pub(crate) enum DraftError {
    /// It cannot be created.
    Create {
        /// The file.
        path: PathBuf,
        /// The reason.
        why: String,
    },
    /// What was written does not reach the disk.
    Write {
        /// The file that was being written.
        path: PathBuf,
        /// The system's answer.
        why: io::Error,
    },
    /// It cannot be given its name.
    Rename {
        /// The finished file.
        part: PathBuf,
        /// The name that it should have.
        path: PathBuf,
        /// The system's answer.
        why: io::Error,
    },
}

/// The name of the file `path` until it is whole.
pub(super) fn part_of(path: &Path, suffix: &str) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(suffix);
    part.into()
}

impl Draft {
    /// The file `path`, called `path` + `suffix` until it is whole.
    pub(crate) fn new(path: &Path, suffix: &str) -> Self {
        Self { part: part_of(path, suffix), path: path.to_owned() }
    }

    /// Creates it, empty. A folder, a device and a pipe are refused: they cannot be replaced by a file.
    pub(crate) fn open(&self) -> Result<BufWriter<File>, DraftError> {
        let refused = |path: &Path, why: String| DraftError::Create { path: path.to_owned(), why };
        if self.path.is_dir() {
            return Err(refused(&self.path, "it is a folder".to_owned()));
        }
        if self.path.exists() && !self.path.is_file() {
            return Err(refused(&self.path, "it is a device or a pipe, not a file".to_owned()));
        }
        let file = File::create(&self.part).map_err(|why| refused(&self.part, why.to_string()))?;
        Ok(BufWriter::new(file))
    }

    /// Syncs what was written, names the file, and syncs the folder, in this order: whoever sees the name sees a
    /// whole file, even after a power cut.
    pub(crate) fn name(&self, output: BufWriter<File>) -> Result<(), DraftError> {
        let unwritten = |path: &Path, why: io::Error| DraftError::Write { path: path.to_owned(), why };
        let file = output.into_inner().map_err(|why| unwritten(&self.part, why.into_error()))?;
        file.sync_all().map_err(|why| unwritten(&self.part, why))?;
        drop(file);
        std::fs::rename(&self.part, &self.path).map_err(|why| DraftError::Rename {
            part: self.part.clone(),
            path: self.path.clone(),
            why,
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
