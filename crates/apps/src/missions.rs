//! The list of missions, as written in a scenario, where they are called applications.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::beam_tracking::BeamTrackingConfig;
use crate::mission::MissionSettings;
use crate::source_seeking::{GradientConfig, LevelSetConfig};
use crate::target_search::{DetarskConfig, PGConfig};

/// An application on a map of the nodes, as written in a scenario. Its time begins at zero, with targets at their starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct MissionConfig {
    /// Name in tables and recordings; that of the algorithm if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The map that nodes and robots are given.
    pub map: MapSourceConfig,
    /// Names of the robots that take part. If absent, all robots with `role = "agent"` and all that survey, these from
    /// where their survey ended.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub robots: Vec<String>,
    /// Name of the network over which nodes and robots exchange messages; the first one if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// When it ends at the latest (s).
    pub duration_s: f64,
    /// Whether robots may be slower than the targets that they search, which they can then only meet by luck or by a good
    /// prediction.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = false)))]
    pub allow_slower: bool,
    /// What it does.
    pub algorithm: AlgorithmConfig,
}

/// The map that nodes and robots are given, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum MapSourceConfig {
    /// The true places of the nodes.
    Physical {},
    /// The map of this name that is computed in the same run.
    Computed(String),
    /// The map in this file, in the format of tables of nodes: `node,x_m,y_m,z_m`.
    File(PathBuf),
}

/// What an application does, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum AlgorithmConfig {
    /// A search for targets that predicts where they are (DeTarSK).
    Detarsk(DetarskConfig),
    /// A search for targets along a pseudo-gradient of hop counts (P-G).
    PG(PGConfig),
    /// Seeking of the source of a field by its value and rate of change alone (level set, sliding mode).
    LevelSet(LevelSetConfig),
    /// Seeking of the source of a field up the gradient of the readings around the robot.
    Gradient(GradientConfig),
    /// A link of IEEE 802.11ad that a robot keeps while it drives: when are beams trained, and what does a map save?
    BeamTracking(BeamTrackingConfig),
}

impl AlgorithmConfig {
    /// What it says of its mission.
    #[must_use]
    pub fn settings(&self) -> &dyn MissionSettings {
        match self {
            Self::Detarsk(settings) => settings,
            Self::PG(settings) => settings,
            Self::LevelSet(settings) => settings,
            Self::Gradient(settings) => settings,
            Self::BeamTracking(settings) => settings,
        }
    }
}
