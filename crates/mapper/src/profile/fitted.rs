//! The settings of a profile that is estimated from the log.

/// The fitted profile as written in a scenario: a curve that never rises and is estimated from the log.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FittedConfig {
    /// Maximum number of rounds, 1 or more. The estimation then ends even if it has not converged.
    #[cfg_attr(feature = "config", serde(default = "default_max_rounds"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub max_rounds: u32,
    /// The curve has converged if it changes by less than this from one round to the next: root mean square over all
    /// pairs of a node and a stop in range. A change of a fifth of the statistical error is also small enough.
    #[cfg_attr(feature = "config", serde(default = "default_tolerance"))]
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
