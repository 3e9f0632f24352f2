//! Errors of a run.

use std::path::PathBuf;

use sextant_kernel::text::counted;
use sextant_kernel::{Interrupted, SettingError};
use sextant_mapper::MapError;
use sextant_recording::RecordingError;
use sextant_recording::output::OutputError;
use sextant_sim::DiscoveryError;

use super::programs::ProgramError;

/// Why a run of a scenario failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunError {
    /// Parts of the scenario do not fit together.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A program of the caller's own cannot be given to a station.
    #[error(transparent)]
    Program(#[from] ProgramError),
    /// A map cannot be computed.
    #[error(transparent)]
    Map(MapError),
    /// The map of an application has too few places.
    #[error("the map `{map}` of the application `{application}` has {}; a map needs more", counted(*.places, "place"))]
    FewPlaces {
        /// Name of the map.
        map: String,
        /// Name of the application.
        application: String,
        /// Number of nodes with a place in the map.
        places: usize,
    },
    /// The recording or the capture cannot be written.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A file that the scenario names cannot be read any more.
    #[error("`{}`, which the scenario names, cannot be read: {why}", .path.display())]
    NamedFile {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// Two layers of the scenario name different files by the same path.
    #[error(
        "the scenario and the one that it extends name two different files `{}`; a recording needs one name for each",
        .written.display()
    )]
    TwoFiles {
        /// The path.
        written: PathBuf,
    },
    /// An output file cannot be written.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// An observer failed.
    #[error("{0}")]
    Observer(String),
    /// The work was stopped before it had a result.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl RunError {
    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        match self {
            Self::Recording(error) => error.is_system_error(),
            Self::Output(_) | Self::Observer(_) => true,
            Self::NamedFile { .. }
            | Self::TwoFiles { .. }
            | Self::Setting(_)
            | Self::Program(_)
            | Self::Map(_)
            | Self::FewPlaces { .. }
            | Self::Interrupted(_) => false,
        }
    }

    /// How to correct it, if the message does not say so.
    #[must_use]
    pub fn advice(&self) -> Option<&'static str> {
        matches!(self, Self::FewPlaces { .. })
            .then_some("an application needs a map with at least three nodes that are not all in one place")
    }
}

impl From<MapError> for RunError {
    fn from(error: MapError) -> Self {
        match error {
            MapError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Map(error),
        }
    }
}

impl From<DiscoveryError> for RunError {
    fn from(error: DiscoveryError) -> Self {
        match error {
            DiscoveryError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            DiscoveryError::Setting(error) => Self::Setting(error),
        }
    }
}
