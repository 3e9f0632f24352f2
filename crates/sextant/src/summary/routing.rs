//! Packets that go over several hops: delivery, delay, ways, and the tree.

use serde::Serialize;

use super::battery::LifetimeSummary;
use super::gathering::is_none;
use super::mac::DelaySummary;
use super::rpl::{FragmentsSummary, RplSummary};

/// Packets that went over several hops, and their tree.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RoutingSummary {
    /// Where the tree comes from: `given`, `shortest`, `collection` or `rpl`.
    pub tree: &'static str,
    /// Where packets go: `sink_and_back` or `nodes`. Absent if only to a sink.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub to: Option<&'static str>,
    /// Packets that nodes had for a sink, or for each other.
    pub offered: u64,
    /// Those that reached a sink, or the node to which they went, each once.
    pub delivered: u64,
    /// Those that did not, and wait in a queue at the end.
    pub pending: u64,
    /// Those that did not, and waited in the queue of a node that died. Absent if there are none.
    #[serde(skip_serializing_if = "is_none")]
    pub died: u64,
    /// All others: `offered` is the sum of these four.
    pub lost: u64,
    /// Delivered packets as a share of those offered, without those that are pending. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delivery: Option<f64>,
    /// Time from the offer of a packet to its arrival at the sink (s). Absent if none arrived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<DelaySummary>,
    /// Hops of packets that arrived. Absent if none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hops: Option<HopsSummary>,
    /// Mean of the hops of a packet that arrived, divided by those of the shortest way over usable links of the layout at the
    /// start. Absent if there is none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stretch: Option<f64>,
    /// Frames with packets on air on all hops, retries included. These and what follows, to `no_route`, are of packets that were
    /// offered after the warm-up.
    pub transmissions: u64,
    /// The same for each packet that arrived. Absent if none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub transmissions_per_delivery: Option<f64>,
    /// Copies of packets, because an acknowledgement was lost, that stations dropped.
    pub duplicates: u64,
    /// How often a packet came to a node again after more hops: along a loop, or as a copy by a longer way. It was sent on, so a
    /// packet in a loop counts with each round.
    pub loops: u64,
    /// Packets that found a queue full.
    pub queue_drops: u64,
    /// Packets that were given up on a hop, after all tries of the MAC and of the queue. Some of them have arrived, if only the
    /// acknowledgements were lost.
    pub given_up: u64,
    /// Packets that were dropped after 64 hops.
    pub hop_limit_drops: u64,
    /// Packets that a sink, or a node of RPL, dropped because it knew no way down, or the header had no room for it. Absent if none go down.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_route: Option<u64>,
    /// The answers of the sinks. Absent if they do not answer.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub answers: Option<AnswersSummary>,
    /// Beacons; in a tree of RPL, DIOs to all.
    pub beacons: u64,
    /// What a tree of RPL took. Absent with another tree.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rpl: Option<RplSummary>,
    /// Packets in fragments. Absent if none are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fragments: Option<FragmentsSummary>,
    /// Changes of the parent of a node, after its first one, warm-up included.
    pub parent_changes: u64,
    /// The same per node and hour of its life.
    pub parent_changes_per_node_h: f64,
    /// Living nodes without a way over living ones to a sink at the end.
    pub without_way: usize,
    /// Most hops along the parents at the end, of a living node with a way over living ones to a sink.
    pub depth: u32,
    /// The nodes by their depth in the tree at the end; dead ones where they were when they died.
    pub by_depth: Vec<DepthSummary>,
    /// The nodes.
    pub nodes: Vec<RoutedNodeSummary>,
}

/// The answers of the sinks to the packets that reached them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct AnswersSummary {
    /// Answers that sinks had for nodes.
    pub offered: u64,
    /// Those that reached their node, each once.
    pub delivered: u64,
    /// Those that did not, and wait in a queue at the end.
    pub pending: u64,
    /// Those that did not, and waited in the queue of a node that died. Absent if there are none.
    #[serde(skip_serializing_if = "is_none")]
    pub died: u64,
    /// All others: `offered` is the sum of these four.
    pub lost: u64,
    /// Delivered answers as a share of those offered, without those that are pending. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delivery: Option<f64>,
    /// Time from the offer of an answer to its arrival at the node (s). Absent if none arrived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<DelaySummary>,
    /// Hops of answers that arrived. Absent if none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hops: Option<HopsSummary>,
}

/// Hops of packets.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct HopsSummary {
    /// Mean.
    pub mean: f64,
    /// Most.
    pub max: u8,
}

/// The nodes that are so many hops from a sink along the parents at the end, or those without parents that lead there. A node
/// that died counts where it was then.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DepthSummary {
    /// Hops. Absent for nodes whose parents lead to no sink.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<u32>,
    /// Number of nodes.
    pub nodes: usize,
    /// Those of them that live at the end, with a way over living ones to a sink. Absent if it is all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub with_way: Option<usize>,
    /// Their packets.
    pub offered: u64,
    /// Those that reached a sink.
    pub delivered: u64,
    /// Delivered packets as a share of those offered, without those that are pending. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delivery: Option<f64>,
    /// Mean time from the offer of a packet to its arrival (s). Absent if none arrived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<f64>,
    /// Nodes over which energies are taken: without those that died before the end of the warm-up. Absent if it is all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counted_nodes: Option<usize>,
    /// Mean energy of the radio of a node (J).
    pub energy_j: f64,
    /// Mean energy of the radio of a node for transmitting (J).
    pub energy_tx_j: f64,
    /// Those whose battery is empty at the end. Absent without batteries.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depleted: Option<usize>,
    /// How long they last, from a full battery. Absent without batteries, or if none has a load.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lifetime_d: Option<LifetimeSummary>,
}

/// A node.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct RoutedNodeSummary {
    /// Its name.
    pub name: String,
    /// Name of its parent at the end. Absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
    /// Hops to a sink along the parents at the end. Absent without a way.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub depth: Option<u32>,
    /// Hops of the shortest way over usable links of the layout at the start. Absent without one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shortest_hops: Option<u32>,
    /// Packets that it had for a sink.
    pub offered: u64,
    /// Those that reached a sink.
    pub delivered: u64,
    /// Mean time from the offer of a packet to its arrival (s). Absent if none arrived.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<f64>,
    /// Frames with packets on air that it sent, for itself and for others.
    pub transmissions: u64,
    /// Changes of its parent after the first one.
    pub parent_changes: u64,
    /// Energy of its radio (J).
    pub energy_j: f64,
}
