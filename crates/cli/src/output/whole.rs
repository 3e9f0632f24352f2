//! A small file, written in one piece.

use std::io;
use std::path::Path;

use super::draft::part_of;
use crate::diagnostic::Failure;

/// Writes `bytes` to the file at `path`, whole or not at all: first beside it, then renamed. A device or a pipe is
/// written to as it is.
///
/// # Errors
/// If the system refuses.
pub(crate) fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.exists() && !path.is_file() && !path.is_dir() {
        return std::fs::write(path, bytes);
    }
    let part = part_of(path, ".part");
    std::fs::write(&part, bytes).and_then(|()| std::fs::rename(&part, path)).inspect_err(|_| {
        // Only the error that came first is worth telling.
        let _ = std::fs::remove_file(&part);
    })
}

/// The same as the last word of a command: a file that cannot be written is a failure.
///
/// # Errors
/// If the system refuses.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    write_whole(path, bytes).map_err(|error| Failure::unwritable(path, &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_nothing_is_left_beside_it() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write_whole(&path, b"first").unwrap();
        write_whole(&path, b"second").unwrap();
        assert_eq!(std::fs::read(&path).unwrap(), b"second");
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failed_write_leaves_what_was_there() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("taken");
        std::fs::create_dir(&path).unwrap();
        write_whole(&path, b"text").unwrap_err();
        assert!(path.is_dir());
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
