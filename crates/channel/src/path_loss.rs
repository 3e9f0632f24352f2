//! Mean loss with distance.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_kernel::SettingError;

use crate::Db;

/// Path loss as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PathLossConfig {
    /// Log-distance law.
    LogDistance(LogDistanceConfig),
}

/// Log-distance path loss as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct LogDistanceConfig {
    /// Path loss exponent: 2 in free space. May be absent if the channel names an environment.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exponent: Option<f64>,
    /// Distance to which `reference_loss_db` refers (m).
    #[serde(default = "default_reference_distance_m")]
    pub reference_distance_m: f64,
    /// Loss at the reference distance (dB). If it is 0, transmit powers are powers at that distance; 40.05 dB is the
    /// loss of free space over 1 m at 2.4 GHz.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub reference_loss_db: f64,
    /// Distance below which the loss is constant (m).
    #[serde(default = "default_min_distance_m")]
    pub min_distance_m: f64,
}

fn default_reference_distance_m() -> f64 {
    1.0
}

fn is_zero(loss_db: &f64) -> bool {
    loss_db.to_bits() == 0
}

fn default_min_distance_m() -> f64 {
    0.1
}

impl Default for LogDistanceConfig {
    /// No exponent, no loss at 1 m, constant below 0.1 m.
    fn default() -> Self {
        Self {
            exponent: None,
            reference_distance_m: default_reference_distance_m(),
            reference_loss_db: 0.0,
            min_distance_m: default_min_distance_m(),
        }
    }
}

/// Log-distance path loss: `L(d) = L0 + 10 ε log10(d / d0)` (thesis eq. 3.14; Rappaport 2002, eq. 4.69),
/// constant below a minimum distance. With `L0 = 0`, transmit powers are powers at `d0`, and nearer receivers have a
/// gain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LogDistance {
    exponent: f64,
    reference_distance_m: f64,
    reference_loss: Db,
    min_distance_m: f64,
}

impl TryFrom<LogDistanceConfig> for LogDistance {
    type Error = SettingError;

    fn try_from(config: LogDistanceConfig) -> Result<Self, SettingError> {
        let exponent = config.exponent.ok_or_else(|| {
            SettingError::new("exponent", "absent", "a finite number above 0, or an environment that has one")
        })?;
        Ok(Self {
            exponent: SettingError::positive("exponent", exponent)?,
            reference_distance_m: SettingError::positive("reference_distance_m", config.reference_distance_m)?,
            reference_loss: Db(SettingError::in_range("reference_loss_db", config.reference_loss_db, -200.0, 300.0)?),
            min_distance_m: SettingError::positive("min_distance_m", config.min_distance_m)?,
        })
    }
}

impl LogDistance {
    /// Path loss exponent ε.
    #[must_use]
    pub fn exponent(&self) -> f64 {
        self.exponent
    }

    /// Distance to which the reference loss refers (m).
    #[must_use]
    pub fn reference_distance_m(&self) -> f64 {
        self.reference_distance_m
    }

    /// Loss at the reference distance.
    #[must_use]
    pub fn reference_loss(&self) -> Db {
        self.reference_loss
    }

    /// Distance below which the loss is constant (m).
    #[must_use]
    pub fn min_distance_m(&self) -> f64 {
        self.min_distance_m
    }

    /// Loss over `distance_m`.
    #[must_use]
    #[inline]
    pub fn loss(&self, distance_m: f64) -> Db {
        let ratio = distance_m.max(self.min_distance_m) / self.reference_distance_m;
        self.reference_loss + Db(10.0 * self.exponent * libm::log10(ratio))
    }

    /// The largest distance at which the loss is at most `loss` (m); 0 if the loss is larger everywhere.
    #[must_use]
    pub fn distance_m(&self, loss: Db) -> f64 {
        if loss < self.loss(0.0) {
            return 0.0;
        }
        self.reference_distance_m * libm::pow(10.0, (loss - self.reference_loss).0 / (10.0 * self.exponent))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn law(exponent: f64) -> LogDistance {
        LogDistanceConfig { exponent: Some(exponent), ..LogDistanceConfig::default() }.try_into().unwrap()
    }

    #[test]
    fn a_decade_of_distance_costs_ten_times_the_exponent() {
        let law = law(2.7);
        assert!(law.loss(1.0).0.abs() < 1e-15);
        assert!((law.loss(10.0).0 - 27.0).abs() < 1e-12);
        assert!((law.loss(0.2) - law.loss(2.0)).0 + 27.0 < 1e-12);
        assert_eq!(law.loss(0.0), law.loss(0.1));
    }

    #[test]
    fn the_loss_at_the_reference_distance_is_added_everywhere() {
        let config =
            LogDistanceConfig { exponent: Some(2.0), reference_loss_db: 40.05, ..LogDistanceConfig::default() };
        let law = LogDistance::try_from(config).unwrap();
        assert!((law.loss(1.0).0 - 40.05).abs() < 1e-12 && (law.loss(10.0).0 - 60.05).abs() < 1e-12);
        assert!((law.distance_m(Db(60.05)) - 10.0).abs() < 1e-9);
    }

    #[test]
    fn distance_is_the_inverse_of_loss() {
        // 40 dB of budget: 30.3, 12.9, 7.4 m in the three environments of the thesis (Table 3.4).
        for (exponent, range_m) in [(2.7, 30.302_711), (3.6, 12.915_497), (4.6, 7.405_685)] {
            let law = law(exponent);
            assert!((law.distance_m(Db(40.0)) - range_m).abs() < 1e-3, "{}", law.distance_m(Db(40.0)));
            assert!((law.loss(law.distance_m(Db(40.0))).0 - 40.0).abs() < 1e-10);
        }
        assert!(law(2.0).distance_m(Db(-20.001)) <= 0.0);
        assert!(law(2.0).distance_m(Db(-20.0)) > 0.0999);
    }

    #[test]
    fn a_bad_law_names_its_key() {
        let good = LogDistanceConfig { exponent: Some(2.0), ..LogDistanceConfig::default() };
        for (config, key) in [
            (LogDistanceConfig { exponent: None, ..good }, "exponent"),
            (LogDistanceConfig { exponent: Some(-2.0), ..good }, "exponent"),
            (LogDistanceConfig { exponent: Some(f64::NAN), ..good }, "exponent"),
            (LogDistanceConfig { reference_distance_m: 0.0, ..good }, "reference_distance_m"),
            (LogDistanceConfig { reference_loss_db: f64::NAN, ..good }, "reference_loss_db"),
            (LogDistanceConfig { min_distance_m: f64::INFINITY, ..good }, "min_distance_m"),
        ] {
            assert_eq!(LogDistance::try_from(config).unwrap_err().key, key);
        }
    }
}
