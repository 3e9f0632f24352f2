//! Changes of files and folders.

use std::path::Path;

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
