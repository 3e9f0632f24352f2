//! Targets: bodies without a radio that move through the world, and that sensors of nodes detect.
//!
//! The way of a target is an exact sequence of straight legs. Each leg is worked out when the one before it ends, from
//! random numbers at addresses of this target alone, so that other targets do not change it.

mod leg;
mod walk;
mod waypoints;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Seed, SettingError, SimTime};

use crate::station::check_name;

pub use leg::Leg;
pub use walk::{RandomWalkConfig, StraightConfig, TurnConfig};
pub use waypoints::{AtEnd, WaypointsConfig};

/// A target, as written in a scenario: a body without a radio.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TargetConfig {
    /// Name, also used in its topic of the recording; no robot and no other target has it.
    pub name: String,
    /// How it moves.
    pub motion: TargetMotionConfig,
}

/// How a target moves, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TargetMotionConfig {
    /// Over listed places. A target with one place stands there.
    Waypoints(WaypointsConfig),
    /// A random walk in a region.
    RandomWalk(RandomWalkConfig),
}

/// A target.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    name: String,
    number: u64,
    motion: TargetMotion,
}

#[derive(Clone, Debug, PartialEq)]
enum TargetMotion {
    Waypoints(waypoints::Waypoints),
    RandomWalk(walk::RandomWalk),
}

/// A target on its way.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    place: Position,
    time: SimTime,
    motion: CourseMotion,
}

#[derive(Clone, Debug, PartialEq)]
enum CourseMotion {
    Waypoints { way: waypoints::Waypoints, legs: usize },
    RandomWalk(walk::Walker),
}

impl TargetConfig {
    /// The target number `number` among `obstacles`.
    ///
    /// # Errors
    /// If its name has characters beyond letters, digits, `-`, `_` and `.`, its speed is not positive, or its start or
    /// way is inside an obstacle or outside its region.
    pub fn build(&self, number: u64, obstacles: &ObstacleField) -> Result<Target, SettingError> {
        check_name(&self.name)?;
        let motion = match &self.motion {
            TargetMotionConfig::Waypoints(config) => config
                .build(obstacles)
                .map(TargetMotion::Waypoints)
                .map_err(|error| error.within("motion.waypoints"))?,
            TargetMotionConfig::RandomWalk(config) => config
                .build(obstacles)
                .map(TargetMotion::RandomWalk)
                .map_err(|error| error.within("motion.random_walk"))?,
        };
        Ok(Target { name: self.name.clone(), number, motion })
    }
}

impl Target {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Where it starts (m).
    #[must_use]
    pub fn start(&self) -> Position {
        match &self.motion {
            TargetMotion::Waypoints(way) => way.start(),
            TargetMotion::RandomWalk(walk) => walk.start(),
        }
    }

    /// Its way from the start of time.
    #[must_use]
    pub fn course(&self, seed: Seed) -> Course {
        let motion = match self.motion.clone() {
            TargetMotion::Waypoints(way) => CourseMotion::Waypoints { way, legs: 0 },
            TargetMotion::RandomWalk(walk) => CourseMotion::RandomWalk(walk.begin(self.number, seed)),
        };
        Course { place: self.start(), time: SimTime::ZERO, motion }
    }
}

impl Course {
    /// The next leg of the way among `obstacles`, which begins where and when the one before it ended; `None` if the
    /// target stays there for ever.
    pub fn next_leg(&mut self, obstacles: &ObstacleField) -> Option<Leg> {
        let leg = match &mut self.motion {
            CourseMotion::Waypoints { way, legs } => {
                let leg = way.leg(*legs, self.time)?;
                *legs += 1;
                leg
            }
            CourseMotion::RandomWalk(walker) => walker.leg(self.place, self.time, obstacles)?,
        };
        (self.place, self.time) = (leg.to, leg.end);
        Some(leg)
    }
}

/// A speed (m/s), if it is a reasonable one.
fn speed(key: &str, speed_m_per_s: f64) -> Result<f64, SettingError> {
    SettingError::in_range(key, speed_m_per_s, 1e-3, 1e3)
}
