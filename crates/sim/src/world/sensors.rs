//! The sensors of the nodes.

use std::time::Duration;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

/// The sensors of the nodes, as written in a scenario: all nodes have the same. Without a table they sense nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct SensorsConfig {
    /// The sensor that detects targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub targets: Option<TargetSensorConfig>,
    /// The sensor that samples all fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fields: Option<FieldSensorConfig>,
}

/// A sensor that detects each target within a radius of its node, as written in a scenario. Obstacles do not matter.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct TargetSensorConfig {
    /// Radius of detection: of a disc in the plane, of a ball in space (m).
    pub radius_m: f64,
}

/// A sensor that samples all fields, as written in a scenario. Each node samples at its own phase of the interval. A
/// signal-to-noise ratio refers to the mean over all nodes of the squared value of the field, with all sources there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FieldSensorConfig {
    /// Time between two samples of a node (s).
    pub interval_s: f64,
    /// Ratio of signal to offset (dB): each sensor is off by another constant, which is normally distributed with
    /// zero mean (thesis, chapter 7, SNR). No offset if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub offset_snr_db: Option<f64>,
    /// Ratio of signal to noise (dB): each sample is off by an own, normally distributed amount. No noise if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise_snr_db: Option<f64>,
}

/// The sensors of the nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensors {
    /// The sensor that detects targets.
    pub targets: Option<TargetSensor>,
    /// The sensor that samples all fields.
    pub fields: Option<FieldSensor>,
}

/// A sensor that detects each target within a radius of its node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetSensor {
    pub(crate) radius_m: f64,
}

/// A sensor that samples all fields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldSensor {
    pub(crate) interval: Duration,
    pub(crate) offset_snr_db: Option<f64>,
    pub(crate) noise_snr_db: Option<f64>,
}

impl TryFrom<SensorsConfig> for Sensors {
    type Error = SettingError;

    fn try_from(config: SensorsConfig) -> Result<Self, SettingError> {
        let ratio = |key, ratio_db: Option<f64>| {
            ratio_db.map(|ratio_db| SettingError::in_range(key, ratio_db, -100.0, 200.0)).transpose()
        };
        let targets = config.targets.map(|TargetSensorConfig { radius_m }| {
            let radius_m = SettingError::in_range("targets.radius_m", radius_m, 1e-3, 1e6)?;
            Ok(TargetSensor { radius_m })
        });
        let fields = config.fields.map(|FieldSensorConfig { interval_s, offset_snr_db, noise_snr_db }| {
            let interval_s = SettingError::in_range("fields.interval_s", interval_s, 1e-3, 1e6)?;
            Ok(FieldSensor {
                interval: Duration::from_secs_f64(interval_s),
                offset_snr_db: ratio("fields.offset_snr_db", offset_snr_db)?,
                noise_snr_db: ratio("fields.noise_snr_db", noise_snr_db)?,
            })
        });
        Ok(Self { targets: targets.transpose()?, fields: fields.transpose()? })
    }
}

impl TargetSensor {
    /// Radius of detection (m).
    #[must_use]
    pub fn radius_m(&self) -> f64 {
        self.radius_m
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_sensors_are_rejected_with_their_key() {
        let fields = FieldSensorConfig { interval_s: 1.0, offset_snr_db: None, noise_snr_db: None };
        let with = |fields| SensorsConfig { targets: None, fields: Some(fields) };
        let key = |config: SensorsConfig| Sensors::try_from(config).unwrap_err().key;
        let disc = |radius_m| SensorsConfig { targets: Some(TargetSensorConfig { radius_m }), fields: None };
        assert_eq!(key(disc(0.0)), "targets.radius_m");
        assert_eq!(key(disc(f64::NAN)), "targets.radius_m");
        assert_eq!(key(with(FieldSensorConfig { interval_s: 0.0, ..fields })), "fields.interval_s");
        let offset_snr_db = Some(f64::NAN);
        assert_eq!(key(with(FieldSensorConfig { offset_snr_db, ..fields })), "fields.offset_snr_db");
        let noise_snr_db = Some(1e3);
        assert_eq!(key(with(FieldSensorConfig { noise_snr_db, ..fields })), "fields.noise_snr_db");
        assert_eq!(Sensors::try_from(SensorsConfig::default()), Ok(Sensors::default()));
    }
}
