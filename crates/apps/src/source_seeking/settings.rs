//! The settings of source seeking, checked.

use std::time::Duration;

use sextant_kernel::SettingError;
use sextant_sim::{Field, FieldId};

use super::config::{AfterArrival, GoalConfig, GradientConfig, LevelSetConfig, PollConfig, Preset, SpaceConfig};
use super::field_estimate::{EstimateConfig, LocalFitConfig};
use super::level_set::{Climb, HigherField, LevelSet, Patience};
use super::rate::RateConfig;

/// The settings of source seeking, checked.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceSeeking {
    pub(super) goal: Goal,
    pub(super) guidance: Guidance,
    pub(super) turn_rate_max_rad_per_s: f64,
    pub(super) control: Duration,
    pub(super) estimate: EstimateConfig,
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

/// What robots seek.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Goal {
    pub(super) field: FieldId,
    pub(super) level: f64,
    pub(super) tolerance: f64,
    pub(super) hold: Duration,
    pub(super) then: AfterArrival,
    pub(super) arrivals: u32,
    pub(super) remove_within_m: Option<f64>,
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
    Gradient { gain_per_s: f64 },
}

/// Torsion of a path in space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Torsion {
    /// As large as the largest curvature: the plane of the path turns as fast as the path in it can.
    LikeCurvature,
    /// So many radians per metre.
    PerMetre(f64),
}

/// How robots ask nodes for their readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Poll {
    pub(super) interval: Duration,
    pub(super) reach_m: Option<f64>,
    pub(super) memory: Duration,
}

/// Longest times (s).
const LONGEST_INTERVAL_S: f64 = 60.0;
const LONGEST_S: f64 = 1e6;

impl SourceSeeking {
    /// The settings of the law of sliding mode, in a world with these fields.
    ///
    /// # Errors
    /// If a setting is out of its range, or there is no such field.
    pub fn level_set(config: &LevelSetConfig, fields: &[Field]) -> Result<Self, SettingError> {
        let turn_rate_max = SettingError::positive("turn_rate_max_rad_per_s", config.turn_rate_max_rad_per_s)?;
        let goal = goal(&config.goal, fields).map_err(|error| error.within("goal"))?;
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
        let estimate = config.estimate.unwrap_or_else(|| match config.preset {
            Preset::Thesis => EstimateConfig::PowerWeights {},
            Preset::Adaptive => EstimateConfig::default(),
        });
        if matches!((climb, estimate), (Climb::Share(_), EstimateConfig::PowerWeights {})) {
            let remedy = "set `delta`, because power weights do not show how steep the field is";
            return Err(SettingError::conflict("climb_share", "`estimate.power_weights`", remedy));
        }
        let boundary_layer = config.boundary_layer.unwrap_or(if is_thesis { 0.0 } else { 0.5 });
        if config.space.is_some() && estimate == (EstimateConfig::PowerWeights {}) {
            let remedy = "use `estimate.local_fit`, because power weights do not show where the field is higher";
            return Err(SettingError::conflict("space", "`estimate.power_weights`", remedy));
        }
        let torsion = config.space.map(|SpaceConfig { torsion_per_m }| match torsion_per_m {
            None => Ok(Torsion::LikeCurvature),
            Some(torsion) => SettingError::finite("space.torsion_per_m", torsion).map(Torsion::PerMetre),
        });
        let rate = config.rate.unwrap_or(RateConfig::LeastSquares { samples: 5 });
        let law = LevelSet {
            level: goal.level,
            turn_rate_max,
            gamma_per_s: SettingError::positive("gamma_per_s", config.gamma_per_s.unwrap_or(1.0))?,
            climb,
            boundary_layer: SettingError::in_range("boundary_layer", boundary_layer, 0.0, 100.0)?,
            patience: if is_thesis { Patience::Endless } else { Patience::TwoTurns },
        };
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
            estimate: estimate.checked().map_err(|error| error.within("estimate"))?,
            poll: poll(&config.poll).map_err(|error| error.within("poll"))?,
            when_stuck: if is_thesis { WhenStuck::GoesOn } else { WhenStuck::Wanders },
        })
    }

    /// The settings of a robot that follows the gradient, in a world with these fields.
    ///
    /// # Errors
    /// If a setting is out of its range, or there is no such field.
    pub fn gradient(config: &GradientConfig, fields: &[Field]) -> Result<Self, SettingError> {
        Ok(Self {
            goal: goal(&config.goal, fields).map_err(|error| error.within("goal"))?,
            guidance: Guidance::Gradient {
                gain_per_s: SettingError::positive("heading_gain_per_s", config.heading_gain_per_s)?,
            },
            turn_rate_max_rad_per_s: SettingError::positive(
                "turn_rate_max_rad_per_s",
                config.turn_rate_max_rad_per_s,
            )?,
            control: control(config.control_s)?,
            estimate: config.estimate.checked().map_err(|error| error.within("estimate"))?,
            poll: poll(&config.poll).map_err(|error| error.within("poll"))?,
            when_stuck: WhenStuck::Wanders,
        })
    }

    /// The field that is sought.
    #[must_use]
    pub fn field(&self) -> FieldId {
        self.goal.field
    }

    /// The value that is sought.
    #[must_use]
    pub fn level(&self) -> f64 {
        self.goal.level
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

    /// How far below the level a robot has arrived.
    #[must_use]
    pub fn tolerance(&self) -> f64 {
        self.goal.tolerance
    }
}

