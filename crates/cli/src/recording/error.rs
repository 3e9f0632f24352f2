//! What can go wrong with a recording.

use std::fmt;
use std::path::{Path, PathBuf};

use sextant_channel::LogError;
use sextant_kernel::Interrupted;

use crate::diagnostic::Failure;
use crate::output::DraftError;

/// Why a recording could not be written or read. Clonable, because the first failure of a recorder is
/// the answer to every later call.
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
    /// A write failed; what was written until then is in `PATH.part`.
    #[error("cannot write `{}`: {why}; what was written before is left there, and `sextant recover` reads it", .path.display())]
    Write {
        /// The file that was being written.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// A write to a capture failed; the frames written until then are in `PATH.part`.
    #[error("cannot write `{}`: {why}; the frames written before are left there", .path.display())]
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
    /// The finished file cannot be given its name.
    #[error("cannot rename `{}` to `{}`: {why}", .part.display(), .path.display())]
    Rename {
        /// The finished file.
        part: PathBuf,
        /// The name that it should have.
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
    #[error("`{}` is not an MCAP file: it does not begin with the eight bytes of one", .path.display())]
    NotMcap {
        /// The file.
        path: PathBuf,
    },
    /// The file is damaged or ends too early.
    #[error("`{}` is broken at byte {at_byte}, after {messages} messages: {why}; `sextant recover` restores what comes before", .path.display())]
    Broken {
        /// The file.
        path: PathBuf,
        /// How far the file was read (octets).
        at_byte: u64,
        /// Messages before the damage.
        messages: u64,
        /// What is wrong there.
        why: String,
    },
    /// The file has no reception log.
    #[error("`{}` has no reception log: no whole stop on a topic with schema `sextant.Stop`; its topics: {topics}", .path.display())]
    NoLog {
        /// The file.
        path: PathBuf,
        /// The topics that it has.
        topics: String,
    },
    /// A message does not say what its type should.
    #[error("`{}`, topic `{topic}`: {problem}", .path.display())]
    Message {
        /// The file.
        path: PathBuf,
        /// Topic of the message.
        topic: String,
        /// What is wrong with it.
        problem: String,
    },
    /// The messages do not make a reception log.
    #[error("`{}`: {why}", .path.display())]
    Log {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: LogError,
    },
    /// Recovery would overwrite what it reads.
    #[error("`{}` is the file to recover; give another name for the result", .path.display())]
    SameFile {
        /// The file.
        path: PathBuf,
    },
    /// The user interrupted the work.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl RecordingError {
    /// Whether the disk or the system is at fault (exit code 1), and not what was given (exit code 2).
    #[must_use]
    pub fn is_of_the_system(&self) -> bool {
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

impl From<DraftError> for RecordingError {
    fn from(error: DraftError) -> Self {
        match error {
            DraftError::Create { path, why } => Self::Create { path, why },
            DraftError::Write { path, why } => Self::Write { path, why: why.to_string() },
            DraftError::Rename { part, path, why } => Self::Rename { part, path, why: why.to_string() },
        }
    }
}

impl From<RecordingError> for Failure {
    fn from(error: RecordingError) -> Self {
        match error {
            RecordingError::Interrupted(_) => Self::Interrupted,
            error if error.is_of_the_system() => Self::failed(error.to_string()),
            error => Self::bad_input(error.to_string()),
        }
    }
}

/// The system's answer below an error of the container, or the error itself.
pub(super) fn cause(error: &mcap::McapError) -> String {
    match error {
        mcap::McapError::Io(system) => system.to_string(),
        other => other.to_string(),
    }
}
