//! The traffic of a run, as a summary.

use std::time::Duration;

use sextant_kernel::NodeId;
use sextant_mac::EnergySpent;
use sextant_sim::{BusyNetwork, NetworkRecord, Packets, Survey};

use crate::scenario::Scenario;
use crate::summary::{DelayBin, DelaySummary, EnergySummary, MacSummary, NamedTraffic, SinkSummary, TrafficSummary};

/// The traffic in each network of `scenario`, if it has sinks: otherwise the survey tells all.
pub(super) fn traffic(scenario: &Scenario, survey: &Survey) -> Vec<MacSummary> {
    if scenario.config().sinks.is_empty() {
        return Vec::new();
    }
    let networks = scenario.networks().iter().zip(&survey.networks);
    networks.map(|(network, record)| of_network(scenario, survey, network, record)).collect()
}

fn of_network(scenario: &Scenario, survey: &Survey, network: &BusyNetwork, record: &NetworkRecord) -> MacSummary {
    let nodes = &scenario.world().nodes;
    let duration_s = survey.end.as_secs_f64();
    let mut delays: Vec<Vec<f64>> = vec![Vec::new(); nodes.len()];
    for (station, delay) in &record.delays {
        if let Some(delays) = delays.get_mut(station.index()) {
            delays.push(Duration::as_secs_f64(delay));
        }
    }
    let of_nodes = |members: &[NodeId]| {
        let index = || members.iter().map(|node| node.index());
        let delays_s = index().flat_map(|node| delays[node].iter().copied()).collect();
        let mut energy = EnergySpent::default();
        index().for_each(|node| energy += record.energy[node]);
        let packets: Packets = index().map(|node| record.packets[node]).sum();
        summary(packets, energy, delays_s, duration_s)
    };
    let members: Vec<_> = (0..nodes.len()).map(NodeId::from_index).filter(|&node| network.has(node)).collect();
    let groups = network
        .traffic
        .named_groups()
        .map(|(name, members)| NamedTraffic { name: name.to_owned(), traffic: of_nodes(&members) });
    let by_node = members
        .iter()
        .map(|&node| NamedTraffic { name: nodes[node.index()].name.clone(), traffic: of_nodes(&[node]) });
    let collectors = (scenario.robots_of_survey().map(|robot| &robot.name))
        .chain(scenario.config().sinks.iter().map(|sink| &sink.name));
    let sinks = collectors.zip(&record.deliveries[nodes.len()..]);
    let all_delays: Vec<f64> = delays.iter().flatten().copied().collect();
    MacSummary {
        network: network.name.clone(),
        duration_s,
        all: of_nodes(&members),
        delay_histogram: DelayBin::histogram(&all_delays),
        sinks: sinks.map(|(name, &received)| SinkSummary { name: name.clone(), received }).collect(),
        groups: groups.collect(),
        nodes: by_node.collect(),
    }
}

fn summary(packets: Packets, energy: EnergySpent, delays_s: Vec<f64>, duration_s: f64) -> TrafficSummary {
    let share = |part: u64, whole: u64| (whole > 0).then(|| part as f64 / whole as f64);
    TrafficSummary {
        offered: packets.offered,
        sent: packets.sent,
        delivered: packets.received,
        prr: share(packets.received, packets.offered - packets.pending),
        delivered_of_sent: share(packets.received, packets.sent),
        throughput_bit_per_s: if duration_s > 0.0 { 8.0 * packets.octets_received as f64 / duration_s } else { 0.0 },
        delay_s: DelaySummary::of(delays_s),
        transmissions: packets.transmissions,
        retries: packets.transmissions - packets.sent,
        backoffs: packets.assessments,
        no_acknowledgement: packets.unacknowledged,
        channel_access_failures: packets.channel_access_failures,
        lost_collision: packets.lost_collision,
        lost_channel_access: packets.lost_channel_access,
        lost_queue: packets.lost_queue,
        lost_signal: packets.lost_signal,
        out_of_range: packets.out_of_range,
        not_listened: packets.not_listened,
        pending: packets.pending,
        energy_j: EnergySummary { tx: energy.tx_j, rx: energy.rx_j, idle: energy.idle_j + energy.sleep_j },
    }
}
