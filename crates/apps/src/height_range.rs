//! The heights at which a robot may stop that decides on the way.

use sextant_channel::Position;

use crate::{ControllerConfig, Surroundings};

/// No robot is expected to climb farther than this in a survey (m).
const LONGEST_CLIMB_M: f64 = 1e5;

impl ControllerConfig {
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
}

/// The heights from `low_m` to `high_m` that are within so many steps of `start`.
pub(crate) fn within_steps(start: Position, [low_m, high_m]: [f64; 2], steps: u32, step_m: f64) -> [f64; 2] {
    let most_m = (f64::from(steps) * step_m).min(LONGEST_CLIMB_M);
    [low_m.max(start.z_m - most_m).min(start.z_m), high_m.min(start.z_m + most_m).max(start.z_m)]
}

#[cfg(test)]
mod tests {
    use sextant_channel::ObstacleField;
    use sextant_kernel::Seed;
    use sextant_sim::layout::RegionConfig;

    use super::*;
    use crate::{AutomatedSConfig, LayersConfig, RandomWalkConfig, WaypointsConfig};

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
