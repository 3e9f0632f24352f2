//! The mapping algorithms by name.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::ReceptionLog;
use sextant_kernel::SettingError;

use crate::{Fit, FittedMlTm, MapError, MlTm, MlTmConfig, ProfileConfig, TopologyMap};

/// One map to compute from the reception log, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapConfig {
    /// Name of the map in tables and recordings; the algorithm's name if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// How the map is computed.
    pub algorithm: AlgorithmConfig,
}

/// A mapping algorithm as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum AlgorithmConfig {
    /// Maximum likelihood on a grid.
    MlTm(MlTmConfig),
}

impl AlgorithmConfig {
    /// The reception profile that is assumed, if one is.
    pub fn profile_mut(&mut self) -> Option<&mut ProfileConfig> {
        match self {
            Self::MlTm(config) => Some(&mut config.profile),
        }
    }
}

/// A mapping algorithm, ready to map any log.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Mapper {
    /// Maximum likelihood on a grid.
    MlTm(MlTm),
    /// Maximum likelihood on a grid under a profile estimated from the log.
    FittedMlTm(FittedMlTm),
}

impl Mapper {
    /// The algorithm's name in tables and topics: `ml-tm`.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::MlTm(_) | Self::FittedMlTm(_) => MlTm::NAME,
        }
    }

    /// The map of the nodes in `log`.
    ///
    /// # Errors
    /// If the map would need more than the memory allowed.
    pub fn map(&self, log: &ReceptionLog) -> Result<TopologyMap, MapError> {
        self.map_and_fit(log).map(|(map, _)| map)
    }

    /// The map of the nodes in `log`, and the reception profile if it was estimated from the log.
    ///
    /// # Errors
    /// If the map would need more than the memory allowed.
    pub fn map_and_fit(&self, log: &ReceptionLog) -> Result<(TopologyMap, Option<Fit>), MapError> {
        match self {
            Self::MlTm(ml_tm) => ml_tm.map(log).map(|map| (map, None)),
            Self::FittedMlTm(fitted) => fitted.map(log),
        }
    }
}

impl TryFrom<AlgorithmConfig> for Mapper {
    type Error = SettingError;

    fn try_from(config: AlgorithmConfig) -> Result<Self, SettingError> {
        match config {
            AlgorithmConfig::MlTm(config) => match config.profile.clone() {
                ProfileConfig::Fitted(fitted) => FittedMlTm::new(config, fitted).map(Self::FittedMlTm),
                ProfileConfig::Trapezoid(_) | ProfileConfig::Channel(_) => MlTm::try_from(config).map(Self::MlTm),
            }
            .map_err(|error| error.within("ml_tm")),
        }
    }
}
