//! A small file, written at once.

use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use super::draft::part_of;
use super::error::OutputError;
use crate::disk::{self, DiskFile};

/// A file that appears completely or not at all, also if the power fails: it has a temporary name of its own, and is renamed when
/// it is on the disk. Devices and pipes get all at the end.
#[derive(Debug)]
pub struct WholeFile {
    path: PathBuf,
    draft: Draft,
}

#[derive(Debug)]
enum Draft {
    File { part: PathBuf, file: BufWriter<DiskFile> },
    Device(Vec<u8>),
    Finished,
}

impl WholeFile {
    /// Creates the empty file under its temporary name.
    ///
    /// # Errors
    /// If it cannot be created.
    pub fn create(path: &Path) -> Result<Self, OutputError> {
        Self::begin(path).map_err(|error| OutputError::new(path, &error))
    }

    fn begin(path: &Path) -> io::Result<Self> {
        let draft = if path.exists() && !path.is_file() && !path.is_dir() {
            Draft::Device(Vec::new())
        } else {
            let (part, file) = private(path)?;
            Draft::File { part, file: BufWriter::new(file) }
        };
        Ok(Self { path: path.to_owned(), draft })
    }

    /// Gives the file its name. If that fails, it is removed.
    ///
    /// # Errors
    /// If it cannot be written.
    pub fn finish(self) -> Result<(), OutputError> {
        let path = self.path.clone();
        self.end().map_err(|error| OutputError::new(&path, &error))
    }

    fn end(mut self) -> io::Result<()> {
        match &mut self.draft {
            Draft::Finished => {}
            Draft::Device(bytes) => disk::write_device(&self.path, bytes)?,
            Draft::File { part, file } => {
                file.flush()?;
                file.get_ref().sync()?;
                disk::rename(part, &self.path)?;
            }
        }
        let is_file = matches!(std::mem::replace(&mut self.draft, Draft::Finished), Draft::File { .. });
        if is_file { disk::sync_folder_of(&self.path) } else { Ok(()) }
    }
}

impl Write for WholeFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.draft {
            Draft::File { file, .. } => file.write(bytes),
            Draft::Device(all) => all.write(bytes),
            Draft::Finished => Ok(bytes.len()),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.draft {
            Draft::File { file, .. } => file.flush(),
            Draft::Device(_) | Draft::Finished => Ok(()),
        }
    }
}

impl Drop for WholeFile {
    fn drop(&mut self) {
        // What is left in the buffer is not wanted any more.
        if let Draft::File { part, file } = std::mem::replace(&mut self.draft, Draft::Finished) {
            let _ = file.into_parts();
            // Only the first error is reported.
            let _ = disk::remove_file(&part);
        }
    }
}

/// Writes `bytes` to the file at `path` as a [`WholeFile`].
///
/// # Errors
/// If the file cannot be written.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = WholeFile::begin(path)?;
    file.write_all(bytes)?;
    file.end()
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
