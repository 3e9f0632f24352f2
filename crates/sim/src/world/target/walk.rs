//! Random walks: straight pieces of random length with random turns between them, inside a region.

use std::f64::consts::TAU;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Seed, SettingError, SimTime};

use super::super::layout::{Region, RegionConfig};
use super::leg::Leg;
use super::speed;
use crate::purpose;

/// Distance that a walk keeps from the border of its region (m), so that rounding does not carry it outside.
const MARGIN_M: f64 = 1e-6;
/// Distance that a walk keeps from obstacles (m).
const CLEARANCE_M: f64 = 1e-3;
/// A shorter leg is not walked (m).
const LEAST_LEG_M: f64 = 1e-6;
/// Directions tried in one place before the target stays there for ever.
const ATTEMPTS: u32 = 1000;

/// A random walk, as written in a scenario. The target goes straight, turns, goes straight, and so on. At the border of
/// its region it is reflected like light by a mirror; in front of an obstacle it takes any direction that leads away.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RandomWalkConfig {
    /// Where it starts (m).
    pub start_m: Position,
    /// Speed (m/s).
    pub speed_m_per_s: f64,
    /// How far it goes between two turns.
    pub straight: StraightConfig,
    /// How much it turns; any direction is as likely as any other if absent.
    #[serde(default)]
    pub turn: TurnConfig,
    /// The region that it does not leave. In a flat region it stays at one height.
    pub region: RegionConfig,
}

/// How far a target goes between two turns, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum StraightConfig {
    /// Random lengths, exponentially distributed with this mean (m).
    MeanM(f64),
    /// A turn once in this time (s).
    EveryS(f64),
}

/// How much a target turns, as written in a scenario. In a flat region it turns left or right, in space to any side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TurnConfig {
    /// Uniformly distributed between minus and plus this angle: above 0 to 180 degrees.
    UniformDeg(f64),
    /// Normally distributed with this standard deviation: above 0 to 180 degrees.
    NormalDeg(f64),
}

impl Default for TurnConfig {
    fn default() -> Self {
        Self::UniformDeg(180.0)
    }
}

/// A random walk.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct RandomWalk {
    start: Position,
    speed_m_per_s: f64,
    straight: Straight,
    turn: Turn,
    region: Region,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Straight {
    Exponential { mean_m: f64 },
    Fixed { length_m: f64 },
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Turn {
    Uniform { most_rad: f64 },
    Normal { sigma_rad: f64 },
}

impl RandomWalkConfig {
    /// The walk among `obstacles`.
    pub(super) fn build(&self, obstacles: &ObstacleField) -> Result<RandomWalk, SettingError> {
        let region = Region::try_from(&self.region).map_err(|error| error.within("region"))?;
        let start = self.start_m;
        if let Some((found, allowed)) = obstacles.fault(start) {
            return Err(SettingError::new("start_m", found, allowed));
        }
        if !region.contains(start) {
            let [x, y, z] = start.into();
            return Err(SettingError::new("start_m", format!("[{x}, {y}, {z}]"), "a place in the region"));
        }
        let speed_m_per_s = speed("speed_m_per_s", self.speed_m_per_s)?;
        let angle = |key, degrees: f64| {
            let degrees = SettingError::in_range(key, degrees, 1e-3, 180.0)?;
            Ok::<_, SettingError>(degrees.to_radians())
        };
        Ok(RandomWalk {
            start,
            speed_m_per_s,
            straight: match self.straight {
                StraightConfig::MeanM(mean_m) => {
                    Straight::Exponential { mean_m: SettingError::in_range("straight.mean_m", mean_m, 1e-3, 1e6)? }
                }
                StraightConfig::EveryS(every_s) => {
                    let every_s = SettingError::in_range("straight.every_s", every_s, 1e-3, 1e6)?;
                    Straight::Fixed { length_m: every_s * speed_m_per_s }
                }
            },
            turn: match self.turn {
                TurnConfig::UniformDeg(most) => Turn::Uniform { most_rad: angle("turn.uniform_deg", most)? },
                TurnConfig::NormalDeg(sigma) => Turn::Normal { sigma_rad: angle("turn.normal_deg", sigma)? },
            },
            region,
        })
    }
}

impl RandomWalk {
    pub(super) fn start(&self) -> Position {
        self.start
    }

    /// The walk of target number `number`, from its start.
    pub(super) fn begin(self, number: u64, seed: Seed) -> Walker {
        let mut walker =
            Walker { walk: self, seed, number, draws: 0, direction: Position::new(1.0, 0.0, 0.0), left_m: 0.0 };
        walker.direction = walker.any_direction();
        walker.left_m = walker.straight_m();
        walker
    }
}

/// A target on its random walk.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Walker {
    walk: RandomWalk,
    seed: Seed,
    number: u64,
    /// Random numbers drawn so far.
    draws: u64,
    /// Where it goes: a vector of length one.
    direction: Position,
    /// What is left to go before the next turn (m).
    left_m: f64,
}

