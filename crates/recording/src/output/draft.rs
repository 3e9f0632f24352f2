//! A file that has a temporary name until it is complete.

use std::fs::File;
use std::io::{self, BufWriter};
use std::path::{Path, PathBuf};

/// A file that has a temporary name until it is complete.
#[derive(Debug)]
pub(crate) struct Draft {
    /// The temporary name.
    pub(crate) part: PathBuf,
    /// The final name.
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
    /// The data cannot be written to the disk.
    Write {
        /// The file that was being written.
        path: PathBuf,
        /// The system's answer.
        why: io::Error,
    },
    /// It cannot be renamed.
    Rename {
        /// The finished file.
        part: PathBuf,
        /// Its final name.
        path: PathBuf,
        /// The system's answer.
        why: io::Error,
    },
}

/// The temporary name of the file `path`.
pub(super) fn part_of(path: &Path, suffix: &str) -> PathBuf {
    let mut part = path.as_os_str().to_owned();
    part.push(suffix);
    part.into()
}

impl Draft {
    /// The file `path`, which is called `path` + `suffix` until it is complete.
    pub(crate) fn new(path: &Path, suffix: &str) -> Self {
        Self { part: part_of(path, suffix), path: path.to_owned() }
    }

    /// Creates the empty file. Folders, devices and pipes are rejected, because a file cannot replace them.
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

    /// Syncs the file, renames it, and syncs the folder, in this order. So a file with the final name is complete, even
    /// after a power failure.
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

/// Other systems cannot open a folder as a file; they keep the order of renames without help.
#[cfg(not(unix))]
fn sync_folder_of(_path: &Path) -> io::Result<()> {
    Ok(())
}
