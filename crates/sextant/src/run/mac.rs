//! The traffic of a run, as a summary.

use sextant_kernel::{NodeId, SimTime};
use sextant_mac::EnergySpent;
use sextant_scenario::Scenario;
use sextant_sim::{Delays, Network, NetworkRecord, Packets, Survey};

use crate::summary::{
    DelayBin, DelaySummary, EnergySummary, MacSummary, NamedTraffic, NotListenedSummary, SinkSummary, TrafficSummary,
};

/// The traffic in each network of `scenario`, if it has sinks: otherwise the survey tells all.
pub(super) fn traffic(scenario: &Scenario, survey: &Survey) -> Vec<MacSummary> {
    if scenario.config().sinks.is_empty() {
        return Vec::new();
    }
    let networks = scenario.networks().iter().zip(&survey.networks);
    networks.map(|(network, record)| of_network(scenario, survey, network, record)).collect()
}

fn of_network(scenario: &Scenario, survey: &Survey, network: &Network, record: &NetworkRecord) -> MacSummary {
    let nodes = &scenario.world().nodes;
    let warm_up = scenario.warm_up();
    let duration_s = survey.end.saturating_since(SimTime::ZERO + warm_up).as_secs_f64();
    let of_nodes = |members: &[NodeId]| {
        let index = || members.iter().map(|node| node.index());
        let delays = delays(record, index());
        let mut energy = EnergySpent::default();
        index().for_each(|node| energy += record.energy[node]);
        let packets: Packets = index().map(|node| record.packets[node]).sum();
        summary(packets, energy, &delays, duration_s)
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
    let all_delays = delays(record, 0..nodes.len());
    MacSummary {
        network: network.name.clone(),
        duration_s,
        warm_up_s: (!warm_up.is_zero()).then_some(warm_up.as_secs_f64()),
        all: of_nodes(&members),
        delay_histogram: all_delays.histogram().into_iter().map(DelayBin::from).collect(),
        sinks: sinks.map(|(name, &received)| SinkSummary { name: name.clone(), received }).collect(),
        groups: groups.collect(),
        nodes: by_node.collect(),
    }
}

/// The delays of several stations together.
fn delays(record: &NetworkRecord, stations: impl Iterator<Item = usize>) -> Delays {
    let mut together = Delays::default();
    stations.filter_map(|station| record.delays.get(station)).for_each(|delays| together.merge(delays));
    together
}

fn summary(packets: Packets, energy: EnergySpent, delays: &Delays, duration_s: f64) -> TrafficSummary {
    let share = |part: u64, whole: u64| (whole > 0).then(|| part as f64 / whole as f64);
    TrafficSummary {
        offered: packets.offered,
        sent: packets.sent,
        delivered: packets.received,
        prr: share(packets.received, packets.offered - packets.pending),
        delivered_of_sent: share(packets.received, packets.sent),
        throughput_bit_per_s: if duration_s > 0.0 { 8.0 * packets.octets_received as f64 / duration_s } else { 0.0 },
        delay_s: DelaySummary::of(delays),
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
        not_listened_by: NotListenedSummary::from(&packets),
        pending: packets.pending,
        energy_j: EnergySummary { tx: energy.tx_j, rx: energy.rx_j, idle: energy.idle_j + energy.sleep_j },
    }
}
