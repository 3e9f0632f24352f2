//! Targets: bodies without a radio that move through the world, and that sensors of nodes detect.
//!
//! The way of a target is an exact sequence of straight legs. Each leg is worked out when the one before it ends, or all
//! of them when the world is built, from random numbers at addresses of this target alone, so that other targets do not
//! change it.

mod evade;
mod gait;
mod leg;
mod walk;
mod wander;
mod waypoints;

use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position, Screen, ScreenConfig};
use sextant_kernel::{Seed, SettingError, SimTime};

use super::layout::{PlacedNode, Region};
use crate::station::check_name;

pub use evade::EvadeConfig;
pub use gait::{StraightConfig, TurnConfig};
pub use leg::Leg;
pub use walk::RandomWalkConfig;
pub use wander::WanderConfig;
pub use waypoints::{AtEnd, WaypointsConfig};
pub(crate) use waypoints::{LEAST_LEG_M, Waypoints};

/// Farthest that a place of a target is from the nearest node (m).
const FARTHEST_M: f64 = 1e3;

/// A target, as written in a scenario: a body without a radio.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TargetConfig {
    /// Name, also used in its topic of the recording; no robot and no other target has it.
    pub name: String,
    /// How it moves.
    pub motion: TargetMotionConfig,
    /// What it takes of links that pass it: it hides them like an upright screen. Nothing if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub screen: Option<ScreenConfig>,
}

/// How a target moves, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TargetMotionConfig {
    /// Over listed places. A target with one place stands there.
    Waypoints(WaypointsConfig),
    /// A random walk in a region.
    RandomWalk(RandomWalkConfig),
    /// A visit: a random walk in a region from an entrance to an exit, where the target is gone from the world.
    Wander(WanderConfig),
    /// A random walk in a region, and flight from robots in sight.
    Evade(EvadeConfig),
}

/// A target.
#[derive(Clone, Debug, PartialEq)]
pub struct Target {
    name: String,
    number: u64,
    motion: TargetMotion,
    screen: Option<Screen>,
}

#[derive(Clone, Debug, PartialEq)]
enum TargetMotion {
    Waypoints(waypoints::Waypoints),
    RandomWalk(walk::RandomWalk),
    /// All legs, after which the target is gone.
    Wander(Arc<[Leg]>),
    Evade(evade::Evasion),
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
    Wander { legs: Arc<[Leg]>, walked: usize },
    Evade(evade::Evader),
}

impl TargetConfig {
    /// The target number `number` among `obstacles`. A way that is planned in advance follows from `seed`.
    ///
    /// # Errors
    /// If its name has characters beyond letters, digits, `-`, `_` and `.`, its speed is not positive, its start or
    /// way is inside an obstacle or outside its region, or there is no such way.
    pub fn build(&self, number: u64, obstacles: &ObstacleField, seed: Seed) -> Result<Target, SettingError> {
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
            TargetMotionConfig::Wander(config) => config
                .build(number, obstacles, seed)
                .map(TargetMotion::Wander)
                .map_err(|error| error.within("motion.wander"))?,
            TargetMotionConfig::Evade(config) => {
                config.build(obstacles).map(TargetMotion::Evade).map_err(|error| error.within("motion.evade"))?
            }
        };
        let screen = self.screen.map(Screen::try_from).transpose().map_err(|error| error.within("screen"))?;
        Ok(Target { name: self.name.clone(), number, motion, screen })
    }

    /// Refuses places that are so far from all `nodes` that they must be a mistake.
    pub(super) fn check_places(&self, nodes: &[PlacedNode]) -> Result<(), SettingError> {
        let is_near = |place: Position| nodes.iter().any(|node| node.position.distance_m(place) <= FARTHEST_M);
        for (key, place) in self.motion.places() {
            if !nodes.is_empty() && !is_near(place) {
                let [x, y, z] = place.into();
                let allowed = format!("a place within {FARTHEST_M} m of a node");
                return Err(SettingError::new(format!("motion.{key}"), format!("[{x}, {y}, {z}]"), allowed));
            }
        }
        Ok(())
    }
}

