//! Errors of sweeps and of their tables.

use std::path::PathBuf;

use sextant_kernel::Interrupted;
use sextant_recording::output::OutputError;
use sextant_recording::output::store::StoreError;

use sextant_scenario::ScenarioErrors;

/// Why a sweep failed. A run that fails is no such error, but a row of the table.
#[derive(Clone, Debug, thiserror::Error)]
pub enum SweepError {
    /// The scenario or one of its cells is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The folder of finished runs is that of another sweep.
    #[error(
        "`{}` holds parts of a different sweep: the scenario, a file that it names, the seed, the number of runs, the shard or \
         the version has changed",
        .folder.display()
    )]
    OtherParts {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder of finished runs is that of this sweep, which is not to be resumed.
    #[error("`{}` holds parts of this sweep, which was interrupted", .folder.display())]
    Unfinished {
        /// The folder.
        folder: PathBuf,
    },
    /// Another process does the same sweep.
    #[error("`{}` is in use: another process does this sweep", .folder.display())]
    Busy {
        /// The folder.
        folder: PathBuf,
    },
    /// A file in the folder of finished runs is not one of them.
    #[error("`{}` is not a part of a sweep", .path.display())]
    Part {
        /// The file.
        path: PathBuf,
    },
    /// A file cannot be read.
    #[error("`{}` cannot be read: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The work was stopped; finished runs are kept.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<StoreError> for SweepError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Other { mut path } => {
                path.pop();
                Self::OtherParts { folder: path }
            }
            StoreError::Busy { folder } => Self::Busy { folder },
            StoreError::Invalid { path, .. } => Self::Part { path },
            StoreError::Read { path, why } => Self::Read { path, why: why.to_string() },
            StoreError::Output(error) => error.into(),
        }
    }
}

impl SweepError {
    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        matches!(self, Self::Read { .. } | Self::Output(_))
    }

    /// How to correct it, if the message does not say so.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::OtherParts { .. } => Some("remove the folder to start again, or choose another table"),
            Self::Unfinished { .. } => Some("resume the sweep, or remove the folder to start again"),
            Self::Busy { .. } => Some("wait for its end, or name another table"),
            Self::Part { .. } => Some("remove the file; its runs will be repeated"),
            Self::Scenario(_) | Self::Read { .. } | Self::Output(_) | Self::Interrupted(_) => None,
        }
    }
}

impl From<StoreError> for TableError {
    fn from(error: StoreError) -> Self {
        Self::Stored { why: error.to_string() }
    }
}

/// Why a table of a sweep cannot be written or drawn.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// The name of the file has an unknown extension.
    #[error("`{}` has the unknown extension `.{extension}`", .path.display())]
    Extension {
        /// The file.
        path: PathBuf,
        /// Its extension.
        extension: String,
    },
    /// The name of the file has no extension.
    #[error("`{}` has no extension", .path.display())]
    NoExtension {
        /// The file.
        path: PathBuf,
    },
    /// The file is to be one of Parquet, which this build cannot write.
    #[error("`{}` is a Parquet file, but this program was built without Parquet", .path.display())]
    NoParquet {
        /// The file.
        path: PathBuf,
    },
    /// The file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The file cannot be read.
    #[error("`{}` cannot be read: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The rows cannot be read again from where they are kept.
    #[error("finished runs cannot be read again: {why}")]
    Stored {
        /// What is wrong.
        why: String,
    },
    /// The rows of a file are not those of one sweep.
    #[error("`{}` has rows that no sweep writes: {why}", .path.display())]
    Rows {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The table has no rows.
    #[error("`{}` has no rows, so there is nothing to show", .path.display())]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// The file is not the table of a sweep.
    #[error("`{}` is not the table of a sweep: {why}", .path.display())]
    Other {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The table is of another sweep.
    #[error(
        "`{}` is the table of another sweep: the scenario, a file that it names, a setting, the first seed or the version differs",
        .path.display()
    )]
    OtherSweep {
        /// The file.
        path: PathBuf,
    },
    /// No setting has two numbers.
    #[error("`{}` has no setting with at least two numbers, so there is no axis", .path.display())]
    NoAxis {
        /// The file.
        path: PathBuf,
    },
    /// The table lacks the map or the value that others are to be compared with.
    #[error("`{}` has nothing called `{wanted}` to compare with", .path.display())]
    NoReference {
        /// The file.
        path: PathBuf,
        /// What is wanted.
        wanted: String,
        /// What there is.
        known: String,
    },
    /// No run of the reference has a partner.
    #[error(
        "`{}` has no pairs: none of {others} other rows has the seed, the number of the run and the other settings of one of the \
         {of_reference} rows of `{against}`",
        .path.display()
    )]
    NoPairs {
        /// The file.
        path: PathBuf,
        /// The map or value to compare with.
        against: String,
        /// Number of its rows.
        of_reference: usize,
        /// Number of other rows.
        others: usize,
    },
    /// The table lacks a measure.
    #[error("the table has no measure `{measure}`")]
    NoMeasure {
        /// The measure.
        measure: String,
        /// Its measures.
        known: String,
    },
}

impl TableError {
    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        matches!(self, Self::Output(_) | Self::Stored { .. })
    }

    /// How to correct it, if the message does not say so.
    #[must_use]
    pub fn advice(&self) -> Option<String> {
        Some(match self {
            Self::Extension { .. } | Self::NoExtension { .. } => "use the name TABLE.csv or TABLE.parquet".to_owned(),
            Self::NoParquet { .. } => "use the name TABLE.csv, or build the program with `cargo build --release \
                                       --features parquet`"
                .to_owned(),
            Self::Rows { .. } => "remove the rows that are wrong, and give each sweep a table of its own".to_owned(),
            Self::Other { .. } => "`sextant sweep SCENARIO.toml --out TABLE.csv` writes such a table".to_owned(),
            Self::NoRows { .. } => {
                "`sextant sweep SCENARIO.toml --out TABLE.csv` writes a row for each run".to_owned()
            }
            Self::NoAxis { .. } => "vary a number in [sweep] of the scenario".to_owned(),
            Self::NoPairs { .. } => {
                "compare runs that differ in this alone: with the same seeds, and no setting that changes with it"
                    .to_owned()
            }
            Self::NoMeasure { known, .. } | Self::NoReference { known, .. } => format!("it has {known}"),
            Self::Output(_) | Self::Read { .. } | Self::Stored { .. } | Self::OtherSweep { .. } => return None,
        })
    }
}
