//! A scenario as written in its file.

pub(crate) mod detail;
pub(crate) mod files;
pub(crate) mod network;
pub(crate) mod simulation;
pub(crate) mod snapshots;
pub(crate) mod team;

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use sextant_apps::distributed::DistributedMappingConfig;
use sextant_apps::routing::RoutingConfig;
use sextant_apps::{ControllerConfig, MissionConfig};
use sextant_channel::{ChannelConfig, RangingDeviceConfig};
use sextant_kernel::SettingError;
use sextant_mac::EnergyConfig;
use sextant_mapper::{MapConfig, NodeDisplacement};
use sextant_sim::{
    AnchorsConfig, AntennasConfig, BatteryConfig, DiscoveryConfig, FaultsConfig, InterfererConfig, LinkTraceConfig,
    MacConfig, RadioConfig, ReceptionConfig, RobotConfig, RoleConfig, SensorsConfig, SinkConfig, TrafficConfig,
    WorldConfig,
};

use super::SweepConfig;
use detail::DetailConfig;
use network::NetworkConfig;
use simulation::SimulationConfig;
use snapshots::SnapshotsConfig;
use team::TeamConfig;

/// A scenario: the world, the radios, the robots, and the maps to compute. Lengths are in metres, times in seconds and
/// powers in dBm; a key with a unit ends in it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ScenarioConfig {
    /// Name of the scenario, in tables and recordings.
    pub name: String,
    /// Random seed: the same seed gives the same results.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// The nodes, the obstacles, and what nodes can sense.
    pub world: WorldConfig,
    /// The sensors of the nodes; they sense nothing if absent.
    #[serde(default)]
    pub sensors: SensorsConfig,
    /// The radios of all stations; required unless each of `networks` has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radio: Option<RadioConfig>,
    /// Path loss, shadowing and fading of the radio channel; suburban, without a maximum range, if absent.
    #[serde(default)]
    pub channel: ChannelConfig,
    /// The links between nodes and sinks as they were measured; they follow `channel` if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub link_trace: Option<LinkTraceConfig>,
    /// How nodes share the channel; unslotted CSMA-CA as in the standard if absent.
    #[serde(default)]
    pub mac: MacConfig,
    /// What the nodes send, and when; required unless each of `networks` has its own, or the nodes compute a map.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub traffic: Option<TrafficConfig>,
    /// How packets go over several hops to the sinks; nodes send to those that hear them if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub routing: Option<RoutingConfig>,
    /// Which frames are received; those with an SINR of at least 3 dB if absent, with sector sweeps those with a ratio of
    /// signal to interference of at least 3 dB.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reception: Option<ReceptionConfig>,
    /// How robots measure the ranges to nodes; they do not if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ranging: Option<RangingDeviceConfig>,
    /// The antennas of a network with sector sweeps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub antenna: Option<AntennasConfig>,
    /// The radio chip whose energy is counted. If absent, one of the band of the radios: `cc2420` at 2.4 GHz, `at86rf212b` at
    /// 868 and 915 MHz, `mmwave_60_ghz` with sector sweeps.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub energy: Option<EnergyConfig>,
    /// The batteries of the nodes, which die when they are empty; nodes never do if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub battery: Option<BatteryConfig>,
    /// Several networks by name, each with tables `radio`, `channel`, `link_trace`, `mac`, `traffic`, `reception`, `ranging`,
    /// `antenna` and `energy` of its own; one network with the tables of the scenario if absent.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub networks: BTreeMap<String, NetworkConfig>,
    /// When the simulation ends (s); if absent, when the last robot has finished and the nodes have computed their map.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub duration_s: Option<f64>,
    /// What happens in the first so many seconds is simulated and left out of the counts of packets, of the rates taken from
    /// them and of the energy: packets count that are offered later. Less than `duration_s`; nothing is left out if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warm_up_s: Option<f64>,
    /// Which part of the nodes' traffic is simulated.
    #[serde(default, skip_serializing_if = "SimulationConfig::is_default")]
    pub simulation: SimulationConfig,
    /// Sources of noise that disturb the networks of IEEE 802.15.4, also during neighbour discovery.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub interferers: Vec<InterfererConfig>,
    /// The fixed sinks, which always listen.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub sinks: Vec<SinkConfig>,
    /// The robots that drive and listen.
    #[serde(default)]
    pub robots: Vec<RobotConfig<ControllerConfig>>,
    /// Robots that are alike and divide a region among them, in addition to `robots`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub team: Option<TeamConfig>,
    /// The nodes that know their position, for maps that need them; a random fifth of the nodes if absent.
    #[serde(default)]
    pub anchors: AnchorsConfig,
    /// What goes wrong: lost frames, nodes that die, anchors that lie; nothing if absent.
    #[serde(default, skip_serializing_if = "is_faultless")]
    pub faults: FaultsConfig,
    /// How the nodes discover their neighbours, for maps that need it.
    #[serde(default)]
    pub discovery: DiscoveryConfig,
    /// The maps to compute from the receptions.
    #[serde(default)]
    pub maps: Vec<MapConfig>,
    /// A map that the nodes compute themselves, from messages among them; none if absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub distributed_mapping: Option<DistributedMappingConfig>,
    /// What robots and nodes do on a map of the nodes, one after the other: each is a separate simulation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = [])))]
    pub applications: Vec<MissionConfig>,
    /// How maps are compared with the truth.
    #[serde(default)]
    pub metrics: MetricsConfig,
    /// What is recorded in addition to what a mapper needs.
    #[serde(default)]
    pub recording: RecordingConfig,
    /// The settings that a sweep varies; `run` ignores this table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<SweepConfig>,
}