fn span(key: &str, seconds: f64, least_s: f64, most_s: f64) -> Result<Duration, SettingError> {
    SettingError::in_range(key, seconds, least_s, most_s).map(Duration::from_secs_f64)
}

fn control(control_s: f64) -> Result<Duration, SettingError> {
    span("control_s", control_s, 1e-3, 10.0)
}

fn goal(config: &GoalConfig, fields: &[Field]) -> Result<Goal, SettingError> {
    let arrivals = config.arrivals;
    if arrivals == 0 {
        return Err(SettingError::new("arrivals", arrivals, "1 or more"));
    }
    if arrivals > 1 && config.remove_within_m.is_none() {
        let allowed =
            "1, unless `remove_within_m` says which sources a robot removes: otherwise it stays with the first";
        return Err(SettingError::new("arrivals", arrivals, allowed));
    }
    let tolerance = SettingError::not_negative("tolerance", config.tolerance)?;
    let hold = span("hold_s", config.hold_s, 0.0, LONGEST_S)?;
    if tolerance <= 0.0 && !hold.is_zero() {
        return Err(SettingError::new("tolerance", tolerance, "a number above 0 beside `hold_s`"));
    }
    Ok(Goal {
        field: field(config.field.as_deref(), fields)?,
        level: SettingError::finite("level", config.level)?,
        tolerance,
        hold,
        then: config.then,
        arrivals,
        remove_within_m: config
            .remove_within_m
            .map(|reach_m| SettingError::positive("remove_within_m", reach_m))
            .transpose()?,
    })
}

/// The field with this name, or the only one.
fn field(name: Option<&str>, fields: &[Field]) -> Result<FieldId, SettingError> {
    let names = || {
        let names: Vec<String> = fields.iter().map(|field| format!("`{}`", field.name())).collect();
        if names.is_empty() { "a field in [[world.fields]]: there is none".into() } else { names.join(", ") }
    };
    let index = match (name, fields) {
        (Some(name), _) => fields
            .iter()
            .position(|field| field.name() == name)
            .ok_or_else(|| SettingError::new("field", format!("`{name}`"), names()))?,
        (None, [_]) => 0,
        (None, _) => return Err(SettingError::missing("field", names())),
    };
    Ok(FieldId(u16::try_from(index).expect("at most 65536 fields")))
}

fn poll(config: &PollConfig) -> Result<Poll, SettingError> {
    let interval = span("interval_s", config.interval_s, 0.05, LONGEST_INTERVAL_S)?;
    let memory = span("memory_s", config.memory_s, 0.05, LONGEST_S)?;
    if memory < interval {
        let allowed = format!("at least {}, the value of `interval_s`", config.interval_s);
        return Err(SettingError::new("memory_s", config.memory_s, allowed));
    }
    let reach_m = config.reach_m.map(|reach_m| SettingError::positive("reach_m", reach_m)).transpose()?;
    Ok(Poll { interval, reach_m, memory })
}

impl EstimateConfig {
    /// Itself, if it is valid.
    fn checked(self) -> Result<Self, SettingError> {
        if let Self::LocalFit(LocalFitConfig { bandwidth_spacings, significance }) = self {
            let table = "local_fit";
            SettingError::in_range("bandwidth_spacings", bandwidth_spacings, 0.1, 100.0)
                .map_err(|error| error.within(table))?;
            SettingError::not_negative("significance", significance).map_err(|error| error.within(table))?;
        }
        Ok(self)
    }
}
