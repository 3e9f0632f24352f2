//! How a target walks at random: straight pieces of random length with random turns between them, inside a region.

use std::f64::consts::TAU;

use serde::{Deserialize, Serialize};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{Seed, SettingError};

use super::super::layout::Region;
use crate::purpose;

/// Where a target can go: within a region, around obstacles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ground<'a> {
    pub(super) region: &'a Region,
    pub(super) obstacles: &'a ObstacleField,
}

/// Distance that a walk keeps from the border of its region (m), so that rounding does not carry it outside.
pub(super) const MARGIN_M: f64 = 1e-6;
/// Distance that a walk keeps from obstacles (m).
pub(super) const CLEARANCE_M: f64 = 1e-3;
/// A shorter leg is not walked (m).
pub(super) const LEAST_LEG_M: f64 = 1e-6;
/// Directions tried in one place before there is no way out of it.
const ATTEMPTS: u32 = 1000;

/// How far a target goes between two turns, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum StraightConfig {
    /// Random lengths, exponentially distributed with this mean (m).
    MeanM(f64),
    /// A turn once in this time (s).
    EveryS(f64),
}

/// How much a target turns, as written in a scenario. In a flat region it turns left or right, in space to any side.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// The laws of straight pieces and turns.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gait {
    straight: Straight,
    turn: Turn,
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

impl Gait {
    /// The laws of a target with this speed (m/s).
    pub(super) fn new(straight: StraightConfig, turn: TurnConfig, speed_m_per_s: f64) -> Result<Self, SettingError> {
        let angle = |key, degrees: f64| {
            let degrees = SettingError::in_range(key, degrees, 1e-3, 180.0)?;
            Ok::<_, SettingError>(degrees.to_radians())
        };
        Ok(Self {
            straight: match straight {
                StraightConfig::MeanM(mean_m) => {
                    Straight::Exponential { mean_m: SettingError::in_range("straight.mean_m", mean_m, 1e-3, 1e6)? }
                }
                StraightConfig::EveryS(every_s) => {
                    let every_s = SettingError::in_range("straight.every_s", every_s, 1e-3, 1e6)?;
                    Straight::Fixed { length_m: every_s * speed_m_per_s }
                }
            },
            turn: match turn {
                TurnConfig::UniformDeg(most) => Turn::Uniform { most_rad: angle("turn.uniform_deg", most)? },
                TurnConfig::NormalDeg(sigma) => Turn::Normal { sigma_rad: angle("turn.normal_deg", sigma)? },
            },
        })
    }

    /// Mean length of the straight pieces (m).
    pub(super) fn mean_m(&self) -> f64 {
        match self.straight {
            Straight::Exponential { mean_m } => mean_m,
            Straight::Fixed { length_m } => length_m,
        }
    }
}

/// A target as it walks at random.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stroll {
    gait: Gait,
    seed: Seed,
    /// Number of the target.
    number: u64,
    /// Random numbers drawn so far.
    draws: u64,
    is_planar: bool,
    /// Where it goes: a vector of length one.
    direction: Position,
    /// What is left to go before the next turn (m).
    left_m: f64,
}

impl Stroll {
    /// The walk of target number `number`, in any direction at first; in a flat region if it `is_planar`.
    pub(super) fn new(gait: Gait, region: &Region, number: u64, seed: Seed) -> Self {
        let (direction, is_planar) = (Position::new(1.0, 0.0, 0.0), region.is_planar());
        let mut stroll = Self { gait, seed, number, draws: 0, is_planar, direction, left_m: 0.0 };
        stroll.set_out();
        stroll
    }

    /// Begins a straight piece in any direction.
    pub(super) fn set_out(&mut self) {
        self.direction = self.any_direction();
        self.left_m = self.straight_m();
    }

    /// Begins a straight piece in `direction` (of length one).
    pub(super) fn set_out_in(&mut self, direction: Position) {
        self.direction = direction;
        self.left_m = self.straight_m();
    }

    /// Where it goes: a vector of length one.
    pub(super) fn direction(&self) -> Position {
        self.direction
    }

    /// The end of the next leg, which begins at `from` and is at most `most_m` long in the direction that it takes. At the
    /// border of `region` the target is reflected like light by a mirror; in front of an obstacle it takes any direction
    /// that leads away. `None` if there is no way out of that place.
    pub(super) fn step(
        &mut self,
        from: Position,
        most_m: impl Fn(Position) -> f64,
        Ground { region, obstacles }: Ground<'_>,
    ) -> Option<(Position, f64)> {
        for _ in 0..ATTEMPTS {
            let border = region.way_out(from, self.direction);
            let most_m = most_m(self.direction);
            if most_m < LEAST_LEG_M {
                self.direction = self.any_direction();
                continue;
            }
            let wanted_m = self.left_m.min(most_m);
            let inside_m = (border.distance_m - MARGIN_M).clamp(0.0, wanted_m);
            let length_m = obstacles.clearance_m(from, self.direction, inside_m, CLEARANCE_M);
            let to = from + self.direction * length_m;
            let leaves = !region.contains(to);
            if leaves || length_m < inside_m {
                self.direction = self.any_direction();
            } else if inside_m < wanted_m {
                self.direction = self.direction - border.normal * (2.0 * self.direction.dot(border.normal));
            }
            if leaves || length_m < LEAST_LEG_M && wanted_m >= LEAST_LEG_M {
                continue;
            }
            self.left_m -= length_m;
            if self.left_m < LEAST_LEG_M {
                self.turn();
            }
            if length_m >= LEAST_LEG_M {
                return Some((to, length_m));
            }
        }
        None
    }

    /// Turns, and begins the next straight piece.
    fn turn(&mut self) {
        let angle = match self.gait.turn {
            Turn::Uniform { most_rad } => most_rad * (2.0 * self.uniform() - 1.0),
            Turn::Normal { sigma_rad } => {
                self.draws += 1;
                sigma_rad * self.seed.normal(purpose::TARGETS, [self.number, self.draws, 0])
            }
        };
        let aside = self.aside();
        let turned = self.direction * libm::cos(angle) + aside * libm::sin(angle);
        self.set_out_in(turned * (1.0 / turned.length_m()));
    }

    /// A direction at a right angle to that of the target, of length one: to the left in a flat region, any in space.
    fn aside(&mut self) -> Position {
        let ahead = self.direction;
        let left = Position::new(-ahead.y_m, ahead.x_m, 0.0);
        if self.is_planar {
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
        let up: f64 = if self.is_planar { 0.0 } else { 2.0 * self.uniform() - 1.0 };
        let across = (1.0 - up * up).sqrt();
        Position::new(across * libm::cos(azimuth), across * libm::sin(azimuth), up)
    }

    /// Length of the next straight piece (m).
    fn straight_m(&mut self) -> f64 {
        match self.gait.straight {
            Straight::Exponential { mean_m } => -mean_m * libm::log(self.uniform()),
            Straight::Fixed { length_m } => length_m,
        }
    }

    /// A random number, uniform in (0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        self.draws += 1;
        self.seed.uniform(purpose::TARGETS, [self.number, self.draws, 0])
    }
}
