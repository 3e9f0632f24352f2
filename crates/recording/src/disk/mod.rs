//! The one place where files and folders are changed, so that a test can put a disk that fails under all of them.
//!
//! The functions do what those of [`std::fs`] do. With the feature `failing-disk`, which only tests turn on, the disk that
//! a test put below a folder is asked before each change there. The program has neither such disks nor the question.

mod change;
mod file;
#[cfg(feature = "failing-disk")]
mod replaced;
#[cfg(feature = "failing-disk")]
mod simulated;
#[cfg(not(feature = "failing-disk"))]
mod system;

use std::fs;
use std::io::{self, Write};
use std::path::Path;
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

pub use change::{Change, FileNumber};
pub use file::DiskFile;
#[cfg(feature = "failing-disk")]
pub use replaced::{Disk, Replaced, replace};
#[cfg(feature = "failing-disk")]
use replaced::{FileDisk, permit};
#[cfg(feature = "failing-disk")]
pub use simulated::{Luck, SimulatedDisk, Trouble};
#[cfg(not(feature = "failing-disk"))]
use system::{FileDisk, permit};

/// So long is waited for a process that reads a pipe: less than the time in which a signal ends the program.
const READER_COMES_WITHIN: Duration = Duration::from_millis(500);

/// Writes to a device or a pipe, which has no name to be given at the end.
///
/// # Errors
/// Those of the system; [`io::ErrorKind::TimedOut`] if it is a pipe that no process reads.
pub(crate) fn write_device(path: &Path, bytes: &[u8]) -> io::Result<()> {
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
    permit(to, &Change::Rename { from, to })?;
    fs::rename(from, to)
}

/// Removes a file, as [`fs::remove_file`].
///
/// # Errors
/// Those of the system.
pub fn remove_file(path: &Path) -> io::Result<()> {
    permit(path, &Change::Remove { path })?;
    fs::remove_file(path)
}

/// Creates a folder, as [`fs::create_dir`].
///
/// # Errors
/// Those of the system.
pub fn create_folder(path: &Path) -> io::Result<()> {
    permit(path, &Change::CreateFolder { path })?;
    fs::create_dir(path)
}

/// Creates a folder and those above it that do not exist, as [`fs::create_dir_all`]. They are there also after a power failure.
///
/// # Errors
/// Those of the system, and if a file has the name of one of the folders.
pub fn create_folders(path: &Path) -> io::Result<()> {
    if path.is_dir() || path.as_os_str().is_empty() {
        return Ok(());
    }
    if path.is_file() {
        let problem = format!("`{}` is a file, and a folder is needed", path.display());
        return Err(io::Error::new(io::ErrorKind::AlreadyExists, problem));
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
    permit(path, &Change::RemoveFolder { path })?;
    fs::remove_dir_all(path)
}

/// Makes the names in the folder of `path` reach the disk: a file that was renamed has its new name also after a power failure.
///
/// # Errors
/// Those of the system.
pub fn sync_folder_of(path: &Path) -> io::Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    permit(path, &Change::SyncFolder { path: folder })?;
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_where_a_folder_is_needed_is_told_by_its_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("mine.csv");
        fs::write(&file, "a,b").unwrap();
        for path in [file.clone(), file.join("figures")] {
            let refused = create_folders(&path).unwrap_err().to_string();
            assert!(refused.ends_with("mine.csv` is a file, and a folder is needed"), "{refused}");
        }
        create_folders(&folder.path().join("a/b")).unwrap();
        assert!(folder.path().join("a/b").is_dir());
    }
}
