//! A small file, written at once.

use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::draft::part_of;
use super::error::OutputError;
use crate::disk::{self, DiskFile};

/// Writes `bytes` to the file at `path`, completely or not at all, also if the power fails: to a file with a temporary name of
/// its own, which is renamed when it is on the disk. Devices and pipes are written directly.
///
/// # Errors
/// If the file cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if path.exists() && !path.is_file() && !path.is_dir() {
        return disk::write_device(path, bytes);
    }
    let (part, mut file) = private(path)?;
    file.write_all(bytes).and_then(|()| file.sync()).and_then(|()| disk::rename(&part, path)).inspect_err(|_| {
        // Only the first error is reported.
        let _ = disk::remove_file(&part);
    })?;
    disk::sync_folder_of(path)
}

/// Does [`write_whole`] with an [`OutputError`], which names the file.
///
/// # Errors
/// If the file cannot be written.
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), OutputError> {
    write_whole(path, bytes).map_err(|error| OutputError::new(path, &error))
}

/// A new file beside `path` that no other writer has: its name holds the number of this process and a count.
fn private(path: &Path) -> io::Result<(PathBuf, DiskFile)> {
    static COUNT: AtomicU64 = AtomicU64::new(0);
    loop {
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let part = part_of(path, &format!(".{}-{count}.part", std::process::id()));
        match DiskFile::create_new(&part) {
            // A process with the same number was killed here.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            created => return created.map(|file| (part, file)),
        }
    }
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

    #[test]
    fn writers_at_the_same_time_leave_one_whole_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.json");
        std::thread::scope(|scope| {
            for letter in b'a'..=b'h' {
                let path = &path;
                scope.spawn(move || (0..50).for_each(|_| write_whole(path, &[letter; 10_000]).unwrap()));
            }
        });
        let text = std::fs::read(&path).unwrap();
        assert!(text.len() == 10_000 && text.iter().all(|letter| *letter == text[0]));
        assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1);
    }
}
