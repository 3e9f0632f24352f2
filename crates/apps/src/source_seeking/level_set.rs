//! The law of sliding mode that takes a robot to a level set of a field and along it (Matveev, Teimoori, Savkin 2012,
//! "Method for tracking of environmental level sets by a unicycle-like vehicle", Automatica 48 (9); thesis, chapter 7).
//!
//! A robot with constant speed v turns at the rate u = ±w sgn(S) with S = d' + χ(d - d0), where d is the value of the
//! field D at the robot, d0 the level, w the largest turn rate, and χ(p) = γ p within ±δ, ±γ δ beyond. On S = 0 the
//! value rises at the constant rate γ δ far below the level, and nears it as exp(-γ t) close to it.
//!
//! S = 0 can be reached only where γ δ < v |∇D|: otherwise the robot turns on the spot for ever. The law can be told the
//! steepest climb v |∇D| around it, and then climbs at a share of it.

use std::f64::consts::PI;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// On which hand of the robot the field is higher while it follows a level set.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum HigherField {
    /// On the left: the robot circles a maximum counterclockwise (Matveev, Teimoori, Savkin 2012).
    Left,
    /// On the right: the robot circles a maximum clockwise (thesis, chapter 7).
    #[default]
    Right,
}

/// How fast the law climbs far from the level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Climb {
    /// χ saturates at this distance δ from the level.
    Delta(f64),
    /// At this share of the steepest climb that is possible.
    Share(f64),
}

/// What happens if the robot only turns in circles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Patience {
    /// Nothing: the law as it was published.
    Endless,
    /// After two turns in one direction it climbs at half the rate.
    TwoTurns,
}

/// The settings of the law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LevelSet {
    /// The level d0, in the unit of the field.
    pub(super) level: f64,
    /// w (rad/s).
    pub(super) turn_rate_max: f64,
    /// γ (1/s).
    pub(super) gamma_per_s: f64,
    pub(super) climb: Climb,
    pub(super) higher: HigherField,
    /// The sign of S is replaced by S / ε within ±ε, as a share of γ δ; 0 for the sign itself.
    pub(super) boundary_layer: f64,
    pub(super) patience: Patience,
}

/// The law on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sliding {
    law: LevelSet,
    /// By how much the climb is reduced because the robot turned in circles.
    patience: f64,
    /// Angle turned since S last changed its sign (rad).
    one_way_rad: f64,
    last_sign: f64,
}

/// Smallest factor that circles can bring the climb down to.
const LEAST_PATIENCE: f64 = 1.0 / 1024.0;

impl Sliding {
    pub(super) fn new(law: LevelSet) -> Self {
        Self { law, patience: 1.0, one_way_rad: 0.0, last_sign: 0.0 }
    }

    /// Begins again: what was learnt elsewhere does not hold here.
    pub(super) fn restart(&mut self) {
        *self = Self::new(self.law);
    }

    /// The rate γ δ of the climb far below the level (1/s), where the steepest one that is possible is `steepest`.
    fn climb_rate(&self, steepest: f64) -> f64 {
        let rate = match self.law.climb {
            Climb::Delta(delta) => self.law.gamma_per_s * delta,
            Climb::Share(share) => share * steepest,
        };
        self.patience * rate
    }

    /// The turn rate (rad/s, counterclockwise) for the next `span_s`, where the field is `value` and changes by `rate`
    /// (1/s). `steepest` is v |∇D| (1/s), the fastest change that a robot here can see.
    pub(super) fn turn_rate(&mut self, value: f64, rate: f64, steepest: f64, span_s: f64) -> f64 {
        let law = self.law;
        let climb = self.climb_rate(steepest);
        let chi = (law.gamma_per_s * (value - law.level)).clamp(-climb, climb);
        let sliding = rate + chi;
        let layer = law.boundary_layer * climb;
        let sign = if layer > 0.0 {
            (sliding / layer).clamp(-1.0, 1.0)
        } else if sliding > 0.0 {
            1.0
        } else if sliding < 0.0 {
            -1.0
        } else {
            0.0
        };
        let turn_rate = sign * law.turn_rate_max;
        self.watch(sign, turn_rate.abs() * span_s);
        match law.higher {
            HigherField::Right => turn_rate,
            HigherField::Left => -turn_rate,
        }
    }

    /// Notices circles.
    fn watch(&mut self, sign: f64, turned_rad: f64) {
        if sign * self.last_sign < 0.0 {
            self.one_way_rad = 0.0;
        }
        self.last_sign = sign;
        self.one_way_rad += turned_rad;
        if self.law.patience == Patience::TwoTurns && self.one_way_rad > 4.0 * PI {
            self.one_way_rad = 0.0;
            self.patience = (0.5 * self.patience).max(LEAST_PATIENCE);
        }
    }
}
