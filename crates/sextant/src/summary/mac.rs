//! The traffic of nodes to sinks: packets, throughput, delays and energy, as a whole, by group and by node.

use serde::Serialize;
use sextant_sim::{DelayCount, Delays};

use super::gathering::{EnergySummary, NotListenedSummary, is_none};

/// The traffic in one network.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MacSummary {
    /// Name of the network, if the scenario has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// Time that is counted, over which rates are taken: from the start, or the end of the warm-up, to the end of the simulation
    /// (s).
    pub duration_s: f64,
    /// What was left out at the start (s). Absent if nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub warm_up_s: Option<f64>,
    /// All nodes together.
    #[serde(flatten)]
    pub all: TrafficSummary,
    /// What the stations did in their slots, if the network has any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub slots: Option<SlotSummary>,
    /// How the stations slept, if they sleep between checks of the channel.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sleep: Option<SleepSummary>,
    /// Number of packets by delay.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub delay_histogram: Vec<DelayBin>,
    /// The sinks, and the robots if the network has any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sinks: Vec<SinkSummary>,
    /// The groups of nodes, each with its traffic.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<NamedTraffic>,
    /// The nodes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<NamedTraffic>,
}

/// What the stations of a network with slots did in them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct SlotSummary {
    /// Nodes over which means are taken: without those that died before the end of the warm-up. Absent if it is all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counted_nodes: Option<usize>,
    /// Share of the time in which the radio of a node sent or listened, on average. Absent if no node lived after the warm-up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duty_cycle: Option<f64>,
    /// The same of a sink. Absent without sinks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sink_duty_cycle: Option<f64>,
    /// Slots in which a node listened and received nothing. All slots are those of all nodes together.
    pub idle_listen: u64,
    /// Slots in which a node sent to one station, which acknowledged it.
    pub transmit_acknowledged: u64,
    /// Slots in which a node sent to one station and no acknowledgement came.
    pub transmit_unacknowledged: u64,
    /// Slots in which a node sent to all, enhanced beacons included.
    pub transmit: u64,
    /// Slots in which a node received a frame and acknowledged it.
    pub receive_acknowledge: u64,
    /// Slots in which a node received a frame, or a part of one, without an acknowledgement of its own.
    pub receive: u64,
    /// Mean current of a node (A), if each slot took the published charge of its kind and all others nothing. Absent if a node
    /// scanned for the network.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_current_a: Option<f64>,
    /// Nodes that are in the network at the end.
    pub joined: usize,
    /// Nodes that joined by a scan, of those that all scanned at the start: `join_s` is of these. Absent if none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joined_by_scan: Option<usize>,
    /// How often nodes lost the network, because their clocks were not corrected for too long.
    pub lost: u64,
    /// Mean time from the start until a node joined (s), of those that scanned and joined. Absent if none did.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub join_s: Option<f64>,
    /// How nodes agreed on cells with their parents. Absent if they do not.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub negotiated: Option<NegotiatedSummary>,
}

/// How nodes agreed on cells in which they send.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct NegotiatedSummary {
    /// Mean number of these cells of a node, as long as it lived.
    pub mean_cells: f64,
    /// The same at the end, of nodes that are in the network then. Absent if none is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells: Option<f64>,
    /// Transactions of the 6top protocol that nodes began.
    pub transactions: u64,
    /// Those of them that failed: no response came, or one that says no.
    pub failures: u64,
    /// Cells that were relocated because they delivered too little.
    pub relocations: u64,
}

/// How the stations of a network slept that sleep between checks of the channel.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SleepSummary {
    /// Nodes over which means are taken: without those that died before the end of the warm-up. Absent if it is all of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub counted_nodes: Option<usize>,
    /// Share of the time in which the radio of a node was on: it sent, received or turned around. On average. This and what
    /// follows on one node are absent if no node lived after the warm-up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub duty_cycle: Option<f64>,
    /// The same of the node with the largest share.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_duty_cycle: Option<f64>,
    /// The name of that node.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_node: Option<String>,
    /// The same of a sink, on average. Absent without sinks.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sink_duty_cycle: Option<f64>,
    /// Checks of the channel by the schedules of all nodes.
    pub checks: u64,
    /// Frames that nodes sent to wake others: strobes, copies of a frame, wake-up frames.
    pub strobes: u64,
    /// The same for each packet that was sent. Absent if none was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub strobes_per_packet: Option<f64>,
    /// Mean power of a node (W), all states together.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_power_w: Option<f64>,
    /// Energy of all nodes asleep (J): a part of `energy_j.idle`.
    pub asleep_j: f64,
}