impl TargetMotionConfig {
    /// The places that it names, and the key of each.
    fn places(&self) -> Vec<(String, Position)> {
        match self {
            Self::Waypoints(config) => {
                let place = |(i, &place)| (format!("waypoints.places_m[{i}]"), place);
                config.places_m.iter().enumerate().map(place).collect()
            }
            Self::RandomWalk(config) => vec![("random_walk.start_m".to_owned(), config.start_m)],
            Self::Wander(config) => {
                vec![("wander.from_m".to_owned(), config.from_m), ("wander.to_m".to_owned(), config.to_m)]
            }
            Self::Evade(config) => vec![("evade.start_m".to_owned(), config.start_m)],
        }
    }
}

impl Target {
    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What it takes of links that pass it, if it does.
    #[must_use]
    pub fn screen(&self) -> Option<Screen> {
        self.screen
    }

    /// Where it starts (m).
    #[must_use]
    pub fn start(&self) -> Position {
        match &self.motion {
            TargetMotion::Waypoints(way) => way.start(),
            TargetMotion::RandomWalk(walk) => walk.start(),
            TargetMotion::Wander(legs) => legs[0].from,
            TargetMotion::Evade(evasion) => evasion.start(),
        }
    }

    /// Its way from the start of time.
    #[must_use]
    pub fn course(&self, seed: Seed) -> Course {
        let motion = match self.motion.clone() {
            TargetMotion::Waypoints(way) => CourseMotion::Waypoints { way, legs: 0 },
            TargetMotion::RandomWalk(walk) => CourseMotion::RandomWalk(walk.begin(self.number, seed)),
            TargetMotion::Wander(legs) => CourseMotion::Wander { legs, walked: 0 },
            TargetMotion::Evade(evasion) => CourseMotion::Evade(evasion.begin(self.number, seed)),
        };
        Course { place: self.start(), time: SimTime::ZERO, motion }
    }
}

impl Course {
    /// The next leg of the way among `obstacles`, far from all robots: see [`Course::next_leg_among`].
    pub fn next_leg(&mut self, obstacles: &ObstacleField) -> Option<Leg> {
        self.next_leg_among(obstacles, &[])
    }

    /// The next leg of the way among `obstacles` and robots at these places, which begins where and when the one before
    /// it ended; `None` if the target stays there for ever, or [leaves](Course::leaves).
    pub fn next_leg_among(&mut self, obstacles: &ObstacleField, robots: &[Position]) -> Option<Leg> {
        let leg = match &mut self.motion {
            CourseMotion::Waypoints { way, legs } => {
                let leg = way.leg(*legs, self.time)?;
                *legs += 1;
                leg
            }
            CourseMotion::RandomWalk(walker) => walker.leg(self.place, self.time, obstacles)?,
            CourseMotion::Wander { legs, walked } => {
                let leg = *legs.get(*walked)?;
                *walked += 1;
                leg
            }
            CourseMotion::Evade(evader) => evader.leg(self.place, self.time, obstacles, robots),
        };
        (self.place, self.time) = (leg.to, leg.end);
        Some(leg)
    }

    /// Whether the target is gone from the world after its last leg.
    #[must_use]
    pub fn leaves(&self) -> bool {
        match &self.motion {
            CourseMotion::Waypoints { way, .. } => way.leaves(),
            CourseMotion::Wander { .. } => true,
            CourseMotion::RandomWalk(_) | CourseMotion::Evade(_) => false,
        }
    }

    /// Whether it depends on where the robots are.
    pub(crate) fn sees_robots(&self) -> bool {
        matches!(self.motion, CourseMotion::Evade(_))
    }
}

/// A speed (m/s), if it is a reasonable one.
fn speed(key: &str, speed_m_per_s: f64) -> Result<f64, SettingError> {
    SettingError::in_range(key, speed_m_per_s, 1e-3, 1e3)
}

/// The place of a start, if it is in `region` and outside all `obstacles`.
fn inside(key: &str, start: Position, region: &Region, obstacles: &ObstacleField) -> Result<Position, SettingError> {
    if let Some((found, allowed)) = obstacles.fault(start) {
        return Err(SettingError::new(key, found, allowed));
    }
    let [x, y, z] = start.into();
    if !region.contains(start) {
        return Err(SettingError::new(key, format!("[{x}, {y}, {z}]"), "a place in the region"));
    }
    if region.is_on_side(start) {
        let found = format!("[{x}, {y}, {z}], on a side of the polygon");
        return Err(SettingError::new(key, found, "a place in the region, and not on its border"));
    }
    Ok(start)
}
