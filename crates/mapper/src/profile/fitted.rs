//! The settings of a profile that is estimated from the log.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The fitted profile as written in a scenario: a curve that never rises, estimated from the log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FittedConfig {
    /// Rounds after which the estimation ends whether it has converged or not; 1 or more.
    #[serde(default = "default_max_rounds")]
    pub max_rounds: u32,
    /// Change of the curve from one round to the next below which it has converged: root of the mean square over all
    /// pairs of a node and a stop in range. A fifth of the statistical error is enough where that is more.
    #[serde(default = "default_tolerance")]
    pub tolerance: f64,
}

fn default_max_rounds() -> u32 {
    80
}

fn default_tolerance() -> f64 {
    1e-3
}

impl Default for FittedConfig {
    fn default() -> Self {
        Self { max_rounds: default_max_rounds(), tolerance: default_tolerance() }
    }
}
