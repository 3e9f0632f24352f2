//! The choice of a controller.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::SettingError;
use sextant_sim::Controller;

use crate::{AutomatedS, AutomatedSConfig, SPath, SPathConfig, Waypoints, WaypointsConfig};

/// What drives a robot, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ControllerConfig {
    /// An S path that finds its turns by what it hears and meets: no map needed.
    AutomatedS(AutomatedSConfig),
    /// A fixed S path over a region; the way round obstacles is planned.
    SPath(SPathConfig),
    /// Listed places; the way round obstacles is planned.
    Waypoints(WaypointsConfig),
}

/// What a robot has round it when it starts. Controllers with a planned path use it, others do not look.
#[derive(Clone, Copy)]
pub struct Surroundings<'a> {
    /// The obstacles.
    pub obstacles: &'a ObstacleField,
    /// Where the robot starts [m].
    pub start: Position,
    /// Radius of its hull [m].
    pub radius_m: f64,
}

impl ControllerConfig {
    /// The controller of a robot in `surroundings`.
    ///
    /// # Errors
    /// If a value is outside its domain, or a place cannot be reached. The key is relative to the controller's table.
    pub fn build(&self, surroundings: &Surroundings<'_>) -> Result<Box<dyn Controller>, SettingError> {
        match self {
            Self::AutomatedS(config) => {
                let controller = AutomatedS::try_from(config).map_err(|error| error.within("automated_s"))?;
                Ok(Box::new(controller))
            }
            Self::SPath(config) => {
                let controller = SPath::plan(config, surroundings).map_err(|error| error.within("s_path"))?;
                Ok(Box::new(controller))
            }
            Self::Waypoints(config) => {
                let controller = Waypoints::plan(config, surroundings).map_err(|error| error.within("waypoints"))?;
                Ok(Box::new(controller))
            }
        }
    }
}
