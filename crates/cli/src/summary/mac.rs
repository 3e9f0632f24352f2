//! The traffic of nodes to sinks: packets, throughput, delays and energy, as a whole, by group and by node.

use serde::Serialize;

use super::gathering::EnergySummary;

/// The traffic in one network.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct MacSummary {
    /// Name of the network, if the scenario has several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub network: Option<String>,
    /// Time over which the rates are taken: from the start to the end of the simulation (s).
    pub duration_s: f64,
    /// All nodes together.
    #[serde(flatten)]
    pub all: TrafficSummary,
    /// Number of packets by delay.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub delay_histogram: Vec<DelayBin>,
    /// The sinks, and the robots if the network has any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sinks: Vec<SinkSummary>,
    /// The groups of nodes with traffic of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<NamedTraffic>,
    /// The nodes.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub nodes: Vec<NamedTraffic>,
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
/// `not_listened` and `pending`.
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
    /// Frames on air, retransmissions included; without acknowledgements.
    pub transmissions: u64,
    /// Retransmissions.
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
    /// Packets that were waiting or on air at the end.
    pub pending: u64,
    /// Energy of the radios.
    pub energy_j: EnergySummary,
}

/// Delays of packets (s).
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
    /// The summary of `delays_s`; `None` if there are none. A percentile is the least delay that this share of the
    /// packets does not exceed.
    #[must_use]
    pub fn of(mut delays_s: Vec<f64>) -> Option<Self> {
        delays_s.sort_unstable_by(f64::total_cmp);
        let count = delays_s.len();
        let at = |percent: usize| delays_s.get((percent * count).div_ceil(100).saturating_sub(1)).copied();
        Some(Self { mean: delays_s.iter().sum::<f64>() / count as f64, p50: at(50)?, p90: at(90)?, p99: at(99)? })
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

impl DelayBin {
    /// The histogram of `delays_s`: bins whose limits are 1, 2 and 5 times powers of ten, from the first to the last one
    /// that holds a packet.
    #[must_use]
    pub fn histogram(delays_s: &[f64]) -> Vec<Self> {
        let mut bins: Vec<Self> = LIMITS_S
            .windows(2)
            .map(|limits| {
                let (from_s, to_s) = (limits[0], limits[1]);
                let packets = delays_s.iter().filter(|&&delay_s| delay_s >= from_s && delay_s < to_s).count();
                Self { from_s, to_s, packets: packets as u64 }
            })
            .collect();
        while bins.last().is_some_and(|bin| bin.packets == 0) {
            bins.pop();
        }
        let first = bins.iter().position(|bin| bin.packets > 0).unwrap_or(0);
        bins.drain(..first);
        bins
    }
}

/// Limits of the bins of delays (s).
const LIMITS_S: [f64; 26] = [
    0.0,
    1e-4,
    2e-4,
    5e-4,
    1e-3,
    2e-3,
    5e-3,
    0.01,
    0.02,
    0.05,
    0.1,
    0.2,
    0.5,
    1.0,
    2.0,
    5.0,
    10.0,
    20.0,
    50.0,
    1e2,
    2e2,
    5e2,
    1e3,
    1e4,
    1e5,
    f64::MAX,
];

/// A sink, or a robot.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SinkSummary {
    /// Its name.
    pub name: String,
    /// Frames that it received, each once. With several sinks, several may receive the same broadcast.
    pub received: u64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_are_delays_that_occurred() {
        let delay = DelaySummary::of((1..=200).rev().map(f64::from).collect()).unwrap();
        assert_eq!(delay, DelaySummary { mean: 100.5, p50: 100.0, p90: 180.0, p99: 198.0 });
        let alone = DelaySummary { mean: 0.25, p50: 0.25, p90: 0.25, p99: 0.25 };
        assert_eq!(DelaySummary::of(vec![0.25]), Some(alone));
        assert_eq!(DelaySummary::of(Vec::new()), None);
    }

    #[test]
    fn a_histogram_holds_each_packet_once() {
        let bins = DelayBin::histogram(&[0.002, 0.0049, 0.005, 0.03]);
        let counts: Vec<_> = bins.iter().map(|bin| (bin.from_s, bin.packets)).collect();
        assert_eq!(counts, [(0.002, 2), (0.005, 1), (0.01, 0), (0.02, 1)]);
        assert_eq!(DelayBin::histogram(&[]), []);
    }
}
