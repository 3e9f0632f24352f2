//! Errors of output files.

use std::io;
use std::path::{Path, PathBuf};

/// An output file or folder cannot be written.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{}` cannot be written: {why}", .path.display())]
pub struct OutputError {
    /// The file or folder.
    pub path: PathBuf,
    /// The system's answer.
    pub why: String,
}

impl OutputError {
    /// The file or folder at `path` cannot be written, because of `error`.
    #[must_use]
    pub fn new(path: &Path, error: &io::Error) -> Self {
        Self { path: path.to_owned(), why: error.to_string() }
    }
}
