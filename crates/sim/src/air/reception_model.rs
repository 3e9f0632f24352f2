//! The rules that decide whether a frame is received.

use serde::{Deserialize, Serialize};
use sextant_channel::Db;
use sextant_kernel::SettingError;

/// The rule that decides whether a frame is received, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum ReceptionConfig {
    /// Any two signals above the sensitivity that overlap at the receiver destroy each other: the model of
    /// most analytic work on CSMA-CA.
    Overlap {},
    /// The ratio of signal to interference and noise stays at or above a threshold during the whole frame
    /// (capture).
    SinrThreshold(ThresholdConfig),
    /// The ratio of signal to interference, without noise, stays at or above a threshold during the whole frame: for
    /// spread signals, whose sensitivity lies below the noise.
    SirThreshold(ThresholdConfig),
    /// Bit errors occur at the rate of O-QPSK with DSSS (IEEE 802.15.4-2006 annex E); the frame is received with
    /// the probability that it has no bit error. Only with the physical layer `oqpsk2450`.
    Ber {},
}

/// A threshold of capture, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ThresholdConfig {
    /// Minimum ratio (dB).
    #[serde(default = "default_threshold_db")]
    pub threshold_db: f64,
}

impl Default for ThresholdConfig {
    fn default() -> Self {
        Self { threshold_db: default_threshold_db() }
    }
}

fn default_threshold_db() -> f64 {
    3.0
}

impl Default for ReceptionConfig {
    fn default() -> Self {
        Self::SinrThreshold(ThresholdConfig { threshold_db: default_threshold_db() })
    }
}

/// The rule that decides whether a frame is received.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ReceptionModel {
    /// Two audible signals that overlap destroy each other.
    Overlap,
    /// Received if the ratio of signal to interference and noise never falls below a threshold.
    SinrThreshold {
        /// Minimum ratio, as a factor.
        least: f64,
    },
    /// Received if the ratio of signal to interference never falls below a threshold.
    SirThreshold {
        /// Minimum ratio, as a factor.
        least: f64,
    },
    /// Received with the probability that no bit is wrong.
    Ber,
}

impl TryFrom<ReceptionConfig> for ReceptionModel {
    type Error = SettingError;

    fn try_from(config: ReceptionConfig) -> Result<Self, SettingError> {
        Ok(match config {
            ReceptionConfig::Overlap {} => Self::Overlap,
            ReceptionConfig::SinrThreshold(ThresholdConfig { threshold_db }) => {
                let threshold_db = SettingError::in_range("sinr_threshold.threshold_db", threshold_db, -30.0, 60.0)?;
                Self::SinrThreshold { least: Db(threshold_db).to_factor() }
            }
            ReceptionConfig::SirThreshold(ThresholdConfig { threshold_db }) => {
                let threshold_db = SettingError::in_range("sir_threshold.threshold_db", threshold_db, -30.0, 60.0)?;
                Self::SirThreshold { least: Db(threshold_db).to_factor() }
            }
            ReceptionConfig::Ber {} => Self::Ber,
        })
    }
}
