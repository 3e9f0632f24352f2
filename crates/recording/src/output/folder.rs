//! A folder for several files.

use std::path::Path;

use super::error::OutputError;
use crate::disk::{self, DiskFile};

/// Creates the folder at `path` if it does not exist, and tries whether files can be written there, so that long work does
/// not end with an error that was foreseeable.
///
/// # Errors
/// If it cannot be created, or files cannot be written there.
pub fn open_folder(path: &Path) -> Result<(), OutputError> {
    let probe = path.join(format!(".sextant-{}.part", std::process::id()));
    disk::create_folders(path)
        .and_then(|()| DiskFile::create_new(&probe))
        .and_then(|_| disk::remove_file(&probe))
        .map_err(|error| OutputError::new(path, &error))
}
