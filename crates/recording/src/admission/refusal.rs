//! What the user is told of outputs: why one may not be written, and what is replaced.

use std::fmt;
use std::path::PathBuf;

/// Why a command may not write one of its outputs.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum OutputRefusal {
    /// It would replace an input.
    #[error("{output} is an input of this command, `{}`: an output never replaces an input", .input.display())]
    Input {
        /// The output.
        output: String,
        /// The input.
        input: PathBuf,
    },
    /// Two outputs are one file, or one is called as the other one while that is written.
    #[error("{output} and {other} are the same file: name two different files")]
    Shared {
        /// An output.
        output: String,
        /// The other one.
        other: String,
    },
    /// It would replace a file that is not ours.
    #[error("{output} exists, and is not {kind}")]
    Foreign {
        /// The output.
        output: String,
        /// What it should be.
        kind: String,
    },
    /// It would replace a table.
    #[error("{output} exists")]
    Exists {
        /// The output.
        output: String,
    },
    /// Another process writes it.
    #[error("{output} is being written by another process")]
    Busy {
        /// The output.
        output: String,
    },
    /// The folder has files of others.
    #[error("the folder `{}` has files", .folder.display())]
    Folder {
        /// The folder.
        folder: PathBuf,
    },
    /// No file can be there.
    #[error("{output} cannot be written: {why}")]
    Place {
        /// The output.
        output: String,
        /// The reason.
        why: String,
    },
}

impl OutputRefusal {
    /// What to do.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Input { .. } => Some("name another file"),
            Self::Place { .. } => Some("name a file in a folder that exists and may be written"),
            Self::Shared { .. } => None,
            Self::Foreign { .. } | Self::Exists { .. } => Some("choose another name, or let it be replaced"),
            Self::Busy { .. } => Some("wait for its end, or name another file"),
            Self::Folder { .. } => Some("choose another folder, or let this one be written into"),
        }
    }
}

/// What the user should know of an output that may be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum OutputNote {
    /// A file will be replaced.
    Replaced {
        /// The file.
        path: PathBuf,
        /// What it is; nothing if it is not ours.
        what: Option<&'static str>,
    },
    /// A process that wrote the file ended early; what it left will have another name.
    LeftOver {
        /// What is left.
        part: PathBuf,
        /// Its new name.
        kept: PathBuf,
    },
}

impl fmt::Display for OutputNote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Replaced { path, what: Some(what) } => write!(f, "`{}` is replaced: it is {what}", path.display()),
            Self::Replaced { path, what: None } => write!(f, "`{}` is replaced", path.display()),
            Self::LeftOver { part, kept } => {
                let (part, kept) = (part.display(), kept.display());
                write!(f, "`{part}` is of a process that ended early; it is kept as `{kept}`")
            }
        }
    }
}
