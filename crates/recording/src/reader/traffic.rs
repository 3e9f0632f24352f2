//! What the summary in a recording says of the traffic.

use serde::Deserialize;

use super::run::RecordedRun;
use crate::messages::names::SUMMARY_ATTACHMENT;

/// The traffic in a network, as the summary counts it.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(default)]
pub struct RecordedTraffic {
    /// Name of the network, if it has one.
    pub network: Option<String>,
    /// The delays of the delivered packets.
    pub delay_histogram: Vec<RecordedDelays>,
    /// The packets by the node that offered them.
    pub nodes: Vec<RecordedOutcomes>,
}

/// Packets with a delay in a range.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize)]
pub struct RecordedDelays {
    /// Least delay (s).
    pub from_s: f64,
    /// The delay is less than this (s).
    pub to_s: f64,
    /// Number of packets.
    pub packets: u64,
}

/// What became of the packets of a node.
#[derive(Clone, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(default)]
pub struct RecordedOutcomes {
    /// Name of the node.
    pub name: String,
    /// Packets that were received.
    pub delivered: u64,
    /// Packets lost by collision.
    pub lost_collision: u64,
    /// Packets whose signal was too weak.
    pub lost_signal: u64,
    /// Packets sent while no receiver listened.
    pub not_listened: u64,
    /// Packets sent out of range.
    pub out_of_range: u64,
    /// Packets that never went on air because the channel was busy.
    pub lost_channel_access: u64,
    /// Packets that found the queue full.
    pub lost_queue: u64,
    /// Packets whose node died before they had an end.
    pub died: u64,
    /// Packets that were waiting or on air at the end.
    pub pending: u64,
}

impl RecordedRun {
    /// The traffic of each network, if the summary of the run has it: that of a run with sinks.
    #[must_use]
    pub fn traffic(&self) -> Vec<RecordedTraffic> {
        #[derive(Deserialize)]
        struct TrafficSummary {
            mac: Option<RecordedTraffic>,
            #[serde(default)]
            other_networks: Vec<RecordedTraffic>,
        }
        let summary = self.attachment(SUMMARY_ATTACHMENT).map(|attachment| &attachment.data);
        let summary = summary.and_then(|data| serde_json::from_slice::<TrafficSummary>(data).ok());
        let networks = summary.map(|summary| summary.mac.into_iter().chain(summary.other_networks).collect());
        networks.unwrap_or_default()
    }
}
