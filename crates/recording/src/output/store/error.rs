//! Errors of stores.

use std::io;
use std::path::PathBuf;

use crate::output::OutputError;

/// Why a store cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// A file is of another work.
    #[error("`{}` is of other work", .path.display())]
    Other {
        /// The file.
        path: PathBuf,
    },
    /// Another process does the same work.
    #[error("`{}` is in use by another process", .folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// A file is no part.
    #[error("`{}` is not a part: {why}", .path.display())]
    Invalid {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// A file or folder cannot be read.
    #[error("`{}` cannot be read: {why}", .path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// The system's answer.
        why: io::Error,
    },
    /// A file or folder cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
}
