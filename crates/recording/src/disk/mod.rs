//! The one place where files and folders are changed, so that a test can put a disk that fails under all of them.
//!
//! The functions do what those of [`std::fs`] do. Before each [`Change`] below a folder that has a [`Disk`], that disk is
//! asked. Without one, which is always so in the program, nothing is asked.

mod file;
mod replaced;
mod simulated;

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

pub use file::DiskFile;
pub use replaced::{Disk, Replaced, replace};
pub use simulated::{Luck, SimulatedDisk, Trouble};

/// The number of an opened file. A file that is opened again gets another one.
pub type FileNumber = u64;

/// A change that is about to be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change<'a> {
    /// An empty file gets this name, or an existing empty one is opened.
    Open {
        /// The file.
        file: FileNumber,
        /// Its name.
        path: &'a Path,
    },
    /// Octets are added to a file: all are written from their beginning to their end.
    Write {
        /// The file.
        file: FileNumber,
        /// What is added.
        bytes: &'a [u8],
    },
    /// What a file has reaches the disk.
    Sync {
        /// The file.
        file: FileNumber,
    },
    /// A file or folder gets another name. A file that has this name is replaced.
    Rename {
        /// Its name.
        from: &'a Path,
        /// Its new name.
        to: &'a Path,
    },
    /// A file loses its name.
    Remove {
        /// Its name.
        path: &'a Path,
    },
    /// A new, empty folder.
    CreateFolder {
        /// Its name.
        path: &'a Path,
    },
    /// A folder is removed with all that is in it.
    RemoveFolder {
        /// Its name.
        path: &'a Path,
    },
    /// The names in a folder reach the disk.
    SyncFolder {
        /// The folder.
        path: &'a Path,
    },
}

/// So long is waited for a process that reads a pipe: less than the time in which a signal ends the program.
const READER_COMES_WITHIN: Duration = Duration::from_millis(500);

/// Writes to a device or a pipe, which has no name to be given at the end.
///
/// # Errors
/// Those of the system; [`io::ErrorKind::TimedOut`] if it is a pipe that no process reads.
pub fn write_device(path: &Path, bytes: &[u8]) -> io::Result<()> {
    // The system opens a pipe when somebody reads it, and gives no word before.
    let (opened, device) = mpsc::channel();
    let name = path.to_owned();
    thread::spawn(move || opened.send(fs::OpenOptions::new().write(true).open(name)));
    match device.recv_timeout(READER_COMES_WITHIN) {
        Ok(device) => device?.write_all(bytes),
        Err(_) => Err(io::Error::new(io::ErrorKind::TimedOut, "it is a pipe that no process reads")),
    }
}

/// Renames a file or folder, as [`fs::rename`].
///
/// # Errors
/// Those of the system.
pub fn rename(from: &Path, to: &Path) -> io::Result<()> {
    replaced::permit(to, &Change::Rename { from, to })?;
    fs::rename(from, to)
}

/// Removes a file, as [`fs::remove_file`].
///
/// # Errors
/// Those of the system.
pub fn remove_file(path: &Path) -> io::Result<()> {
    replaced::permit(path, &Change::Remove { path })?;
    fs::remove_file(path)
}

/// Creates a folder, as [`fs::create_dir`].
///
/// # Errors
/// Those of the system.
pub fn create_folder(path: &Path) -> io::Result<()> {
    replaced::permit(path, &Change::CreateFolder { path })?;
    fs::create_dir(path)
}

/// Creates a folder and those above it that do not exist, as [`fs::create_dir_all`]. They are there also after a power failure.
///
/// # Errors
/// Those of the system.
pub fn create_folders(path: &Path) -> io::Result<()> {
    if path.is_dir() || path.as_os_str().is_empty() {
        return Ok(());
    }
    if let Some(above) = path.parent() {
        create_folders(above)?;
    }
    create_folder(path).or_else(|error| if path.is_dir() { Ok(()) } else { Err(error) })?;
    sync_folder_of(path)
}

/// Removes a folder with all that is in it, as [`fs::remove_dir_all`].
///
/// # Errors
/// Those of the system.
pub fn remove_folder(path: &Path) -> io::Result<()> {
    replaced::permit(path, &Change::RemoveFolder { path })?;
    fs::remove_dir_all(path)
}

/// Makes the names in the folder of `path` reach the disk: a file that was renamed has its new name also after a power failure.
///
/// # Errors
/// Those of the system.
pub fn sync_folder_of(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    replaced::permit(path, &Change::SyncFolder { path: folder })?;
    sync_folder(folder)
}

/// Some file systems cannot sync a folder, and one that may be written need not be readable.
#[cfg(unix)]
fn sync_folder(folder: &Path) -> io::Result<()> {
    use io::ErrorKind::{InvalidInput, PermissionDenied, Unsupported};
    match fs::File::open(folder).and_then(|folder| folder.sync_all()) {
        Err(error) if matches!(error.kind(), InvalidInput | PermissionDenied | Unsupported) => Ok(()),
        other => other,
    }
}

/// Other systems cannot open a folder as a file; they keep the order of renames without help.
#[cfg(not(unix))]
fn sync_folder(_folder: &Path) -> io::Result<()> {
    Ok(())
}