/// The traffic of a node or a group, with its name.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct NamedTraffic {
    /// The name.
    pub name: String,
    /// The traffic.
    #[serde(flatten)]
    pub traffic: TrafficSummary,
}

/// The traffic of some nodes. Each packet offered is in exactly one of `delivered`, the `lost_*`, `out_of_range`,
/// `not_listened`, `died` and `pending`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct TrafficSummary {
    /// Packets that applications gave to the MAC.
    pub offered: u64,
    /// Packets that went on air at least once.
    pub sent: u64,
    /// Packets that were received by the sink that they were for, or by any sink if they were for all. A packet counts
    /// once, even if several copies were received.
    pub delivered: u64,
    /// Packet reception ratio: delivered packets as a share of the packets offered, without those that are pending at the
    /// end. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prr: Option<f64>,
    /// Delivered packets as a share of the packets that went on air. Absent if there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delivered_of_sent: Option<f64>,
    /// Payload delivered per second (bit/s), without headers.
    pub throughput_bit_per_s: f64,
    /// Time from the offer of a packet to the end of its first reception (s). Absent if nothing was delivered.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub delay_s: Option<DelaySummary>,
    /// Transmissions of packets, retries included: data frames on air, or sweeps of sectors. Strobes, copies and wake-up frames are
    /// none.
    pub transmissions: u64,
    /// Transmissions of a packet after its first one.
    pub retries: u64,
    /// Backoffs, each followed by a clear channel assessment.
    pub backoffs: u64,
    /// Packets sent as often as allowed without an acknowledgement, whether they were received or not.
    pub no_acknowledgement: u64,
    /// Packets given up because the channel was busy too often, whether they had been on air before or not.
    pub channel_access_failures: u64,
    /// Packets lost by collision.
    pub lost_collision: u64,
    /// Packets that never went on air because the channel was busy too often.
    pub lost_channel_access: u64,
    /// Packets that found the transmit queue full.
    pub lost_queue: u64,
    /// Packets whose signal was too weak.
    pub lost_signal: u64,
    /// Packets sent out of range of all sinks.
    pub out_of_range: u64,
    /// Packets sent while no sink listened.
    pub not_listened: u64,
    /// The same by the reason why it did not.
    pub not_listened_by: NotListenedSummary,
    /// Packets that were waiting or on air when their node died. Absent if there are none.
    #[serde(skip_serializing_if = "is_none")]
    pub died: u64,
    /// Packets that were waiting or on air at the end.
    pub pending: u64,
    /// Energy of the radios.
    pub energy_j: EnergySummary,
}

/// Delays of packets (s). Percentiles are exact for up to 1024 packets of a node, and up to 65536 of several nodes none of
/// which has more than 1024; beyond, they are within 0.2 %.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DelaySummary {
    /// Mean (s).
    pub mean: f64,
    /// Median (s).
    pub p50: f64,
    /// 90th percentile (s).
    pub p90: f64,
    /// 99th percentile (s).
    pub p99: f64,
}

impl DelaySummary {
    /// The summary of these delays; `None` if there are none. A percentile is the least delay that this share of the packets
    /// does not exceed: exact for few packets, within 0.2 % for many ([`Delays`]).
    #[must_use]
    pub fn of(delays: &Delays) -> Option<Self> {
        let [p50, p90, p99] = delays.percentiles_s([50, 90, 99])?;
        Some(Self { mean: delays.mean_s()?, p50, p90, p99 })
    }
}

/// Packets with a delay in a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct DelayBin {
    /// Least delay (s).
    pub from_s: f64,
    /// The delay is less than this (s).
    pub to_s: f64,
    /// Number of packets.
    pub packets: u64,
}

impl From<DelayCount> for DelayBin {
    fn from(count: DelayCount) -> Self {
        let DelayCount { from_s, to_s, packets } = count;
        Self { from_s, to_s, packets }
    }
}

/// A sink, or a robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SinkSummary {
    /// Its name.
    pub name: String,
    /// Frames that it received, each once. With several sinks, several may receive the same broadcast.
    pub received: u64,
    /// The packets that it sent itself, over one hop each, beacons among them. Absent if it sent none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sent: Option<TrafficSummary>,
}
