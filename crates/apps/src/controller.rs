//! The choice of a controller.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;
use sextant_sim::Controller;
use sextant_sim::layout::RegionConfig;

use crate::automated_s::{AutomatedS, AutomatedSConfig};
use crate::hilbert::{Hilbert, HilbertConfig};
use crate::random_walk::{RandomWalk, RandomWalkConfig};
use crate::s_path::{SPath, SPathConfig};
use crate::spiral::{Spiral, SpiralConfig};
use crate::surroundings::Surroundings;
use crate::waypoints::{Waypoints, WaypointsConfig};

/// What drives a robot, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum ControllerConfig {
    /// An S path, in the plane or in layers. The robot needs no map: it turns where it hears nothing or meets an
    /// obstacle. Ends when each node has been heard as often as wanted.
    AutomatedS(AutomatedSConfig),
    /// Steps in random directions. The robot needs no map. Ends when each node has been heard as often as wanted.
    RandomWalk(RandomWalkConfig),
    /// A fixed S path over a region. The way round obstacles is planned. Ends at the end of the path.
    SPath(SPathConfig),
    /// An Archimedean spiral over a region. The way round obstacles is planned. Ends at the end of the path.
    Spiral(SpiralConfig),
    /// A Hilbert curve over a region. The way round obstacles is planned. Ends at the end of the path.
    Hilbert(HilbertConfig),
    /// A list of places. The way round obstacles is planned. Ends at the last place.
    Waypoints(WaypointsConfig),
}

impl ControllerConfig {
    /// The controller of a robot in `surroundings`.
    ///
    /// # Errors
    /// If a value is invalid, or a place cannot be reached. The key is relative to the controller's table.
    pub fn build(&self, surroundings: &Surroundings<'_>) -> Result<Box<dyn Controller>, SettingError> {
        fn boxed<C: Controller + 'static>(
            key: &str,
            controller: Result<C, SettingError>,
        ) -> Result<Box<dyn Controller>, SettingError> {
            match controller {
                Ok(controller) => Ok(Box::new(controller)),
                Err(error) => Err(error.within(key)),
            }
        }
        match self {
            Self::AutomatedS(config) => boxed("automated_s", AutomatedS::plan(config, surroundings)),
            Self::RandomWalk(config) => boxed("random_walk", RandomWalk::plan(config, surroundings)),
            Self::SPath(config) => boxed("s_path", SPath::plan(config, surroundings)),
            Self::Spiral(config) => boxed("spiral", Spiral::plan(config, surroundings)),
            Self::Hilbert(config) => boxed("hilbert", Hilbert::plan(config, surroundings)),
            Self::Waypoints(config) => boxed("waypoints", Waypoints::plan(config, surroundings)),
        }
    }

    /// Whether the way is planned before the start and does not depend on what is heard.
    #[must_use]
    pub fn is_planned(&self) -> bool {
        match self {
            Self::AutomatedS(_) | Self::RandomWalk(_) => false,
            Self::SPath(_) | Self::Spiral(_) | Self::Hilbert(_) | Self::Waypoints(_) => true,
        }
    }

    /// The region that the robots of a team divide among them, with its key in the controller's table: `None` for a
    /// controller that no team can have, and a region of `None` if it is not written.
    #[must_use]
    pub fn region(&self) -> Option<(&'static str, Option<&RegionConfig>)> {
        match self {
            Self::AutomatedS(config) => Some(("automated_s.area", config.area.as_ref())),
            Self::SPath(config) => Some(("s_path.region", Some(&config.region))),
            Self::Spiral(config) => Some(("spiral.region", Some(&config.region))),
            Self::Hilbert(config) => Some(("hilbert.region", Some(&config.region))),
            Self::RandomWalk(_) | Self::Waypoints(_) => None,
        }
    }

    /// The same controller for another region, if it has one that a team can divide.
    #[must_use]
    pub fn over(mut self, region: RegionConfig) -> Self {
        match &mut self {
            Self::AutomatedS(config) => config.area = Some(region),
            Self::SPath(config) => config.region = region,
            Self::Spiral(config) => config.region = region,
            Self::Hilbert(config) => config.region = region,
            Self::RandomWalk(_) | Self::Waypoints(_) => {}
        }
        self
    }

    /// How many packets of each node the robot must hear; 1 for a path that is planned before the start.
    #[must_use]
    pub fn packets_per_node(&self) -> u32 {
        match self {
            Self::AutomatedS(config) => config.packets_per_node,
            Self::RandomWalk(config) => config.packets_per_node,
            Self::SPath(_) | Self::Spiral(_) | Self::Hilbert(_) | Self::Waypoints(_) => 1,
        }
    }
}
