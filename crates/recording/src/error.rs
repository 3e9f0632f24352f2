//! Errors of recordings.

use std::fmt;
use std::path::{Path, PathBuf};

use sextant_channel::LogError;
use sextant_kernel::Interrupted;

use crate::mcap_file::{McapFileError, cause};
use crate::output::DraftError;

/// Why a recording could not be written or read. Clonable, because a recorder returns its first failure from every later
/// call.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// The file cannot be created.
    #[error("cannot create `{}`: {why}", .path.display())]
    Create {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// Another process writes the file.
    #[error("`{}` is being written by another process: wait for its end, or name another file", .path.display())]
    Busy {
        /// The file.
        path: PathBuf,
    },
    /// A write failed; the data written before is in `PATH.part`.
    #[error("cannot write `{}`: {why}; the data written before is kept, and `sextant recover` can read it", .path.display())]
    Write {
        /// The file that was being written.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// A write to a capture failed; the frames written until then are in `PATH.part`.
    #[error("cannot write `{}`: {why}; the frames written before are kept", .path.display())]
    WriteCapture {
        /// The file that was being written.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// A write to a recovered copy failed; the incomplete copy was removed.
    #[error("cannot write `{}`: {why}; the incomplete copy was removed", .path.display())]
    WriteCopy {
        /// The copy.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The finished file cannot be renamed.
    #[error("cannot rename `{}` to `{}`: {why}", .part.display(), .path.display())]
    Rename {
        /// The finished file.
        part: PathBuf,
        /// Its final name.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The file cannot be opened or read.
    #[error("cannot read `{}`: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The file is of another format.
    #[error("`{}` is not an MCAP file, but {seen}", .path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
        /// What it is.
        seen: String,
    },
    /// The file has no octet.
    #[error("`{}` is empty, so there is nothing to read or to recover; record or copy it again", .path.display())]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The file is damaged or incomplete.
    #[error("`{}` is broken at byte {at_byte}, after {messages} messages: {why}; `sextant recover` copies all that can be read", .path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// Number of octets read.
        at_byte: u64,
        /// Messages before the damage.
        messages: u64,
        /// The error.
        why: String,
    },
    /// The file has no reception log.
    #[error("`{}` has no reception log: no complete stop on a topic with schema `sextant.Stop`; its topics: {topics}", .path.display())]
    NoLog {
        /// The file.
        path: PathBuf,
        /// Its topics.
        topics: String,
    },
    /// A message is invalid.
    #[error("`{}`, topic `{topic}`: {problem}", .path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// Topic of the message.
        topic: String,
        /// The error.
        problem: String,
    },
    /// The messages do not form a valid reception log.
    #[error("`{}`: {why}", .path.display())]
    Log {
        /// The file.
        path: PathBuf,
        /// The error.
        why: LogError,
    },
    /// Recovery would overwrite its input.
    #[error("`{}` is the file to recover; choose another name for the copy", .path.display())]
    SameFile {
        /// The file.
        path: PathBuf,
    },
    /// The user interrupted the work.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl RecordingError {
    /// Whether the disk or the system caused the error (exit code 1), not the input (exit code 2).
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        matches!(
            self,
            Self::Create { .. }
                | Self::Write { .. }
                | Self::WriteCapture { .. }
                | Self::WriteCopy { .. }
                | Self::Rename { .. }
        )
    }

    pub(super) fn write(path: &Path, why: &mcap::McapError) -> Self {
        Self::Write { path: path.to_owned(), why: cause(why) }
    }

    pub(super) fn read(path: &Path, why: impl fmt::Display) -> Self {
        Self::Read { path: path.to_owned(), why: why.to_string() }
    }

    pub(super) fn message(path: &Path, topic: &str, problem: impl fmt::Display) -> Self {
        Self::Message { path: path.to_owned(), topic: topic.to_owned(), problem: problem.to_string() }
    }
}

impl From<McapFileError> for RecordingError {
    fn from(error: McapFileError) -> Self {
        match error {
            McapFileError::Read { path, why } => Self::Read { path, why },
            McapFileError::Empty { path } => Self::Empty { path },
            McapFileError::NotMcap { path, seen } => Self::NotMcap { path, seen },
        }
    }
}

impl From<DraftError> for RecordingError {
    fn from(error: DraftError) -> Self {
        match error {
            DraftError::Create { path, why } => Self::Create { path, why },
            DraftError::Busy { path } => Self::Busy { path },
            DraftError::Write { path, why } => Self::Write { path, why: why.to_string() },
            DraftError::Rename { part, path, why } => Self::Rename { part, path, why: why.to_string() },
        }
    }
}
