//! Traffic as written in a scenario.

use std::path::PathBuf;
use std::time::Duration;

use serde::{Deserialize, Serialize};
use sextant_kernel::{Files, SettingError, SimTime};

use super::{Schedule, Traffic, trace};
use crate::world::layout::{NodesOfGroup, PlacedNode};

/// The nodes' traffic, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum TrafficConfig {
    /// The same as `periodic`: each node broadcasts a short frame once per interval, with its own phase. With a
    /// beacon-enabled MAC the frame waits for the next superframe whose beacon the node hears. An interval near the
    /// beacon interval gives about one frame per node in each superframe.
    Beacon(PeriodicConfig),
    /// The same as `once`: all nodes have one frame at the same instant, as if a robot had asked. With a beacon-enabled
    /// MAC each node sends it once, in the first superframe whose beacon it hears. For studies of contention; not
    /// enough for surveys.
    Query(OnceConfig),
    /// Each node has a frame once per interval, with its own phase.
    Periodic(PeriodicConfig),
    /// Each node has frames at random instants, independent of each other (a Poisson process).
    Poisson(PoissonConfig),
    /// Each node always has a frame to send: the next one as soon as the last one has ended.
    Saturated(SaturatedConfig),
    /// All nodes have one frame at the same instant.
    Once(OnceConfig),
    /// The frames of a table: which node has a frame of which size at which time.
    Trace(TraceConfig),
    /// Groups of nodes, each with its traffic; other nodes send nothing.
    Groups(Vec<GroupConfig>),
    /// Nothing.
    Silent(SilentConfig),
}

/// Periodic frames, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PeriodicConfig {
    /// Length of the frame, header and frame check sequence included (octets): 11 to 127.
    #[serde(default = "default_mpdu_octets")]
    #[cfg_attr(feature = "schema", schemars(range(min = 11, max = 127)))]
    pub mpdu_octets: u8,
    /// Mean time between two frames of a node (s).
    #[serde(default = "default_interval_s")]
    pub interval_s: f64,
    /// Each frame is early or late by up to this share of the interval, uniformly distributed: 0 to 0.5.
    #[serde(default = "default_jitter")]
    pub jitter: f64,
    /// Whether frames go to one robot or sink, which must acknowledge them; otherwise they are broadcast.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = false)))]
    pub acknowledged: bool,
    /// Name of the robot or sink to which acknowledged frames go; if absent, the first robot, or the nearest sink if
    /// there is no robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
}

impl PeriodicConfig {
    /// Frames to all of this length (octets), with this mean time between two (s) and this jitter.
    #[must_use]
    pub const fn each(mpdu_octets: u8, interval_s: f64, jitter: f64) -> Self {
        Self { mpdu_octets, interval_s, jitter, acknowledged: false, to: None }
    }
}

/// One frame per node, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct OnceConfig {
    /// Length of the frame, header and frame check sequence included (octets): 11 to 127.
    #[serde(default = "default_mpdu_octets")]
    #[cfg_attr(feature = "schema", schemars(range(min = 11, max = 127)))]
    pub mpdu_octets: u8,
    /// When all nodes get their frame (s).
    #[serde(default)]
    pub at_s: f64,
    /// Whether frames go to one robot or sink, which must acknowledge them; otherwise they are broadcast.
    #[serde(default)]
    pub acknowledged: bool,
    /// Name of the robot or sink to which acknowledged frames go; if absent, the first robot, or the nearest sink if
    /// there is no robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
}

/// Poisson arrivals, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct PoissonConfig {
    /// Length of the frame, header and frame check sequence included (octets): 11 to 127.
    #[serde(default = "default_mpdu_octets")]
    #[cfg_attr(feature = "schema", schemars(range(min = 11, max = 127)))]
    pub mpdu_octets: u8,
    /// Mean number of frames per second and node.
    pub rate_per_s: f64,
    /// Whether frames go to one robot or sink, which must acknowledge them; otherwise they are broadcast.
    #[serde(default)]
    pub acknowledged: bool,
    /// Name of the robot or sink to which acknowledged frames go; if absent, the first robot, or the nearest sink if
    /// there is no robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
}

/// Saturated nodes, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SaturatedConfig {
    /// Length of the frame, header and frame check sequence included (octets): 11 to 127.
    #[serde(default = "default_mpdu_octets")]
    #[cfg_attr(feature = "schema", schemars(range(min = 11, max = 127)))]
    pub mpdu_octets: u8,
    /// Whether frames go to one robot or sink, which must acknowledge them; otherwise they are broadcast.
    #[serde(default)]
    pub acknowledged: bool,
    /// Name of the robot or sink to which acknowledged frames go; if absent, the first robot, or the nearest sink if
    /// there is no robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
    /// Each node has its first frame at a random instant of the first so many seconds, to the nanosecond; 0.01 if absent,
    /// longer than any exchange of one frame at 2.4 GHz. With 0 all nodes start at once. Then, with exact clocks, all their
    /// instants stay on one grid for ever, of 32 us at 2.4 GHz: frames begin at the very instant at which other nodes end
    /// their carrier sense, which no real network does, and more of them collide.
    #[serde(default = "default_start_spread_s")]
    pub start_spread_s: f64,
}

