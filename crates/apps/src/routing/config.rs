//! Routing as written in a scenario.

use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use super::rpl::RplConfig;

/// How packets go over several hops, as written in a scenario. Nodes send them along a tree whose roots are the sinks, and
/// each hop is acknowledged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RoutingConfig {
    /// Along which tree packets go.
    pub tree: TreeConfig,
    /// Packets that a node can hold, its own and those of others: 1 to 1000. One that comes to a full queue is lost.
    #[serde(default = "default_queue_packets")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 1000)))]
    pub queue_packets: u16,
    /// A packet that the MAC could not bring to the next station is given to the MAC again, so many times at most: 0 to 255.
    /// With the usual 3 retries of the MAC and 7 here, a packet is sent at most 32 times over a hop.
    #[serde(default = "default_resends")]
    pub resends: u8,
    /// A link is usable if at least this share of the frames arrives in each direction: above 0, to 1. Trees of shortest
    /// ways are made of usable links, and the stretch compares ways with the shortest ones over usable links.
    #[serde(default = "default_usable_prr")]
    pub usable_prr: f64,
    /// Where the packets of nodes go: `sink`, `sink_and_back` or `nodes`.
    #[serde(default, skip_serializing_if = "RoutedTo::is_sink")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = "sink")))]
    pub to: RoutedTo,
    /// Packets that are larger than a frame, and go in fragments. Absent: a packet is one frame, of the size that the traffic has.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fragments: Option<FragmentsConfig>,
}

/// Packets in fragments (RFC 4944), as written in a scenario. Each fragment is a frame with its own tries on each hop, and each
/// station puts packets together before it sends them on.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct FragmentsConfig {
    /// Size of the packets of nodes, with their headers and without those of the MAC (octets): 40 to 1280. It replaces the size
    /// of the traffic.
    #[cfg_attr(feature = "schema", schemars(range(min = 40, max = 1280)))]
    pub packet_octets: u16,
    /// A packet that is not complete after this time is given up (s): 0.1 to 60.
    #[serde(default = "default_reassembly_s")]
    pub reassembly_s: f64,
    /// Packets that a station can put together at the same time: 1 to 255. A fragment of another one is lost.
    #[serde(default = "default_reassembly_buffers")]
    #[cfg_attr(feature = "schema", schemars(range(min = 1, max = 255)))]
    pub reassembly_buffers: u8,
}

fn default_reassembly_s() -> f64 {
    8.0
}

fn default_reassembly_buffers() -> u8 {
    2
}

/// Where the packets of nodes go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum RoutedTo {
    /// To a sink.
    #[default]
    Sink,
    /// To a sink, which answers each with a packet of the same size. It goes down along the parents that packets told.
    SinkAndBack,
    /// Each to a node that is drawn at random: up to a sink, and down from there. A node that is on the way up takes it there.
    Nodes,
}

impl RoutedTo {
    /// Whether packets go to a sink, and nowhere else.
    #[must_use]
    pub fn is_sink(&self) -> bool {
        *self == Self::Sink
    }

    /// Octets that the header of a packet needs beyond those of one to a sink: the parent of its origin, and a node.
    #[must_use]
    pub(super) const fn further_octets(self) -> u8 {
        match self {
            Self::Sink => 0,
            Self::SinkAndBack => 2,
            Self::Nodes => 4,
        }
    }
}

/// Along which tree packets go, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, rename_all = "snake_case")]
pub enum TreeConfig {
    /// The tree of a file.
    Given(GivenTreeConfig),
    /// The shortest ways over the links of the layout, worked out before the start: no frame is sent for that, and nothing
    /// changes later.
    Shortest(ShortestTreeConfig),
    /// The tree that the stations build and repair by beacons, as CTP does.
    Collection(CollectionConfig),
    /// The tree that the stations build and repair by RPL (RFC 6550).
    Rpl(RplConfig),
}

impl TreeConfig {
    /// Its name, which is its key.
    #[must_use]
    pub const fn name(&self) -> &'static str {
        match self {
            Self::Given(_) => "given",
            Self::Shortest(_) => "shortest",
            Self::Collection(_) => "collection",
            Self::Rpl(_) => "rpl",
        }
    }

    /// Whether the stations build it, so that it changes.
    #[must_use]
    pub const fn is_built(&self) -> bool {
        match self {
            Self::Given(_) | Self::Shortest(_) => false,
            Self::Collection(_) | Self::Rpl(_) => true,
        }
    }
}

/// A tree of a file, as written in a scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct GivenTreeConfig {
    /// A CSV file with the columns `node` and `parent`, a node or a sink; its path is relative to the scenario's folder. Each
    /// node has a row.
    pub file: PathBuf,
}

/// A tree of shortest ways, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct ShortestTreeConfig {
    /// What the shortest way has least of.
    pub metric: TreeMetric,
}

/// What the shortest way has least of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "snake_case")]
pub enum TreeMetric {
    /// Hops; among ways of as many hops, expected transmissions.
    #[default]
    Hops,
    /// Expected transmissions: of a link, one divided by the share of frames that arrive and by that of acknowledgements.
    Etx,
}

/// A tree that the stations build by beacons, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct CollectionConfig {
    /// Shortest interval of beacons (s), at the start and after a change; they double from there. At least 0.01.
    pub beacon_min_s: f64,
    /// Longest interval of beacons (s): not less than the shortest one.
    pub beacon_max_s: f64,
    /// A node changes its parent for another one by which a packet takes fewer transmissions by more than this number: 0 to
    /// 100.
    pub hysteresis_etx: f64,
}

impl Default for CollectionConfig {
    fn default() -> Self {
        Self { beacon_min_s: 0.128, beacon_max_s: 512.0, hysteresis_etx: 1.5 }
    }
}

fn default_queue_packets() -> u16 {
    12
}

fn default_resends() -> u8 {
    7
}

fn default_usable_prr() -> f64 {
    0.5
}