impl Walker {
    /// The leg that begins at `from` at the time `start`; `None` if there is no way out of that place.
    pub(super) fn leg(&mut self, from: Position, start: SimTime, obstacles: &ObstacleField) -> Option<Leg> {
        for _ in 0..ATTEMPTS {
            let border = self.walk.region.way_out(from, self.direction);
            let inside_m = (border.distance_m - MARGIN_M).clamp(0.0, self.left_m);
            let length_m = obstacles.clearance_m(from, self.direction, inside_m, CLEARANCE_M);
            let to = from + self.direction * length_m;
            let leaves = !self.walk.region.contains(to);
            if leaves || length_m < inside_m {
                self.direction = self.any_direction();
            } else if inside_m < self.left_m {
                self.direction = self.direction - border.normal * (2.0 * self.direction.dot(border.normal));
            }
            if leaves || length_m < LEAST_LEG_M && self.left_m >= LEAST_LEG_M {
                continue;
            }
            self.left_m -= length_m;
            if self.left_m < LEAST_LEG_M {
                self.turn();
            }
            if length_m >= LEAST_LEG_M {
                return Some(Leg::new(from, to, start, self.walk.speed_m_per_s));
            }
        }
        None
    }

    /// Turns, and begins the next straight piece.
    fn turn(&mut self) {
        let angle = match self.walk.turn {
            Turn::Uniform { most_rad } => most_rad * (2.0 * self.uniform() - 1.0),
            Turn::Normal { sigma_rad } => {
                self.draws += 1;
                sigma_rad * self.seed.normal(purpose::TARGETS, [self.number, self.draws, 0])
            }
        };
        let aside = self.aside();
        let turned = self.direction * libm::cos(angle) + aside * libm::sin(angle);
        self.direction = turned * (1.0 / turned.length_m());
        self.left_m = self.straight_m();
    }

    /// A direction at a right angle to that of the target, of length one: to the left in a flat region, any in space.
    fn aside(&mut self) -> Position {
        let ahead = self.direction;
        let left = Position::new(-ahead.y_m, ahead.x_m, 0.0);
        if self.walk.region.is_planar() {
            return left;
        }
        // Straight up, there is no left.
        let left = if left.length_m() < 1e-6 { Position::new(0.0, 1.0, 0.0) } else { left };
        let left = left * (1.0 / left.length_m());
        let above = ahead.cross(left);
        let around = TAU * self.uniform();
        left * libm::cos(around) + above * libm::sin(around)
    }

    /// A direction, each as likely as any other.
    fn any_direction(&mut self) -> Position {
        let azimuth = TAU * self.uniform();
        // The height of a random point on the sphere is uniform (Archimedes).
        let up: f64 = if self.walk.region.is_planar() { 0.0 } else { 2.0 * self.uniform() - 1.0 };
        let across = (1.0 - up * up).sqrt();
        Position::new(across * libm::cos(azimuth), across * libm::sin(azimuth), up)
    }

    /// Length of the next straight piece (m).
    fn straight_m(&mut self) -> f64 {
        match self.walk.straight {
            Straight::Exponential { mean_m } => -mean_m * libm::log(self.uniform()),
            Straight::Fixed { length_m } => length_m,
        }
    }

    fn uniform(&mut self) -> f64 {
        self.draws += 1;
        self.seed.uniform(purpose::TARGETS, [self.number, self.draws, 0])
    }
}
