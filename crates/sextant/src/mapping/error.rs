//! Errors of maps of logs.

use std::path::PathBuf;

use sextant_kernel::Interrupted;
use sextant_logs::RobotLogError;
use sextant_mapper::{MapError, PartsError};
use sextant_recording::RecordingError;
use sextant_scenario::ScenarioErrors;

use super::tiles_error::TilesError;

/// Why a log cannot be mapped.
#[derive(Clone, Debug, thiserror::Error)]
pub enum MapLogError {
    /// The log of a robot cannot be read, or a map cannot be written.
    #[error(transparent)]
    Log(RobotLogError),
    /// The recording cannot be read.
    #[error(transparent)]
    Recording(RecordingError),
    /// The settings of the maps are invalid.
    #[error(transparent)]
    Settings(#[from] ScenarioErrors),
    /// Robots did not survey the network that was asked for.
    #[error("the network `{name}` was not surveyed; `{}` has the logs of {known}", .path.display())]
    Network {
        /// The network.
        name: String,
        /// The recording.
        path: PathBuf,
        /// Its networks.
        known: String,
    },
    /// Other names of nodes are for logs of robots.
    #[error("other names of nodes are for logs of robots, but `{}` is a recording of a run", .path.display())]
    Names {
        /// The recording.
        path: PathBuf,
    },
    /// The prior of the places is invalid.
    #[error("the {what} is {found}; allowed: {allowed}")]
    Prior {
        /// The part of the prior: the area, or the distance to the stops.
        what: &'static str,
        /// What was found.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// A map cannot be computed with the prior.
    #[error("the {what}: {why}")]
    UnusedPrior {
        /// The part of the prior: the area, or the distance to the stops.
        what: &'static str,
        /// Why not.
        why: MapError,
    },
    /// A map cannot be computed.
    #[error(transparent)]
    Map(MapError),
    /// A part of a log cannot be read by whoever has it.
    #[error("{0}")]
    Part(String),
    /// The log cannot be mapped tile by tile.
    #[error(transparent)]
    Tiles(#[from] TilesError),
    /// The work was stopped before it had a result.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

impl MapLogError {
    /// Whether the disk or the system caused the error, not the input.
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        match self {
            Self::Log(error) => error.is_system_error(),
            Self::Recording(error) => error.is_system_error(),
            Self::Tiles(error) => error.is_system_error(),
            _ => false,
        }
    }
}

impl From<RobotLogError> for MapLogError {
    fn from(error: RobotLogError) -> Self {
        match error {
            RobotLogError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Log(error),
        }
    }
}

impl From<RecordingError> for MapLogError {
    fn from(error: RecordingError) -> Self {
        match error {
            RecordingError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Recording(error),
        }
    }
}

impl From<MapError> for MapLogError {
    fn from(error: MapError) -> Self {
        match error {
            MapError::Interrupted(interrupted) => Self::Interrupted(interrupted),
            error => Self::Map(error),
        }
    }
}

impl From<PartsError> for MapLogError {
    fn from(error: PartsError) -> Self {
        match error {
            PartsError::Map(error) => error.into(),
            PartsError::Read(error) => match error.downcast::<TilesError>() {
                Ok(error) => Self::Tiles(*error),
                Err(other) => Self::Part(other.to_string()),
            },
        }
    }
}
