//! A folder for several files.

use std::path::Path;

use super::error::OutputError;

/// Creates the folder at `path` if it does not exist, and tries whether files can be written there, so that long work does
/// not end with an error that was foreseeable.
///
/// # Errors
/// If it cannot be created, or files cannot be written there.
pub fn open_folder(path: &Path) -> Result<(), OutputError> {
    let probe = path.join(format!(".sextant-{}.part", std::process::id()));
    std::fs::create_dir_all(path)
        .and_then(|()| std::fs::write(&probe, b""))
        .and_then(|()| std::fs::remove_file(&probe))
        .map_err(|error| OutputError::new(path, &error))
}
