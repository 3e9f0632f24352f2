//! The sensors of the nodes.

use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

/// The sensors of the nodes, as written in a scenario: all nodes have the same. Without a table they sense nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct SensorsConfig {
    /// The sensor that detects targets.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub targets: Option<TargetSensorConfig>,
    /// The sensor that samples all fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fields: Option<FieldSensorConfig>,
}

/// A sensor that detects targets within a radius of its node, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TargetSensorConfig {
    /// Radius of detection: of a disc in the plane, of a ball in space (m).
    pub radius_m: f64,
    /// Probability that the sensor misses a whole passage of a target through its radius: 0 to below 1.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 0.0)))]
    pub miss_probability: f64,
    /// False alarms of each node in an hour: the mean of a Poisson process. At each, the node detects a random one of the
    /// targets that is not there.
    #[serde(default, skip_serializing_if = "is_zero")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 0.0)))]
    pub false_alarms_per_h: f64,
    /// How long a false alarm lasts (s).
    #[serde(default = "TargetSensorConfig::usual_false_alarm_s", skip_serializing_if = "is_usual_false_alarm")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 1.0)))]
    pub false_alarm_s: f64,
    /// Whether a node detects a target only while no solid obstacle is on the straight line between them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = false)))]
    pub walls_hide: bool,
}

impl TargetSensorConfig {
    /// A sensor that makes no errors and looks through obstacles.
    #[must_use]
    pub fn perfect(radius_m: f64) -> Self {
        Self {
            radius_m,
            miss_probability: 0.0,
            false_alarms_per_h: 0.0,
            false_alarm_s: Self::usual_false_alarm_s(),
            walls_hide: false,
        }
    }

    fn usual_false_alarm_s() -> f64 {
        1.0
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form that serde calls")]
fn is_zero(value: &f64) -> bool {
    *value == 0.0
}

#[expect(
    clippy::trivially_copy_pass_by_ref,
    clippy::float_cmp,
    reason = "the form that serde calls, and the very default"
)]
fn is_usual_false_alarm(value: &f64) -> bool {
    *value == TargetSensorConfig::usual_false_alarm_s()
}

/// A sensor that samples all fields, as written in a scenario. Each node samples at its own phase of the interval. A
/// signal-to-noise ratio refers to the mean over all nodes of the squared value of the field, with all sources there.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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

/// A sensor that detects targets within a radius of its node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TargetSensor {
    pub(crate) radius_m: f64,
    pub(crate) miss_probability: f64,
    pub(crate) false_alarms_per_s: f64,
    pub(crate) false_alarm: Duration,
    pub(crate) walls_hide: bool,
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
        let targets = config.targets.map(TargetSensor::try_from);
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

impl TryFrom<TargetSensorConfig> for TargetSensor {
    type Error = SettingError;

    fn try_from(config: TargetSensorConfig) -> Result<Self, SettingError> {
        let TargetSensorConfig { radius_m, miss_probability, false_alarms_per_h, false_alarm_s, walls_hide } = config;
        if !(0.0..1.0).contains(&miss_probability) {
            return Err(SettingError::new("targets.miss_probability", miss_probability, "0 or more, and below 1"));
        }
        let per_h = SettingError::in_range("targets.false_alarms_per_h", false_alarms_per_h, 0.0, 1e6)?;
        let false_alarm_s = SettingError::in_range("targets.false_alarm_s", false_alarm_s, 1e-3, 1e6)?;
        Ok(Self {
            radius_m: SettingError::in_range("targets.radius_m", radius_m, 1e-3, 1e6)?,
            miss_probability,
            false_alarms_per_s: per_h / 3600.0,
            false_alarm: Duration::from_secs_f64(false_alarm_s),
            walls_hide,
        })
    }
}

impl TargetSensor {
    /// False alarms of each node in a second: the mean.
    #[must_use]
    pub fn false_alarms_per_s(&self) -> f64 {
        self.false_alarms_per_s
    }

    /// How long a false alarm lasts.
    #[must_use]
    pub fn false_alarm(&self) -> Duration {
        self.false_alarm
    }

    /// Probability that it misses a passage.
    #[must_use]
    pub fn miss_probability(&self) -> f64 {
        self.miss_probability
    }

    /// Whether it misses passages, or raises false alarms.
    #[must_use]
    pub fn errs(&self) -> bool {
        self.miss_probability > 0.0 || self.false_alarms_per_s > 0.0
    }

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
        let of_targets = |targets| SensorsConfig { targets: Some(targets), fields: None };
        let disc = |radius_m| of_targets(TargetSensorConfig::perfect(radius_m));
        assert_eq!(key(disc(0.0)), "targets.radius_m");
        assert_eq!(key(disc(f64::NAN)), "targets.radius_m");
        assert_eq!(key(with(FieldSensorConfig { interval_s: 0.0, ..fields })), "fields.interval_s");
        let offset_snr_db = Some(f64::NAN);
        assert_eq!(key(with(FieldSensorConfig { offset_snr_db, ..fields })), "fields.offset_snr_db");
        let noise_snr_db = Some(1e3);
        assert_eq!(key(with(FieldSensorConfig { noise_snr_db, ..fields })), "fields.noise_snr_db");
        assert_eq!(Sensors::try_from(SensorsConfig::default()), Ok(Sensors::default()));
        let perfect = TargetSensorConfig::perfect(1.0);
        for miss_probability in [-0.1, 1.0, f64::NAN] {
            let error =
                Sensors::try_from(of_targets(TargetSensorConfig { miss_probability, ..perfect })).unwrap_err();
            assert_eq!(error.key, "targets.miss_probability");
            assert!(error.to_string().contains("0 or more, and below 1"), "{error}");
        }
        let false_alarms_per_h = -1.0;
        assert_eq!(
            key(of_targets(TargetSensorConfig { false_alarms_per_h, ..perfect })),
            "targets.false_alarms_per_h"
        );
        assert_eq!(key(of_targets(TargetSensorConfig { false_alarm_s: 0.0, ..perfect })), "targets.false_alarm_s");
    }

    #[test]
    fn a_sensor_without_errors_is_written_as_its_radius_alone() {
        let written = toml::to_string(&TargetSensorConfig::perfect(1.5)).unwrap();
        assert_eq!(written, "radius_m = 1.5\n");
        let read: TargetSensorConfig = toml::from_str(&written).unwrap();
        assert_eq!(read, TargetSensorConfig::perfect(1.5));
        let erring = "radius_m = 1.5\nmiss_probability = 0.5\nfalse_alarms_per_h = 3.0\nfalse_alarm_s = 2.0\nwalls_hide = true\n";
        let read: TargetSensorConfig = toml::from_str(erring).unwrap();
        assert_eq!(toml::to_string(&read).unwrap(), erring);
    }
}