/// Frames of a table, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TraceConfig {
    /// A CSV file with the columns `t_s`, `node` and `mpdu_octets`, in the order of time; its path is relative to the
    /// scenario's folder.
    pub file: PathBuf,
    /// Whether frames go to one robot or sink, which must acknowledge them; otherwise they are broadcast.
    #[serde(default)]
    pub acknowledged: bool,
    /// Name of the robot or sink to which acknowledged frames go; if absent, the first robot, or the nearest sink if
    /// there is no robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<String>,
}

/// A group of nodes and its traffic, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GroupConfig {
    /// Name of the group in results.
    pub name: String,
    /// Which nodes are in it; a node is in one group at most.
    pub nodes: NodesOfGroup,
    /// The traffic of each of its nodes: any kind but `groups`.
    pub traffic: Box<TrafficConfig>,
}

/// No traffic, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct SilentConfig {}

fn default_mpdu_octets() -> u8 {
    20
}

fn default_start_spread_s() -> f64 {
    0.01
}

fn default_interval_s() -> f64 {
    1.0
}

fn default_jitter() -> f64 {
    0.1
}

impl TrafficConfig {
    /// The files that it names, and the key of each.
    pub fn files_mut(&mut self) -> Vec<(String, &mut PathBuf)> {
        match self {
            Self::Trace(trace) => vec![("trace.file".to_owned(), &mut trace.file)],
            Self::Groups(groups) => (groups.iter_mut().enumerate())
                .flat_map(|(i, group)| {
                    let files = group.traffic.files_mut().into_iter();
                    files.map(move |(key, file)| (format!("groups[{i}].traffic.{key}"), file))
                })
                .collect(),
            _ => Vec::new(),
        }
    }

    /// Whether it names nodes, so that it cannot be checked without them.
    #[must_use]
    pub fn names_nodes(&self) -> bool {
        matches!(self, Self::Trace(_) | Self::Groups(_))
    }

    /// The key of its kind.
    fn key(&self) -> &'static str {
        match self {
            Self::Beacon(_) => "beacon",
            Self::Query(_) => "query",
            Self::Periodic(_) => "periodic",
            Self::Poisson(_) => "poisson",
            Self::Saturated(_) => "saturated",
            Self::Once(_) => "once",
            Self::Trace(_) => "trace",
            Self::Groups(_) => "groups",
            Self::Silent(_) => "silent",
        }
    }

    /// The traffic of each of `nodes`, with `key` as the table in which it stands; paths are among `files`.
    pub(super) fn traffic(&self, nodes: &[PlacedNode], files: &Files, table: &str) -> Result<Traffic, SettingError> {
        let key = self.key();
        let within = |error: SettingError| error.within(key);
        let traffic = |mpdu_octets, acknowledged: bool, to: &Option<String>, schedule| {
            if let (false, Some(name)) = (acknowledged, to) {
                let allowed = "`acknowledged = true` beside it, or no `to`: broadcasts go to all";
                return Err(SettingError::new(format!("{key}.to"), format!("`{name}`"), allowed));
            }
            let to = to.clone();
            Ok(Traffic { key: format!("{table}.{key}"), mpdu_octets, acknowledged, to, schedule })
        };
        match self {
            Self::Beacon(config) | Self::Periodic(config) => {
                let octets = octets(config.mpdu_octets).map_err(within)?;
                let interval_s =
                    SettingError::in_range("interval_s", config.interval_s, 1e-3, 1e6).map_err(within)?;
                let jitter = SettingError::in_range("jitter", config.jitter, 0.0, 0.5).map_err(within)?;
                let schedule = Schedule::Periodic { interval: Duration::from_secs_f64(interval_s), jitter };
                traffic(octets, config.acknowledged, &config.to, schedule)
            }
            Self::Query(config) | Self::Once(config) => {
                let octets = octets(config.mpdu_octets).map_err(within)?;
                let at_s = SettingError::in_range("at_s", config.at_s, 0.0, 1e6).map_err(within)?;
                let schedule = Schedule::Once { at: SimTime::ZERO + Duration::from_secs_f64(at_s) };
                traffic(octets, config.acknowledged, &config.to, schedule)
            }
            Self::Poisson(config) => {
                let octets = octets(config.mpdu_octets).map_err(within)?;
                let rate_per_s =
                    SettingError::in_range("rate_per_s", config.rate_per_s, 1e-6, 1e6).map_err(within)?;
                let schedule = Schedule::Poisson { mean_interval_s: 1.0 / rate_per_s };
                traffic(octets, config.acknowledged, &config.to, schedule)
            }
            Self::Saturated(config) => {
                let octets = octets(config.mpdu_octets).map_err(within)?;
                let spread_s =
                    SettingError::in_range("start_spread_s", config.start_spread_s, 0.0, 1e6).map_err(within)?;
                traffic(octets, config.acknowledged, &config.to, Schedule::Saturated { spread_s })
            }
            Self::Trace(config) => {
                let trace = trace::read(&config.file, nodes, files).map_err(within)?;
                traffic(trace.largest_octets(), config.acknowledged, &config.to, Schedule::Trace(trace.into()))
            }
            Self::Silent(_) => traffic(0, false, &None, Schedule::Silent),
            Self::Groups(_) => {
                Err(SettingError::new("groups", "groups within a group", "any other kind of traffic in a group"))
            }
        }
    }
}

fn octets(octets: u8) -> Result<u8, SettingError> {
    if (11..=127).contains(&octets) { Ok(octets) } else { Err(SettingError::new("mpdu_octets", octets, "11 to 127")) }
}
