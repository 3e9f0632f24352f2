//! What can be wrong with the CSV files of a robot.

use std::fmt;
use std::path::{Path, PathBuf};

use sextant_channel::LogError;

use crate::diagnostic::Failure;

/// Why a log of a robot cannot be read or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RobotLogError {
    /// A file cannot be read.
    #[error("cannot read `{}`: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// A file cannot be written.
    #[error("cannot write `{}`: {why}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The header, or a row as a whole, is wrong.
    #[error("{}, line {line}: {problem}", .path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// Line of the file, from 1.
        line: usize,
        /// What is wrong.
        problem: String,
    },
    /// A cell is wrong.
    #[error("{}, line {line}, column `{column}`: found `{found}`; allowed: {allowed}", .path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// Line of the file, from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// What the cell says.
        found: String,
        /// What it may say.
        allowed: String,
    },
    /// The files do not make a reception log.
    #[error("`{}`: {why}", .path.display())]
    Log {
        /// The folder.
        path: PathBuf,
        /// What is wrong.
        why: LogError,
    },
    /// A log without stops has nothing that its receptions could refer to.
    #[error("`{}`: the log has no stops; a folder needs one at least", .path.display())]
    NoStops {
        /// The folder.
        path: PathBuf,
    },
}

impl RobotLogError {
    /// Whether the disk or the system is at fault (exit code 1), and not what was given (exit code 2).
    #[must_use]
    pub fn is_of_the_system(&self) -> bool {
        matches!(self, Self::Write { .. })
    }

    pub(super) fn read(path: &Path, why: impl fmt::Display) -> Self {
        Self::Read { path: path.to_owned(), why: why.to_string() }
    }

    pub(super) fn write(path: &Path, why: impl fmt::Display) -> Self {
        Self::Write { path: path.to_owned(), why: why.to_string() }
    }
}

impl From<RobotLogError> for Failure {
    fn from(error: RobotLogError) -> Self {
        if error.is_of_the_system() { Self::failed(error.to_string()) } else { Self::bad_input(error.to_string()) }
    }
}
