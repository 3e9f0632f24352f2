//! Errors of captures.

use std::path::{Path, PathBuf};

/// Why a capture cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SnifferError {
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
    /// The frames are of another technology.
    #[error(
        "`{}` has frames of link type {link} ({name}), which do not say which node was heard; allowed: 195 and 230 (IEEE \
         802.15.4), 283 (IEEE 802.15.4 TAP), 127 (IEEE 802.11 radiotap)", .path.display()
    )]
    UnknownLink {
        /// The file.
        path: PathBuf,
        /// The type of their link-layer header.
        link: u16,
        /// What it is.
        name: &'static str,
    },
    /// No frame names its sender.
    #[error("`{}` has no frame from which a node was heard{skipped}", .path.display())]
    NoFrames {
        /// The file.
        path: PathBuf,
        /// What was skipped, and why.
        skipped: String,
    },
}

impl SnifferError {
    pub(crate) fn read(path: &Path, why: &std::io::Error) -> Self {
        Self::Read { path: path.to_owned(), why: why.to_string() }
    }
}
