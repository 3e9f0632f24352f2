//! Errors of captures that are read.

use std::io;
use std::path::{Path, PathBuf};

/// Why a capture cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CaptureError {
    /// The file cannot be opened or read.
    #[error("cannot read `{}`: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The file is of another format.
    #[error("`{}` is not a capture (pcap, pcapng), but {seen}", .path.display())]
    NotCapture {
        /// The file.
        path: PathBuf,
        /// What it is.
        seen: String,
    },
    /// The file is damaged.
    #[error("`{}` is damaged before byte {at_byte}: it has {problem}", .path.display())]
    Damaged {
        /// The file.
        path: PathBuf,
        /// Number of octets read.
        at_byte: u64,
        /// The error.
        problem: String,
    },
}

impl CaptureError {
    pub(super) fn read(path: &Path, why: &io::Error) -> Self {
        Self::Read { path: path.to_owned(), why: why.to_string() }
    }
}
