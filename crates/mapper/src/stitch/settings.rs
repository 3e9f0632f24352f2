//! Settings of stitching.

use super::frame_change::Lengths;

/// How the maps of several robots are stitched, as written in a scenario. The frames of the robots differ by an unknown
/// turn and offset.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct StitchConfig {
    /// Whether the frame of a robot may be a mirror image of that of another one.
    pub mirrored: bool,
    /// Whether the odometry of robots may have different scales.
    pub scaled: bool,
    /// Names of the robots whose frame is that of the map: they are not stitched, and the others are joined to them. If absent,
    /// these are the robots of a scenario without a `frame` of their own, and all robots of a log with latitudes and longitudes.
    /// If there are none, or the list is empty, the map has the frame of the first robot.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    pub known: Option<Vec<String>>,
}

impl Default for StitchConfig {
    fn default() -> Self {
        Self { mirrored: true, scaled: false, known: None }
    }
}

/// How the maps of several robots are stitched.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StitchRules {
    /// The robots in the frame of the map, if the settings name them.
    pub(super) known: Option<Vec<String>>,
    pub(super) mirrored: bool,
    pub(super) lengths: Lengths,
}

impl From<StitchConfig> for StitchRules {
    fn from(config: StitchConfig) -> Self {
        let lengths = if config.scaled { Lengths::Scaled } else { Lengths::Kept };
        Self { known: config.known, mirrored: config.mirrored, lengths }
    }
}
