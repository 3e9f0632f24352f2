//! A file that is written.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;

use super::FileDisk;

/// A file that is written from its beginning to its end, and may be read again.
#[derive(Debug)]
pub struct DiskFile {
    file: File,
    disk: FileDisk,
}

impl DiskFile {
    /// Creates the file at `path`.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if there is one, and those of the system.
    pub fn create_new(path: &Path) -> io::Result<Self> {
        let file = Self::open_with(path, OpenOptions::new().read(true).write(true).create_new(true))?;
        file.disk.permit_opening(path).inspect_err(|_| {
            // Only the first error is reported.
            let _ = std::fs::remove_file(path);
        })?;
        Ok(file)
    }

    /// Opens the file at `path`, which exists.
    ///
    /// # Errors
    /// Those of the system.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = Self::open_with(path, OpenOptions::new().read(true).write(true))?;
        file.disk.permit_opening(path)?;
        Ok(file)
    }

    fn open_with(path: &Path, options: &OpenOptions) -> io::Result<Self> {
        let disk = FileDisk::under(path);
        Ok(Self { file: options.open(path)?, disk })
    }

    /// The open file of the system, to lock it or to look at it.
    #[must_use]
    pub fn system(&self) -> &File {
        &self.file
    }

    /// Makes what was written reach the disk.
    ///
    /// # Errors
    /// Those of the system.
    pub fn sync(&self) -> io::Result<()> {
        self.disk.permit_sync()?;
        self.file.sync_all()
    }
}

impl Write for DiskFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some(taken) = self.disk.taken(bytes)? else { return self.file.write(bytes) };
        self.file.write_all(&bytes[..taken])?;
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Read for &DiskFile {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        (&self.file).read(bytes)
    }
}

impl Seek for &DiskFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        (&self.file).seek(to)
    }
}
