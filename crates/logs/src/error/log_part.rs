//! Where in a log something is: a part of it, and a row of that part.

use std::fmt;
use std::path::{Path, PathBuf};

/// A part of a log.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LogPart {
    /// A file or a folder.
    File(PathBuf),
    /// A table in memory, by its name.
    Table(String),
}

impl LogPart {
    /// Its name for notes: that of a file has no folder.
    pub(crate) fn name(&self) -> String {
        match self {
            Self::File(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            Self::Table(name) => name.clone(),
        }
    }

    /// What the part is, for messages.
    pub(crate) const fn noun(&self) -> &'static str {
        match self {
            Self::File(_) => "file",
            Self::Table(_) => "table",
        }
    }
}

impl fmt::Display for LogPart {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => path.display().fmt(f),
            Self::Table(name) => f.write_str(name),
        }
    }
}

impl From<&Path> for LogPart {
    fn from(path: &Path) -> Self {
        Self::File(path.to_owned())
    }
}

/// A row of a part of a log: `stops.csv, line 5` or `stops, row 3`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RowAddress {
    /// A line of a file.
    File {
        /// The file.
        path: PathBuf,
        /// Line of the file, from 1; the first one is the header.
        line: usize,
    },
    /// A row of a table in memory.
    Table {
        /// The name of the table.
        name: String,
        /// Its row, from 0; `None` if the error is that of the names of its columns.
        row: Option<usize>,
    },
}

impl RowAddress {
    /// The file, if it is one.
    #[must_use]
    pub fn file(&self) -> Option<&Path> {
        match self {
            Self::File { path, .. } => Some(path),
            Self::Table { .. } => None,
        }
    }

    /// The line of the file, from 1.
    #[must_use]
    pub const fn line(&self) -> Option<usize> {
        match self {
            Self::File { line, .. } => Some(*line),
            Self::Table { .. } => None,
        }
    }

    /// The name of the table in memory, if it is one.
    #[must_use]
    pub fn table(&self) -> Option<&str> {
        match self {
            Self::File { .. } => None,
            Self::Table { name, .. } => Some(name),
        }
    }

    /// The row of the table in memory, from 0.
    #[must_use]
    pub const fn row(&self) -> Option<usize> {
        match self {
            Self::File { .. } => None,
            Self::Table { row, .. } => *row,
        }
    }
}

impl fmt::Display for RowAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File { path, line } => write!(f, "{}, line {line}", path.display()),
            Self::Table { name, row: Some(row) } => write!(f, "{name}, row {row}"),
            Self::Table { name, row: None } => f.write_str(name),
        }
    }
}