impl ScenarioConfig {
    /// Whether there is a phase before the applications: robots survey or tell their place, nodes compute a map, traffic
    /// is studied for a time, or maps are computed.
    #[must_use]
    pub fn has_survey(&self) -> bool {
        self.has_traffic() || self.distributed_mapping.is_some() || !self.maps.is_empty()
    }

    /// The table of a robot, by number: `robots[0]`, or `team` for those of the team, which come last.
    #[must_use]
    pub fn table_of_robot(&self, number: usize) -> String {
        let of_team = self.team.as_ref().map_or(0, |team| team.robots as usize);
        if number < self.robots.len().saturating_sub(of_team) {
            format!("robots[{number}]")
        } else {
            "team".to_owned()
        }
    }

    /// Whether nodes send the traffic of their networks: to robots, or for a time.
    #[must_use]
    pub fn has_traffic(&self) -> bool {
        let takes_part = |robot: &RobotConfig<ControllerConfig>| robot.role != RoleConfig::Agent;
        self.duration_s.is_some() || self.robots.iter().any(takes_part)
    }
}

fn is_faultless(faults: &FaultsConfig) -> bool {
    *faults == FaultsConfig::default()
}

fn default_seed() -> u64 {
    1
}

/// How maps are compared with the truth, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct MetricsConfig {
    /// Radii of the neighbourhood for the connectivity error (m). The printed table shows the first one.
    pub neighbourhood_m: Vec<f64>,
    /// Nodes within this distance on the ground are neighbours for the sector displacement (m).
    pub sector_neighbourhood_m: f64,
    /// The sector displacement of a node from those to its neighbours.
    pub sector_displacement_of_node: NodeDisplacement,
    /// Nodes within this distance are neighbours for `near_scattering`, the share of them that a map of nodes has farther
    /// away (m).
    pub scattering_neighbourhood_m: f64,
}

impl Default for MetricsConfig {
    fn default() -> Self {
        Self {
            neighbourhood_m: vec![5.0, 3.0, 10.0],
            sector_neighbourhood_m: 1.6,
            sector_displacement_of_node: NodeDisplacement::default(),
            scattering_neighbourhood_m: 2.0,
        }
    }
}

