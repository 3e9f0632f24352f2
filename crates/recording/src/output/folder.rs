//! A folder for several files.

use std::io;
use std::path::Path;

use super::error::OutputError;
use crate::disk::{self, DiskFile};

/// Creates the folder at `path` if it does not exist, and tries whether files can be written there, so that long work does
/// not end with an error that was foreseeable.
///
/// # Errors
/// If it cannot be created, or files cannot be written there.
pub fn open_folder(path: &Path) -> Result<(), OutputError> {
    disk::create_folders(path).and_then(|()| try_folder(path)).map_err(|error| OutputError::new(path, &error))
}

/// Tries whether files can be written in the folder at `path`.
///
/// # Errors
/// If not.
pub(crate) fn try_folder(path: &Path) -> io::Result<()> {
    let probe = path.join(format!(".sextant-{}.part", std::process::id()));
    match DiskFile::create_new(&probe) {
        Ok(_) => disk::remove_file(&probe),
        // A process with the same number was killed here, so that files can be written.
        Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Ok(()),
        Err(error) => Err(error),
    }
}
