//! The way that a robot is expected to drive in a survey, before it does.

use sextant_channel::ObstacleField;
use sextant_kernel::SettingError;
use sextant_sim::Controller;

use crate::planned_path::{PathPart, drive_planned};
use crate::s_path::SPathConfig;
use crate::{ControllerConfig, Surroundings};

/// The way that a robot is expected to drive in a survey.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ExpectedWay {
    /// Its length (m).
    pub length_m: f64,
    /// Its stops.
    pub stops: usize,
}

impl ControllerConfig {
    /// The way that the robot is expected to drive: that of a planned path without the stops inside obstacles and without
    /// ways round them. An automated S path is expected to be an S path over its area. Zero for other paths, and for those
    /// that have no area.
    ///
    /// # Errors
    /// If a value is invalid. The key is relative to the controller's table.
    pub fn expected_way(&self, surroundings: &Surroundings<'_>) -> Result<ExpectedWay, SettingError> {
        let nothing = ObstacleField::default();
        let open = Surroundings { obstacles: &nothing, ..*surroundings };
        let planned = match self {
            Self::AutomatedS(config) => {
                let Some(area) = &config.area else { return Ok(ExpectedWay::default()) };
                let lanes = SPathConfig::new(area.clone(), config.lane_spacing_m);
                // What is wrong with it is said where it is built, with its own keys.
                match Self::SPath(SPathConfig { stop_spacing_m: config.step_m, ..lanes }).build(&open) {
                    Ok(lanes) => lanes,
                    Err(_) => return Ok(ExpectedWay::default()),
                }
            }
            Self::RandomWalk(_) => return Ok(ExpectedWay::default()),
            Self::SPath(_) | Self::Spiral(_) | Self::Hilbert(_) | Self::Waypoints(_) => self.build(&open)?,
        };
        Ok(driven(planned, &open, surroundings.obstacles))
    }
}

/// The way of a planned path without obstacles; stops inside `obstacles` do not count.
fn driven(controller: Box<dyn Controller>, open: &Surroundings<'_>, obstacles: &ObstacleField) -> ExpectedWay {
    let mut way = ExpectedWay::default();
    drive_planned(controller, open, |part| match part {
        PathPart::Drive { from, to } => way.length_m += from.distance_m(to),
        PathPart::Stop(place) => way.stops += usize::from(obstacles.containing(place).is_none()),
    });
    way
}
