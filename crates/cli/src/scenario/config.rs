//! A scenario as written: the whole of the file.

use std::ops::RangeInclusive;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_apps::ControllerConfig;
use sextant_channel::ChannelConfig;
use sextant_kernel::SettingError;
use sextant_mac::EnergyConfig;
use sextant_mapper::MapConfig;
use sextant_sim::{
    AnchorsConfig, DiscoveryConfig, MacConfig, RadioConfig, ReceptionConfig, RobotConfig, TrafficConfig, WorldConfig,
};

use super::SweepConfig;

/// A scenario: the world, the radios, what the robots do in it, and which maps are made of what they hear.
/// Lengths are in metres, times in seconds, powers in dBm; each key says so.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ScenarioConfig {
    /// Name of the scenario, in tables and recordings.
    pub name: String,
    /// Seed of all randomness: the same seed gives the same results.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// The nodes, and what stands in the way of radio and robots.
    pub world: WorldConfig,
    /// The radios of nodes and robots.
    pub radio: RadioConfig,
    /// What happens to radio power on its way; suburban, without a hard radius, if absent.
    #[serde(default)]
    pub channel: ChannelConfig,
    /// How nodes share the channel; unslotted CSMA-CA as in the standard if absent.
    #[serde(default)]
    pub mac: MacConfig,
    /// What the nodes send, and when.
    pub traffic: TrafficConfig,
    /// When a frame that arrives is received; a threshold of 3 dB if absent.
    #[serde(default)]
    pub reception: ReceptionConfig,
    /// The radio chip whose energy is counted.
    #[serde(default)]
    pub energy: EnergyConfig,
    /// The robots that drive and listen: at least one.
    pub robots: Vec<RobotConfig<ControllerConfig>>,
    /// The nodes that know their place, for maps that need such nodes; a fifth of the nodes, at random, if absent.
    #[serde(default)]
    pub anchors: AnchorsConfig,
    /// How the nodes find out whom they hear, for maps that need to know.
    #[serde(default)]
    pub discovery: DiscoveryConfig,
    /// The maps to compute from what was heard.
    #[serde(default)]
    pub maps: Vec<MapConfig>,
    /// How maps are compared with the truth.
    #[serde(default)]
    pub metrics: MetricsConfig,
    /// What is recorded beside what a mapper needs.
    #[serde(default)]
    pub recording: RecordingConfig,
    /// Which settings a sweep varies; `run` leaves them as they are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepConfig>,
}

fn default_seed() -> u64 {
    1
}

/// How maps are compared with the truth, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct MetricsConfig {
    /// Radii of the neighbourhood of the connectivity error (m); the first one goes into the table.
    pub neighbourhood_m: Vec<f64>,
}

impl Default for MetricsConfig {
    fn default() -> Self {
        Self { neighbourhood_m: vec![5.0, 3.0, 10.0] }
    }
}

impl MetricsConfig {
    /// Rejects radii that are not positive.
    pub(crate) fn check(&self) -> Result<(), SettingError> {
        for (i, &radius_m) in self.neighbourhood_m.iter().enumerate() {
            SettingError::positive(&format!("neighbourhood_m[{i}]"), radius_m)?;
        }
        Ok(())
    }
}

/// What is recorded beside what a mapper needs, as written in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct RecordingConfig {
    /// Whether every frame on air is recorded.
    pub frames: bool,
    /// Names of the nodes whose likelihood surface is recorded, for each map that has one.
    pub likelihood: Vec<String>,
    /// What `--pcap` writes.
    pub pcap: PcapConfig,
}

/// What `--pcap` writes, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
pub struct PcapConfig {
    /// Name of the robot whose received frames are written, with their strength and quality; all frames on air if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// Radio channel that the capture names, at 2.4 GHz: 11 to 26. It changes nothing else.
    pub channel: u8,
}

impl Default for PcapConfig {
    fn default() -> Self {
        Self { robot: None, channel: *CHANNELS_2450.start() }
    }
}

/// Radio channels at 2.4 GHz (IEEE 802.15.4-2006, 6.1.2.1).
const CHANNELS_2450: RangeInclusive<u8> = 11..=26;

impl PcapConfig {
    /// Refuses channels of other bands and robots that are not there.
    pub(crate) fn check(&self, robots: &[RobotConfig<ControllerConfig>]) -> Result<(), SettingError> {
        if !CHANNELS_2450.contains(&self.channel) {
            return Err(SettingError::new("channel", self.channel, "11 to 26"));
        }
        match &self.robot {
            Some(name) if !robots.iter().any(|robot| robot.name == *name) => {
                Err(SettingError::new("robot", format!("`{name}`"), "the name of a robot"))
            }
            _ => Ok(()),
        }
    }
}
