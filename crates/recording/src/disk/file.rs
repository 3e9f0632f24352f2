//! A file that is written.

use std::fs::{File, OpenOptions};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use super::replaced::disk_under;
use super::{Change, Disk, FileNumber};

/// A file that is written from its beginning to its end, and may be read again.
#[derive(Debug)]
pub struct DiskFile {
    file: File,
    /// The disk under it, unless it is that of the system.
    disk: Option<(Arc<dyn Disk>, FileNumber)>,
}

impl DiskFile {
    /// Creates the file at `path`.
    ///
    /// # Errors
    /// [`io::ErrorKind::AlreadyExists`] if there is one, and those of the system.
    pub fn create_new(path: &Path) -> io::Result<Self> {
        let file = Self::open_with(path, OpenOptions::new().read(true).write(true).create_new(true))?;
        file.permit_opening(path).inspect_err(|_| {
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
        file.permit_opening(path)?;
        Ok(file)
    }

    fn open_with(path: &Path, options: &OpenOptions) -> io::Result<Self> {
        static OPENED: AtomicU64 = AtomicU64::new(0);
        let disk = disk_under(path).map(|disk| (disk, OPENED.fetch_add(1, Ordering::Relaxed)));
        Ok(Self { file: options.open(path)?, disk })
    }

    fn permit_opening(&self, path: &Path) -> io::Result<()> {
        match &self.disk {
            Some((disk, file)) => disk.permit(&Change::Open { file: *file, path }).map(|_| ()),
            None => Ok(()),
        }
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
        if let Some((disk, file)) = &self.disk {
            disk.permit(&Change::Sync { file: *file })?;
        }
        self.file.sync_all()
    }
}

impl Write for DiskFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let Some((disk, file)) = &self.disk else { return self.file.write(bytes) };
        let taken = disk.permit(&Change::Write { file: *file, bytes })?.min(bytes.len());
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
