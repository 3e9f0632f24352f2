//! Errors of captures.

use std::path::PathBuf;

use sextant_recording::capture::CaptureError;

/// Why a capture cannot be read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SnifferError {
    /// The file cannot be read as a capture.
    #[error(transparent)]
    Capture(#[from] CaptureError),
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
