//! Settings of beams that follow, as written in a scenario.

use serde::{Deserialize, Serialize};
use sextant_channel::Position;

/// Settings of a robot that keeps a link of IEEE 802.11ad while it drives, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct BeamTrackingConfig {
    /// The places to which each robot drives, one after the other, by its odometry (m). It ends at the last one.
    pub way_m: Vec<Position>,
    /// Length of a beacon interval (ms): 1 to 1000.
    #[serde(default = "hundred_tu", skip_serializing_if = "is_hundred_tu")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = 102.4)))]
    pub beacon_interval_ms: f64,
    /// When the beam is trained.
    pub retrain: RetrainConfig,
    /// Whether a training ends with a refinement: a BRP frame tests the four best sectors of the robot while the node
    /// points its own.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = false)))]
    pub refine: bool,
}

fn hundred_tu() -> f64 {
    102.4
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_hundred_tu(ms: &f64) -> bool {
    ms.to_bits() == hundred_tu().to_bits()
}

/// When a beam is trained, as written in a scenario. If the last training found no node, the next beacon
/// interval has one again.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RetrainConfig {
    /// With all sectors, in every beacon interval of this number.
    Every(u32),
    /// With all sectors, when the link has become worse.
    OnFall(OnFallConfig),
    /// With the sectors round the one that points to the node on the map, when that becomes another one or the link has
    /// become worse; with all sectors if that does not help.
    Predicted(PredictedConfig),
}

/// Training after a fall, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct OnFallConfig {
    /// How much worse than at best since the last training the link must be (dB).
    #[serde(default = "three_db")]
    pub margin_db: f64,
}

/// Training by a map, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PredictedConfig {
    /// Number of sectors that are swept: those with the greatest gain towards the node. With 1, the robot points
    /// without a choice.
    #[serde(default = "four_sectors")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 64)))]
    pub sectors: u8,
    /// How much worse than at best since the last training the link must be (dB).
    #[serde(default = "three_db")]
    pub margin_db: f64,
}

fn four_sectors() -> u8 {
    4
}

fn three_db() -> f64 {
    3.0
}
