//! A small file, written at once.

use std::io;
use std::path::Path;

use super::draft::part_of;
use super::error::OutputError;

/// Writes `bytes` to the file at `path`, completely or not at all: to `PATH.part`, which is then renamed. Devices and
/// pipes are written directly.
///
/// # Errors
/// If the file cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.exists() && !path.is_file() && !path.is_dir() {
        return std::fs::write(path, bytes);
    }
    let part = part_of(path, ".part");
    std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path)).inspect_err(|_| {
        // Only the first error is reported.
        let _ = std::fs::remove_file(&part);
    })
}

/// The same with an [`OutputError`], which names the file.
///
/// # Errors
/// If the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_whole(path, bytes).map_err(|error| OutputError::new(path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_and_no_temporary_file_remains() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, b"first").unwrap();
        write_whole(&path, b"second").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_write_changes_nothing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        std::fs::create_dir(&path).unwrap();
        write_whole(&path, b"text").unwrap_err();
        assert!(path.is_dir());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
