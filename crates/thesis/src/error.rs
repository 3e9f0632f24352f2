//! Errors of the reproduction.

use sextant::run::RunError;
use sextant::scenario::ScenarioErrors;
use sextant::summary::UnknownMeasure;
use sextant_kernel::Interrupted;
use sextant_recording::RecordingError;
use sextant_recording::output::OutputError;
use sextant_study::sweep::SweepError;

/// Why a table or figure cannot be reproduced.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ReproductionError {
    /// A scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The runs failed as a whole.
    #[error(transparent)]
    Sweep(SweepError),
    /// A table of runs cannot be written or read.
    #[error(transparent)]
    Table(#[from] sextant_study::sweep::TableError),
    /// A run failed.
    #[error(transparent)]
    Run(RunError),
    /// A recording cannot be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// The work was stopped; finished runs are kept.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl ReproductionError {
    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        match self {
            Self::Scenario(_) | Self::Interrupted(_) => false,
            Self::Sweep(error) => error.is_system_error(),
            Self::Table(error) => error.is_system_error(),
            Self::Run(error) => error.is_system_error(),
            Self::Recording(error) => error.is_system_error(),
            Self::Output(_) => true,
        }
    }
}

impl From<SweepError> for ReproductionError {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            SweepError::Scenario(errors) => Self::Scenario(errors),
            error => Self::Sweep(error),
        }
    }
}

impl From<RunError> for ReproductionError {
    fn from(error: RunError) -> Self {
        match error {
            RunError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Run(error),
        }
    }
}

/// Why the file of a table cannot be read.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub(crate) enum TableError {
    /// It is no table.
    #[error(transparent)]
    Toml(#[from] toml::de::Error),
    /// A path is that of no measure.
    #[error(transparent)]
    Measure(#[from] UnknownMeasure),
    /// A text refers to something that does not exist.
    #[error("`{text}` refers to `{name}`; known here: {known}")]
    NoVariable {
        /// The variable, or its field.
        name: String,
        /// The text.
        text: String,
        /// What exists.
        known: String,
    },
    /// There is no list of this name.
    #[error("there is no list `{list}`")]
    NoList {
        /// Its name.
        list: String,
    },
    /// An item of a list has no id.
    #[error("an item of the list `{list}` needs an `id`")]
    NoId {
        /// The list.
        list: String,
    },
    /// A list has no such item.
    #[error("the list `{list}` has no item `{id}`")]
    NoItem {
        /// The item.
        id: String,
        /// The list.
        list: String,
    },
    /// There are no shared entries of this name.
    #[error("the chapter shares no entries `{name}`")]
    NoShared {
        /// The name.
        name: String,
    },
    /// Nothing open has this name.
    #[error("`together` names `{name}`, which is the name of none of `[[open]]`")]
    NoOpen {
        /// The name.
        name: String,
    },
    /// A value of something open changes nothing.
    #[error("the value `{value}` of `{name}` needs `set`, `at`, `files` or `measures`")]
    NoChange {
        /// What is open.
        name: String,
        /// The value.
        value: String,
    },
    /// An entry lacks a key.
    #[error("`{what}` needs `{key}`")]
    Missing {
        /// The key.
        key: &'static str,
        /// The entry.
        what: String,
    },
    /// A line says in several ways how it is computed.
    #[error(
        "`{what}` is a line: it has at most one of `least`, `at_least` and `likelihood`, no `check` and no `terms`"
    )]
    Several {
        /// The line.
        what: String,
    },
    /// A condition compares another number of terms.
    #[error("the condition of `{what}` compares {found} terms; it needs {wanted}")]
    Terms {
        /// The conclusion.
        what: String,
        /// How many it needs.
        wanted: &'static str,
        /// How many it has.
        found: usize,
    },
    /// A horizontal value is not a number.
    #[error("the horizontal value `{text}` is not a number")]
    NoNumber {
        /// The value.
        text: String,
    },
}
