//! A random walk.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::{Seed, SettingError};
use sextant_sim::layout::{Region, RegionConfig};
use sextant_sim::{CommandOutcome, Controller, Ending, HeardNode, RobotCommand, Situation};

use crate::area::Area;
use crate::height_range::within_steps;
use crate::purpose;
use crate::surroundings::Surroundings;

/// Maximum number of directions drawn for one step.
const DRAWS: u64 = 64;
/// Reflections of a step, in the order in which they are tried: none, at each wall of a box, then straight back.
const REFLECTIONS: [[f64; 3]; 5] =
    [[1.0, 1.0, 1.0], [-1.0, 1.0, 1.0], [1.0, -1.0, 1.0], [1.0, 1.0, -1.0], [-1.0, -1.0, -1.0]];

/// A random walk, as written in a scenario (thesis, section 3.4).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RandomWalkConfig {
    /// Length of a step (m). The robot listens after each step.
    #[serde(default = "default_step_m")]
    pub step_m: f64,
    /// The walk stays in this region and is reflected at its border. The robot must start in the region. In a region
    /// of space the robot also moves up and down. In a region of the plane, or without a region, it keeps the height
    /// of its start.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub region: Option<RegionConfig>,
    /// Number of steps in one direction before a new direction is drawn. 1 gives a plain random walk.
    #[serde(default = "default_steps_per_turn")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub steps_per_turn: u32,
    /// Packets wanted from each node (N_p of the thesis). The walk ends when each node has been heard this often.
    #[serde(default = "default_packets_per_node")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub packets_per_node: u32,
    /// Maximum number of steps.
    #[serde(default = "default_max_steps")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub max_steps: u32,
}

fn default_step_m() -> f64 {
    1.0
}

fn default_steps_per_turn() -> u32 {
    1
}

fn default_packets_per_node() -> u32 {
    5
}

fn default_max_steps() -> u32 {
    5000
}

impl Default for RandomWalkConfig {
    fn default() -> Self {
        Self {
            step_m: default_step_m(),
            region: None,
            steps_per_turn: default_steps_per_turn(),
            packets_per_node: default_packets_per_node(),
            max_steps: default_max_steps(),
        }
    }
}

impl RandomWalkConfig {
    /// The lowest and the highest height of the robot (m); `None` if the region is invalid.
    pub(crate) fn height_range_m(&self, start: Position) -> Option<[f64; 2]> {
        let region = self.region.as_ref().map(Region::try_from).transpose().ok()?;
        Some(match region.filter(|region| !region.is_planar()) {
            Some(region) => {
                let bounds = region.bounds();
                within_steps(start, [bounds.min.z_m, bounds.max.z_m], self.max_steps, self.step_m)
            }
            None => [start.z_m; 2],
        })
    }
}

/// Drives a step and listens, again and again, until each node has been heard as often as wanted. Directions are
/// uniform and independent. The robot has no map: its range sensors tell whether a direction is free of obstacles.
///
/// A step that would meet an obstacle or leave the region is reflected; if no reflection is free either, another
/// direction is drawn.
#[derive(Clone, Debug)]
pub struct RandomWalk {
    step_m: f64,
    area: Option<Area>,
    steps_per_turn: u32,
    packets_per_node: u32,
    max_steps: u32,
    seed: Seed,
    robot: u64,
    steps: u32,
    /// The last step.
    last_step: Option<Position>,
    /// Packets heard of each node.
    packets: Vec<u32>,
}

impl RandomWalk {
    /// The walk that `config` describes.
    ///
    /// # Errors
    /// If a value is invalid, or the robot starts outside the region.
    pub fn plan(config: &RandomWalkConfig, surroundings: &Surroundings<'_>) -> Result<Self, SettingError> {
        for (key, value) in [
            ("steps_per_turn", config.steps_per_turn),
            ("packets_per_node", config.packets_per_node),
            ("max_steps", config.max_steps),
        ] {
            if value == 0 {
                return Err(SettingError::new(key, 0, "a whole number above 0"));
            }
        }
        let area = |region| Area::round_start("region", region, surroundings);
        Ok(Self {
            step_m: SettingError::positive("step_m", config.step_m)?,
            area: config.region.as_ref().map(area).transpose()?,
            steps_per_turn: config.steps_per_turn,
            packets_per_node: config.packets_per_node,
            max_steps: config.max_steps,
            seed: surroundings.seed,
            robot: surroundings.robot,
            steps: 0,
            last_step: None,
            packets: Vec::new(),
        })
    }

    fn count(&mut self, heard: &[HeardNode], nodes: usize) {
        self.packets.resize(nodes.max(self.packets.len()), 0);
        for heard in heard {
            if let Some(packets) = self.packets.get_mut(heard.node.index()) {
                *packets = packets.saturating_add(heard.packets);
            }
        }
    }

    fn has_heard_all(&self) -> bool {
        !self.packets.is_empty() && self.packets.iter().all(|&packets| packets >= self.packets_per_node)
    }

    /// The next step; `None` if none of the directions drawn is free.
    fn next(&self, situation: &Situation<'_>) -> Option<Position> {
        let here = situation.position;
        let is_free = |&step: &Position| {
            self.area.as_ref().is_none_or(|area| area.contains(here + step))
                && situation.clearance_m(step, self.step_m) >= self.step_m
        };
        let reflected =
            |step: Position| REFLECTIONS.map(|[x, y, z]| Position::new(x * step.x_m, y * step.y_m, z * step.z_m));
        let straight_on = self.last_step.filter(|_| !self.steps.is_multiple_of(self.steps_per_turn));
        straight_on.into_iter().chain((0..DRAWS).map(|draw| self.draw(draw))).flat_map(reflected).find(is_free)
    }

    /// A step in a random direction.
    fn draw(&self, draw: u64) -> Position {
        let uniform = |axis: u64| {
            let address = [self.robot, u64::from(self.steps), draw << 1 | axis];
            self.seed.uniform(purpose::ROBOT, address)
        };
        let azimuth_rad = TAU * uniform(0);
        let is_solid = self.area.as_ref().is_some_and(|area| !area.is_planar());
        // The heights of uniform points on a sphere are uniform (Archimedes' hat-box theorem).
        let up = if is_solid { 2.0 * uniform(1) - 1.0 } else { 0.0 };
        let level = (1.0 - up * up).sqrt();
        Position::new(level * libm::cos(azimuth_rad), level * libm::sin(azimuth_rad), up) * self.step_m
    }
}

impl Controller for RandomWalk {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        let CommandOutcome::Listened(heard) = situation.outcome else { return RobotCommand::Listen };
        self.count(heard, situation.node_count);
        if self.has_heard_all() {
            return RobotCommand::Finish(Ending::Complete);
        }
        if self.steps >= self.max_steps {
            return RobotCommand::Finish(Ending::StepsExhausted);
        }
        let Some(step) = self.next(situation) else { return RobotCommand::Finish(Ending::Stuck) };
        self.steps += 1;
        self.last_step = Some(step);
        RobotCommand::Drive(situation.position + step)
    }
}
