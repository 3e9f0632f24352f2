//! Why a measurement is no code book.

use std::path::PathBuf;

/// Why a measurement is no code book.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ConvertError {
    /// The file cannot be read.
    #[error("`{path}` cannot be read: {cause}", path = .path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        cause: String,
    },
    /// The file is neither a MATLAB file nor text.
    #[error("`{path}` is neither a MATLAB file (version 5 to 7.2) nor a table in text", path = .0.display())]
    NotText(PathBuf),
    /// The MATLAB file is damaged, or of a version that is not read.
    #[error("the MATLAB file {0}")]
    Mat(String),
    /// The file has nothing by the name of something that is needed.
    #[error("no {what}: found {found}; allowed: {allowed}")]
    Missing {
        /// What is needed.
        what: &'static str,
        /// What the file has.
        found: String,
        /// The names that are known, and how to give another one.
        allowed: String,
    },
    /// The lengths of the arrays do not say which axis is which, or do not fit together.
    #[error("the array of gains is {found}; allowed: {allowed}")]
    Shape {
        /// Its dimensions, and those of the axes.
        found: String,
        /// What would fit.
        allowed: String,
    },
    /// A value is invalid.
    #[error("{place}: {found}; allowed: {allowed}")]
    Invalid {
        /// Where it is.
        place: String,
        /// The value.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// The gains look like factors, and nothing says that they are.
    #[error(
        "the unit of the gains is not known: no value is negative, and most are far below the greatest, {greatest}, as factors are; allowed: a given unit, `linear`, `db` or `dbi`"
    )]
    UnknownUnit {
        /// The greatest value.
        greatest: String,
    },
}
