//! The settings of source seeking, checked.

use std::time::Duration;

use sextant_kernel::SettingError;
use sextant_sim::{Field, FieldId};

use super::config::{GradientConfig, LevelSetConfig, Preset, SpaceConfig};
use super::estimate::{Estimate, Weights};
use super::goal::{Goal, Target};
use super::level_set::{Climb, HigherField, LevelSet, Patience};
use super::poll::{Access, Poll};
use super::rate::RateConfig;

/// The settings of source seeking, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceSeeking {
    pub(super) goal: Goal,
    pub(super) guidance: Guidance,
    pub(super) turn_rate_max_rad_per_s: f64,
    pub(super) control: Duration,
    /// Heading at the start, by odometry (rad); as it is if absent.
    pub(super) start_heading_rad: Option<f64>,
    pub(super) estimate: Estimate,
    pub(super) poll: Poll,
    pub(super) when_stuck: WhenStuck,
}

/// What a robot does that is stuck.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WhenStuck {
    /// It goes on.
    GoesOn,
    /// It drives to a random place on the map.
    Wanders,
}

/// How robots are guided.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Guidance {
    /// To the level and along it.
    LevelSet {
        law: LevelSet,
        rate: RateConfig,
        higher: HigherField,
        /// Of robots that move in space.
        torsion: Option<Torsion>,
    },
    /// Up the gradient.
    Gradient {
        gain_per_s: f64,
        /// How far nodes of its plane may be from the robot on the map (m).
        plane_reach_m: Option<f64>,
    },
}

/// Torsion of a path in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Torsion {
    /// As large as the largest curvature: the plane of the path turns as fast as the path in it can.
    LikeCurvature,
    /// So many radians per metre.
    PerMetre(f64),
}

/// Nodes that count with the preset `thesis` (m): a reading of ours, because the thesis does not print the radius.
const THESIS_REACH_M: f64 = 4.0;

impl SourceSeeking {
    /// The settings of the law of sliding mode, in a world with these fields.
    ///
    /// # Errors
    /// If a setting is out of its range, or there is no such field.
    pub fn level_set(config: &LevelSetConfig, fields: &[Field]) -> Result<Self, SettingError> {
        let turn_rate_max = turn_rate_max(config.turn_rate_max_rad_per_s)?;
        let goal = config.goal.checked(fields).map_err(|error| error.within("goal"))?;
        let is_thesis = config.preset == Preset::Thesis;
        let climb = match (config.delta, config.climb_share) {
            (Some(_), Some(_)) => {
                return Err(SettingError::conflict("delta", "`climb_share`", "set one of them"));
            }
            (Some(delta), None) => Climb::Delta(SettingError::positive("delta", delta)?),
            (None, Some(share)) => Climb::Share(SettingError::in_range("climb_share", share, 0.01, 0.99)?),
            (None, None) if is_thesis => Climb::Delta(0.1),
            (None, None) => Climb::Share(0.7),
        };
        let preset = match config.preset {
            Preset::Thesis => Estimate::Mean(Weights::Equal, Some(THESIS_REACH_M)),
            Preset::Adaptive => Estimate::default(),
        };
        let estimate = config.estimate.unwrap_or_default().checked(preset);
        let estimate = estimate.map_err(|error| error.within("estimate"))?;
        let is_mean = matches!(estimate, Estimate::Mean(..));
        if is_mean && matches!(climb, Climb::Share(_)) {
            let remedy = "set `delta`, because a mean does not show how steep the field is";
            return Err(SettingError::conflict("climb_share", "`estimate.weights`", remedy));
        }
        if is_mean && config.space.is_some() {
            let remedy = "use `estimate.local_fit`, because a mean does not show where the field is higher";
            return Err(SettingError::conflict("space", "`estimate.weights`", remedy));
        }
        let boundary_layer = config.boundary_layer.unwrap_or(if is_thesis { 0.0 } else { 0.5 });
        let torsion = config.space.map(|SpaceConfig { torsion_per_m }| match torsion_per_m {
            None => Ok(Torsion::LikeCurvature),
            Some(torsion) => SettingError::finite("space.torsion_per_m", torsion).map(Torsion::PerMetre),
        });
        let rate = config.rate.unwrap_or(match config.preset {
            Preset::Thesis => RateConfig::Difference,
            Preset::Adaptive => RateConfig::LeastSquares { samples: 5 },
        });
        let law = LevelSet {
            level: config.goal.level,
            turn_rate_max,
            gamma_per_s: SettingError::positive("gamma_per_s", config.gamma_per_s.unwrap_or(1.0))?,
            climb,
            boundary_layer: SettingError::in_range("boundary_layer", boundary_layer, 0.0, 100.0)?,
            patience: if is_thesis { Patience::Endless } else { Patience::TwoTurns },
        };
        let in_turn = |heading_deg| SettingError::in_range("start_heading_deg", heading_deg, -360.0, 360.0);
        let heading_deg = config.start_heading_deg.map(in_turn);
        let access = if is_thesis { Access::Ideal } else { Access::frames() };
        Ok(Self {
            goal,
            guidance: Guidance::LevelSet {
                law,
                rate: rate.checked().map_err(|error| error.within("rate"))?,
                higher: config.higher_field.unwrap_or_default(),
                torsion: torsion.transpose()?,
            },
            turn_rate_max_rad_per_s: turn_rate_max,
            control: control(config.control_s)?,
            start_heading_rad: heading_deg.transpose()?.map(f64::to_radians),
            estimate,
            poll: config.poll.checked(access).map_err(|error| error.within("poll"))?,
            when_stuck: if is_thesis { WhenStuck::GoesOn } else { WhenStuck::Wanders },
        })
    }

