//! The three outdoor environments of the thesis.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// An environment with known path loss exponent and shadowing (thesis, chapter 3, simulation parameters).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum Environment {
    /// Suburban area: ε = 2.7, σ = 9.6 dB.
    #[serde(rename = "suburban")]
    Suburban,
    /// Heavy tree density: ε = 4.6, σ = 10.6 dB.
    #[serde(rename = "heavy-tree")]
    HeavyTrees,
    /// Light tree density: ε = 3.6, σ = 8.2 dB.
    #[serde(rename = "light-tree")]
    LightTrees,
}

impl Environment {
    /// All environments, in the order of the thesis.
    pub const ALL: [Self; 3] = [Self::Suburban, Self::HeavyTrees, Self::LightTrees];

    /// Path loss exponent ε.
    #[must_use]
    pub const fn exponent(self) -> f64 {
        match self {
            Self::Suburban => 2.7,
            Self::HeavyTrees => 4.6,
            Self::LightTrees => 3.6,
        }
    }

    /// Standard deviation of shadowing σ (dB).
    #[must_use]
    pub const fn sigma_db(self) -> f64 {
        match self {
            Self::Suburban => 9.6,
            Self::HeavyTrees => 10.6,
            Self::LightTrees => 8.2,
        }
    }
}
