//! Errors of exports.

use std::path::PathBuf;

use sextant_kernel::Interrupted;
use sextant_recording::RecordingError;
use sextant_recording::output::OutputError;

/// Why the tables of a recording cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExportError {
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(RecordingError),
    /// A table or file would replace the recording.
    #[error("`{}` is the recording itself: an output never replaces an input", .path.display())]
    Input {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The tables are to be files of Parquet, which this build cannot write.
    #[error("the format `parquet` is missing: this program was built without it")]
    NoParquet,
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<RecordingError> for ExportError {
    fn from(error: RecordingError) -> Self {
        match error {
            RecordingError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Recording(error),
        }
    }
}

impl ExportError {
    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        match self {
            Self::Recording(error) => error.is_system_error(),
            Self::Output(_) => true,
            Self::Input { .. } | Self::NoParquet | Self::Interrupted(_) => false,
        }
    }

    /// How to correct it, if the message does not say so.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::NoParquet => Some("build the program with `--features parquet`, or write CSV"),
            Self::Input { .. } => Some("choose another folder"),
            Self::Recording(_) | Self::Output(_) | Self::Interrupted(_) => None,
        }
    }
}
