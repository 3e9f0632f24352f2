//! Settings of the self-calibrated map.

#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::log_facts::heights::check_z_range;

/// The self-calibrated map as written in a scenario. The defaults fit logs of any range.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields))]
pub struct SelfCalibratedConfig {
    /// Distance of neighbouring grid vertices in the last stage (m). If absent, a sixtieth of the range seen in the
    /// log, or a fortieth in space.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub grid_step_m: Option<f64>,
    /// Which knowledge of obstacles is used. Obstacles are modelled as upright. They are searched for only if all
    /// stops have nearly the same height.
    #[cfg_attr(feature = "config", serde(default))]
    pub obstacles: ObstacleKnowledge,
    /// Maximum number of rounds of positions, curve and obstacles, 1 or more. Each stage runs at least one round,
    /// even beyond this number. A log that lists more than 50000 pairs of a node and a stop has at most 30.
    #[cfg_attr(feature = "config", serde(default = "default_max_rounds"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub max_rounds: u32,
    /// Lowest and highest height of a node (m). If absent, level stops mean that nodes are searched for in their
    /// plane. Stops are level if their heights differ by at most a grid step, or by at most a tenth of the spread in
    /// the plane of the stops that hear one node. Otherwise nodes are searched for up to the reach seen in the log
    /// below and above the stops.
    #[cfg_attr(feature = "config", serde(default, skip_serializing_if = "Option::is_none"))]
    pub z_range_m: Option<[f64; 2]>,
}

/// Which knowledge of obstacles a self-calibrated map uses. Ground truth is never part of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "config", serde(rename_all = "snake_case"))]
pub enum ObstacleKnowledge {
    /// None: obstacles are not modelled.
    None,
    /// Which packets were received at which stops.
    FromReceptions,
    /// In addition, what the robot knows of its way: there is no obstacle where it drove straight from one stop
    /// to the next, and an obstacle is likely where it met one.
    #[default]
    FromLog,
}

fn default_max_rounds() -> u32 {
    60
}

impl Default for SelfCalibratedConfig {
    fn default() -> Self {
        Self {
            grid_step_m: None,
            obstacles: ObstacleKnowledge::default(),
            max_rounds: default_max_rounds(),
            z_range_m: None,
        }
    }
}

/// Validated settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    pub(super) grid_step_m: Option<f64>,
    pub(super) obstacles: ObstacleKnowledge,
    pub(super) max_rounds: u32,
    pub(super) z_range_m: Option<[f64; 2]>,
}

impl TryFrom<SelfCalibratedConfig> for Settings {
    type Error = SettingError;

    fn try_from(config: SelfCalibratedConfig) -> Result<Self, SettingError> {
        let SelfCalibratedConfig { grid_step_m, obstacles, max_rounds, z_range_m } = config;
        if let Some(step_m) = grid_step_m {
            SettingError::positive("grid_step_m", step_m)?;
        }
        if max_rounds == 0 {
            return Err(SettingError::new("max_rounds", 0, "1 or more"));
        }
        check_z_range(z_range_m)?;
        Ok(Self { grid_step_m, obstacles, max_rounds, z_range_m })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_settings_are_rejected_with_their_key() {
        let good = SelfCalibratedConfig::default();
        assert!(Settings::try_from(good.clone()).is_ok());
        for (config, key) in [
            (SelfCalibratedConfig { grid_step_m: Some(0.0), ..good.clone() }, "grid_step_m"),
            (SelfCalibratedConfig { grid_step_m: Some(f64::NAN), ..good.clone() }, "grid_step_m"),
            (SelfCalibratedConfig { max_rounds: 0, ..good.clone() }, "max_rounds"),
            (SelfCalibratedConfig { z_range_m: Some([1.0, 0.0]), ..good.clone() }, "z_range_m"),
            (SelfCalibratedConfig { z_range_m: Some([0.0, f64::INFINITY]), ..good }, "z_range_m"),
        ] {
            assert_eq!(Settings::try_from(config).unwrap_err().key, key);
        }
    }
}
