//! One of several networks, as written in a scenario.

use serde::{Deserialize, Serialize};
use sextant_channel::{ChannelConfig, RangingDeviceConfig};
use sextant_mac::EnergyConfig;
use sextant_sim::{
    AntennasConfig, LinkTraceConfig, MacConfig, NodesOfGroup, RadioConfig, ReceptionConfig, TrafficConfig,
};

/// One of several networks, as written in a scenario. A table that is absent is that of the scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct NetworkConfig {
    /// Which nodes are in it; all if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nodes: Option<NodesOfGroup>,
    /// The radios.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radio: Option<RadioConfig>,
    /// What happens to radio power on its way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub channel: Option<ChannelConfig>,
    /// Its links as they were measured; those of the scenario if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link_trace: Option<LinkTraceConfig>,
    /// How nodes share the channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mac: Option<MacConfig>,
    /// What the nodes send, and when.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub traffic: Option<TrafficConfig>,
    /// When a frame that arrives is received.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reception: Option<ReceptionConfig>,
    /// How robots measure the ranges to its nodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ranging: Option<RangingDeviceConfig>,
    /// The antennas, with sector sweeps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub antenna: Option<AntennasConfig>,
    /// The radio chip whose energy is counted; that of the scenario, or else one of the band of the radios, if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub energy: Option<EnergyConfig>,
}
