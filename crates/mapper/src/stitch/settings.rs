//! Settings of stitching.

#[cfg(feature = "config")]
use schemars::JsonSchema;
#[cfg(feature = "config")]
use serde::{Deserialize, Serialize};

use super::frame_change::Lengths;

/// How the maps of several robots are stitched, as written in a scenario. The frames of the robots differ by an unknown
/// turn and offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(Serialize, Deserialize, JsonSchema))]
#[cfg_attr(feature = "config", serde(deny_unknown_fields, default))]
pub struct StitchConfig {
    /// Whether the frame of a robot may be a mirror image of that of another one.
    pub mirrored: bool,
    /// Whether the odometry of robots may have different scales.
    pub scaled: bool,
}

impl Default for StitchConfig {
    fn default() -> Self {
        Self { mirrored: true, scaled: false }
    }
}

/// How the maps of several robots are stitched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct StitchRules {
    pub(super) mirrored: bool,
    pub(super) lengths: Lengths,
}

impl From<StitchConfig> for StitchRules {
    fn from(config: StitchConfig) -> Self {
        let lengths = if config.scaled { Lengths::Scaled } else { Lengths::Kept };
        Self { mirrored: config.mirrored, lengths }
    }
}
