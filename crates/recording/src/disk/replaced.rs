//! Folders that have a disk of their own.

use std::fmt::Debug;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, PoisonError, RwLock};

use super::change::{Change, FileNumber};

/// Decides about the changes below a folder.
pub trait Disk: Debug + Send + Sync {
    /// Called before each change. The answer is how many octets of a [`Change::Write`] are taken; for other changes it does not
    /// matter.
    ///
    /// # Errors
    /// If the change fails; then it is not made.
    fn permit(&self, change: &Change<'_>) -> io::Result<usize>;
}

static DISKS: RwLock<Vec<(PathBuf, Arc<dyn Disk>)>> = RwLock::new(Vec::new());

/// A folder that has a disk of its own as long as this exists.
#[derive(Debug)]
#[must_use]
pub struct Replaced {
    folder: PathBuf,
}

/// Puts `disk` under all files below `folder`, an absolute path without links.
pub fn replace(folder: &Path, disk: Arc<dyn Disk>) -> Replaced {
    DISKS.write().unwrap_or_else(PoisonError::into_inner).push((folder.to_owned(), disk));
    Replaced { folder: folder.to_owned() }
}

impl Drop for Replaced {
    fn drop(&mut self) {
        DISKS.write().unwrap_or_else(PoisonError::into_inner).retain(|(folder, _)| *folder != self.folder);
    }
}

/// The disk under `path`, unless it is that of the system.
fn disk_under(path: &Path) -> Option<Arc<dyn Disk>> {
    let disks = DISKS.read().unwrap_or_else(PoisonError::into_inner);
    disks.iter().find(|(folder, _)| path.starts_with(folder)).map(|(_, disk)| Arc::clone(disk))
}

/// Asks the disk under `path`, if there is one, about a change.
pub(super) fn permit(path: &Path, change: &Change<'_>) -> io::Result<()> {
    match disk_under(path) {
        Some(disk) => disk.permit(change).map(|_| ()),
        None => Ok(()),
    }
}

/// The disk under an open file, unless it is that of the system, and the number of the file there.
#[derive(Debug)]
pub(super) struct FileDisk(Option<(Arc<dyn Disk>, FileNumber)>);

impl FileDisk {
    /// The disk under the file at `path`.
    pub(super) fn under(path: &Path) -> Self {
        static OPENED: AtomicU64 = AtomicU64::new(0);
        Self(disk_under(path).map(|disk| (disk, OPENED.fetch_add(1, Ordering::Relaxed))))
    }

    /// Asks whether the file may be opened by the name `path`.
    pub(super) fn permit_opening(&self, path: &Path) -> io::Result<()> {
        match &self.0 {
            Some((disk, file)) => disk.permit(&Change::Open { file: *file, path }).map(|_| ()),
            None => Ok(()),
        }
    }

    /// Asks whether what the file has may reach the disk.
    pub(super) fn permit_sync(&self) -> io::Result<()> {
        match &self.0 {
            Some((disk, file)) => disk.permit(&Change::Sync { file: *file }).map(|_| ()),
            None => Ok(()),
        }
    }

    /// Asks how many of the octets are taken; `None` if the system decides.
    pub(super) fn taken(&self, bytes: &[u8]) -> io::Result<Option<usize>> {
        match &self.0 {
            Some((disk, file)) => Ok(Some(disk.permit(&Change::Write { file: *file, bytes })?.min(bytes.len()))),
            None => Ok(None),
        }
    }
}