impl MetricsConfig {
    /// Rejects radii that are not positive.
    pub(crate) fn check(&self) -> Result<(), SettingError> {
        for (i, &radius_m) in self.neighbourhood_m.iter().enumerate() {
            SettingError::positive(&format!("neighbourhood_m[{i}]"), radius_m)?;
        }
        SettingError::positive("sector_neighbourhood_m", self.sector_neighbourhood_m)?;
        SettingError::positive("scattering_neighbourhood_m", self.scattering_neighbourhood_m)?;
        Ok(())
    }
}

/// What is recorded in addition to what a mapper needs, as written in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct RecordingConfig {
    /// How much is recorded. If absent: `full` for at most 20000 nodes, `compact` for more.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detail: Option<DetailConfig>,
    /// Whether every frame is recorded.
    pub frames: bool,
    /// Whether every packet is recorded: when it was offered, each assessment of the channel and each transmission with its
    /// outcome, and what became of it.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub packets: bool,
    /// Names of the nodes whose likelihood is recorded, for each map that has one.
    pub likelihood: Vec<String>,
    /// Snapshots of the fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fields: Option<SnapshotsConfig>,
    /// Maps of the log as it grew, for each map that uses what robots heard: at this many instants before the end, with equal
    /// numbers of stops between them. Each takes about as long as the map itself. 0 for none, at most 100. If absent: 4 for maps
    /// that take at most about a second, otherwise none.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(range(min = 0, max = 100)))]
    pub map_snapshots: Option<u32>,
    /// What `--pcap` writes.
    pub pcap: PcapConfig,
}

/// Snapshots of a map that are recorded if the scenario does not say how many.
const USUAL_MAP_SNAPSHOTS: u32 = 4;
/// Maps with more elementary operations have no snapshots then.
const MOST_OPERATIONS: f64 = 1e9;
/// Allowed numbers of snapshots of a map.
const MAP_SNAPSHOTS: RangeInclusive<u32> = 0..=100;

impl RecordingConfig {
    /// Rejects more snapshots than can be wanted.
    pub(crate) fn check(&self) -> Result<(), SettingError> {
        match self.map_snapshots.filter(|snapshots| !MAP_SNAPSHOTS.contains(snapshots)) {
            Some(snapshots) => Err(SettingError::new("map_snapshots", snapshots, "0 to 100")),
            None => Ok(()),
        }
    }

    /// How much is recorded of a world with so many nodes.
    #[must_use]
    pub fn detail_of(&self, nodes: usize) -> DetailConfig {
        self.detail.unwrap_or(DetailConfig::usual(nodes))
    }

    /// Number of snapshots of a map that takes so many elementary operations.
    #[must_use]
    pub fn snapshots_of_map(&self, operations: f64) -> u32 {
        let usual = if operations <= MOST_OPERATIONS { USUAL_MAP_SNAPSHOTS } else { 0 };
        self.map_snapshots.unwrap_or(usual)
    }
}

/// What `--pcap` writes, as written in a scenario.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct PcapConfig {
    /// Name of a robot: only the frames that it receives are written, with their strength and quality. All frames on air
    /// if absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub robot: Option<String>,
    /// The channel number in the capture, 11 to 26 (2.4 GHz), instead of that of the radios. It has no effect on the
    /// simulation.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(range(min = 11, max = 26)))]
    pub channel: Option<u8>,
}

/// Radio channels at 2.4 GHz (IEEE 802.15.4-2006, 6.1.2.1).
const CHANNELS_2450: RangeInclusive<u8> = 11..=26;

impl PcapConfig {
    /// Rejects channels of other bands and unknown robots.
    pub(crate) fn check(&self, robots: &[RobotConfig<ControllerConfig>]) -> Result<(), SettingError> {
        if let Some(channel) = self.channel.filter(|channel| !CHANNELS_2450.contains(channel)) {
            return Err(SettingError::new("channel", channel, "11 to 26"));
        }
        match &self.robot {
            Some(name) if !robots.iter().any(|robot| robot.name == *name) => {
                Err(SettingError::new("robot", format!("`{name}`"), "the name of a robot"))
            }
            _ => Ok(()),
        }
    }
}
