//! The choice of a controller.

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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

    /// The lowest and the highest height at which a robot may stop that decides on the way (m). Both are that of its start if
    /// it stays there. `None` for a path that is planned before the start, and for settings that cannot be built.
    #[must_use]
    pub fn height_range_m(&self, surroundings: &Surroundings<'_>) -> Option<[f64; 2]> {
        let start = surroundings.start;
        match self {
            Self::AutomatedS(config) => config.height_range_m(start),
            Self::RandomWalk(config) => config.height_range_m(start),
            Self::SPath(_) | Self::Spiral(_) | Self::Hilbert(_) | Self::Waypoints(_) => None,
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

#[cfg(test)]
mod tests {
    use sextant_channel::{ObstacleField, Position};
    use sextant_kernel::Seed;

    use super::*;
    use crate::LayersConfig;

    #[test]
    fn heights_are_bounded_by_the_settings_and_by_the_steps() {
        let (obstacles, start) = (ObstacleField::default(), Position::new(1.0, 1.0, 2.0));
        let around = Surroundings { obstacles: &obstacles, start, radius_m: 0.2, seed: Seed(1), robot: 0 };
        let range_m = |config: ControllerConfig| config.height_range_m(&around).map(|range| range.map(f64::round));
        let layers = |layers| {
            let config = AutomatedSConfig { step_m: 1.0, max_steps: 20, layers, ..AutomatedSConfig::default() };
            range_m(ControllerConfig::AutomatedS(config))
        };
        let between = |floor_m, ceiling_m| Some(LayersConfig { spacing_m: 3.0, floor_m, ceiling_m });
        assert_eq!(layers(None), Some([2.0, 2.0]));
        assert_eq!(layers(between(None, None)), Some([-18.0, 22.0]));
        assert_eq!(layers(between(Some(0.0), Some(9.0))), Some([0.0, 9.0]));
        // No layer is left above or below the start.
        assert_eq!(layers(between(Some(1.5), Some(2.5))), Some([2.0, 2.0]));
        let walk = |region| {
            let config = RandomWalkConfig { max_steps: 4, region, ..RandomWalkConfig::default() };
            range_m(ControllerConfig::RandomWalk(config))
        };
        let (min_m, max_m) = (Position::ORIGIN, Position::new(9.0, 9.0, 30.0));
        assert_eq!(walk(None), Some([2.0, 2.0]));
        assert_eq!(walk(Some(RegionConfig::Box { min_m, max_m })), Some([0.0, 6.0]));
        assert_eq!(range_m(ControllerConfig::Waypoints(WaypointsConfig { places_m: vec![start] })), None);
    }
}
