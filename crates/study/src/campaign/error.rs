//! Errors of plans.

use std::io;
use std::path::{Path, PathBuf};

use sextant::NumberRange;
use sextant_kernel::text::{counted, listed};
use sextant_kernel::{Interrupted, SettingError};
use sextant_recording::output::OutputError;
use sextant_recording::output::store::StoreError;
use sextant_scenario::ScenarioErrors;

use crate::sweep::TableError;

/// Why a plan cannot be made, or its work not be done.
#[derive(Clone, Debug, thiserror::Error)]
pub enum CampaignError {
    /// The scenario or one of its cells is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// There is a plan already.
    #[error("there is a plan in `{}`", .folder.display())]
    Exists {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder of a new plan has other files.
    #[error("`{}` is not empty: it has `{found}`", .folder.display())]
    NotEmpty {
        /// The folder.
        folder: PathBuf,
        /// A file in it.
        found: String,
    },
    /// The folder has no plan.
    #[error("`{}` has no plan: {why}", .folder.display())]
    NoPlan {
        /// The folder.
        folder: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// The plan is of another version of the program.
    #[error("the plan in `{}` is of version {found}; this is version {own}", .folder.display())]
    OtherVersion {
        /// The folder.
        folder: PathBuf,
        /// The version of the plan.
        found: String,
        /// The version of this program.
        own: &'static str,
    },
    /// A file of the plan is no longer what it was.
    #[error("`{}` was changed since the plan was made", .file.display())]
    Changed {
        /// The file.
        file: PathBuf,
    },
    /// A file of the plan is not what it should be.
    #[error("`{}` is no file of a plan: {why}", .path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// A value in a file of the plan is none that this program writes there.
    #[error("`{}` was changed since the plan was made: {error}", .file.display())]
    Invalid {
        /// The file.
        file: PathBuf,
        /// What is wrong.
        error: SettingError,
    },
    /// An option of `sbatch` in a file of the plan is one that only a user may choose.
    #[error(
        "`{}`: `settings.options` has `{}`; allowed in a plan, which somebody else may have written: {allowed}",
        .file.display(),
        .option.escape_debug()
    )]
    OptionOfUser {
        /// The file.
        file: PathBuf,
        /// The option.
        option: String,
        /// What is allowed, in words.
        allowed: String,
    },
    /// A job script cannot have this word.
    #[error("{what} is {found}, which a job script cannot have; allowed: {allowed}")]
    NoScript {
        /// What it is.
        what: &'static str,
        /// The word.
        found: String,
        /// What is allowed, in words.
        allowed: &'static str,
    },
    /// A file that is named by an absolute path cannot move with the plan.
    #[error("the scenario names `{}`; allowed in a plan: paths relative to the scenario", .file.display())]
    Absolute {
        /// The file.
        file: PathBuf,
    },
    /// The plan has no such runs.
    #[error("there are no runs {found}; the plan has the runs 0..{runs}")]
    Range {
        /// The range.
        found: NumberRange,
        /// Number of runs of the plan.
        runs: usize,
    },
    /// A part is of another plan.
    #[error("`{}` is a part of another plan", .path.display())]
    OtherPart {
        /// The file.
        path: PathBuf,
    },
    /// A file in the folder of parts is none.
    #[error("`{}` is not a part of a plan: {why}", .path.display())]
    Part {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        why: String,
    },
    /// Not all is done.
    #[error(
        "{missing} of {} are missing: {}",
        counted(*.runs, "run"),
        listed(&.ranges.iter().map(NumberRange::to_string).collect::<Vec<_>>())
    )]
    Missing {
        /// Number of runs that are missing.
        missing: usize,
        /// Number of runs of the plan.
        runs: usize,
        /// Which.
        ranges: Vec<NumberRange>,
    },
    /// A program of the cluster cannot be called, or refused.
    #[error("`{command}` failed: {why}")]
    Scheduler {
        /// The command line.
        command: String,
        /// What it said.
        why: String,
    },
    /// The plan was submitted before.
    #[error("the plan was submitted before, as {}", listed(.jobs))]
    Submitted {
        /// The jobs.
        jobs: Vec<String>,
    },
    /// The plan was never submitted.
    #[error("the plan in `{}` was never submitted", .folder.display())]
    NeverSubmitted {
        /// The folder.
        folder: PathBuf,
    },
    /// Somebody else submits at this moment, or was cut off while doing so.
    #[error("another submission is under way: `{}` has no job yet", .folder.display())]
    Submitting {
        /// The folder of the other submission.
        folder: PathBuf,
    },
    /// There is nothing to submit.
    #[error("nothing was submitted: {why}")]
    NothingToSubmit {
        /// Why.
        why: String,
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
    /// A table cannot be written.
    #[error(transparent)]
    Table(#[from] TableError),
    /// The work was stopped; what was done is kept.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl From<StoreError> for CampaignError {
    fn from(error: StoreError) -> Self {
        match error {
            StoreError::Other { path } => Self::OtherPart { path },
            StoreError::Invalid { path, why } => Self::Part { path, why },
            StoreError::Read { path, why } => Self::unreadable(path, &why),
            StoreError::Busy { folder } => {
                OutputError { path: folder, why: "another process does this work".to_owned() }.into()
            }
            StoreError::Output(error) => error.into(),
        }
    }
}

impl CampaignError {
    /// The file at `path` cannot be read.
    pub(super) fn unreadable(path: impl Into<PathBuf>, error: &io::Error) -> Self {
        let (path, why) = (path.into(), error.to_string());
        match error.kind() {
            io::ErrorKind::InvalidInput | io::ErrorKind::FileTooLarge | io::ErrorKind::InvalidData => {
                Self::Foreign { path, why }
            }
            _ => Self::Read { path, why },
        }
    }

    /// A value in `file` is invalid.
    pub(super) fn invalid(file: &Path, error: SettingError) -> Self {
        Self::Invalid { file: file.to_owned(), error }
    }

    /// Whether the disk, the system or the cluster caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        match self {
            Self::Read { .. } | Self::Output(_) | Self::Scheduler { .. } | Self::Missing { .. } => true,
            Self::Submitting { .. } | Self::NothingToSubmit { .. } => true,
            Self::Table(error) => error.is_system_error(),
            Self::Scenario(_)
            | Self::Exists { .. }
            | Self::NotEmpty { .. }
            | Self::NoPlan { .. }
            | Self::OtherVersion { .. }
            | Self::Changed { .. }
            | Self::Foreign { .. }
            | Self::Invalid { .. }
            | Self::OptionOfUser { .. }
            | Self::NoScript { .. }
            | Self::Absolute { .. }
            | Self::Range { .. }
            | Self::OtherPart { .. }
            | Self::Part { .. }
            | Self::Submitted { .. }
            | Self::NeverSubmitted { .. }
            | Self::Interrupted(_) => false,
        }
    }

    /// How to correct it, if the message does not say so.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        match self {
            Self::Exists { .. } => Some("go on with it, or replace it and all that was done of it by force"),
            Self::NotEmpty { .. } => Some("choose a new folder"),
            Self::OtherVersion { .. } => Some("use the program that made the plan, or make the plan again"),
            Self::Changed { .. } => Some("bring the file back, or make the plan again"),
            Self::Foreign { .. } | Self::Invalid { .. } => {
                Some("the plan was damaged or changed: bring the file back, or make the plan again")
            }
            Self::OptionOfUser { .. } => Some("give all options again with the command"),
            Self::NoScript { .. } => Some("move or rename the folder, or leave the word out"),
            Self::OtherPart { .. } | Self::Part { .. } => Some("move the file away; its runs will be done again"),
            Self::Missing { .. } => Some("submit what is missing, or do these runs here"),
            Self::Submitted { .. } => Some("resume it, which submits what is missing or failed"),
            Self::NeverSubmitted { .. } => Some("submit it"),
            Self::Submitting { .. } => {
                Some("look at the status in a minute; if the submission was cut off, remove the folder")
            }
            _ => None,
        }
    }
}
