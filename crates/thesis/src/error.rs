//! Errors of the reproduction.

use sextant::run::RunError;
use sextant::scenario::ScenarioErrors;
use sextant::sweep::SweepError;
use sextant_kernel::Interrupted;
use sextant_recording::RecordingError;
use sextant_recording::output::OutputError;

/// Why a table or figure cannot be reproduced.
#[derive(Clone, Debug, thiserror::Error)]
pub enum ReproductionError {
    /// A scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The runs failed as a whole.
    #[error(transparent)]
    Sweep(SweepError),
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