    /// The settings of a robot that follows the gradient, in a world with these fields.
    ///
    /// # Errors
    /// If a setting is out of its range, or there is no such field.
    pub fn gradient(config: &GradientConfig, fields: &[Field]) -> Result<Self, SettingError> {
        let reach_m = config.plane.reach_m.map(|reach_m| SettingError::positive("plane.reach_m", reach_m));
        let estimate = config.estimate.checked(Estimate::default());
        Ok(Self {
            goal: config.goal.checked(fields)?,
            guidance: Guidance::Gradient {
                gain_per_s: SettingError::positive("heading_gain_per_s", config.heading_gain_per_s)?,
                plane_reach_m: reach_m.transpose()?,
            },
            turn_rate_max_rad_per_s: turn_rate_max(config.turn_rate_max_rad_per_s)?,
            control: control(config.control_s)?,
            start_heading_rad: None,
            estimate: estimate.map_err(|error| error.within("estimate"))?,
            poll: config.poll.checked(Access::frames()).map_err(|error| error.within("poll"))?,
            when_stuck: WhenStuck::Wanders,
        })
    }

    /// The field that is sought.
    #[must_use]
    pub fn field(&self) -> FieldId {
        self.goal.field
    }

    /// The value that is sought; `None` if it is the source, whose value nobody knows.
    #[must_use]
    pub fn level(&self) -> Option<f64> {
        match self.goal.target {
            Target::Level(level) => Some(level.value),
            Target::Source => None,
        }
    }

    /// The value at which a robot has arrived: the level less its tolerance.
    #[must_use]
    pub fn arrival_value(&self) -> Option<f64> {
        match self.goal.target {
            Target::Level(level) => Some(level.value - level.tolerance),
            Target::Source => None,
        }
    }

    /// Whether readings are weighted by the ratio of two powers as numbers in dBm, which has no value if nodes send with
    /// 0 dBm.
    #[must_use]
    pub(crate) fn weighs_by_dbm(&self) -> bool {
        matches!(self.estimate, Estimate::Mean(Weights::DbmRatio, _))
    }

    /// The rate γ δ at which the value rises far below the level (1/s), if the law has a fixed one.
    #[must_use]
    pub fn climb_rate(&self) -> Option<f64> {
        match self.guidance {
            Guidance::LevelSet { law: LevelSet { gamma_per_s, climb: Climb::Delta(delta), .. }, .. } => {
                Some(gamma_per_s * delta)
            }
            Guidance::LevelSet { .. } | Guidance::Gradient { .. } => None,
        }
    }
}

/// A slower robot would turn for hours, and a faster one in hundreds of circles between two decisions.
fn turn_rate_max(rad_per_s: f64) -> Result<f64, SettingError> {
    SettingError::in_range("turn_rate_max_rad_per_s", rad_per_s, 1e-3, 100.0)
}

fn control(control_s: f64) -> Result<Duration, SettingError> {
    SettingError::in_range("control_s", control_s, 1e-3, 10.0).map(Duration::from_secs_f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_turn_that_takes_ages_or_hundreds_of_circles_is_refused() {
        for rate in [0.0, 1e-30, 1e-12, 1e9, 1e12, f64::NAN, f64::INFINITY] {
            let error = turn_rate_max(rate).unwrap_err();
            assert_eq!((error.key.as_str(), error.allowed()), ("turn_rate_max_rad_per_s", "0.001 to 100"));
        }
        for rate in [1e-3, 1.0, 100.0] {
            assert!(turn_rate_max(rate).is_ok());
        }
    }
}
