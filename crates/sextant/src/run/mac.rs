//! The traffic of a run, as a summary.

use sextant_kernel::{NodeId, SimTime};
use sextant_mac::EnergySpent;
use sextant_mac::tsch::{MsfUse, SlotCounts, SlotKind};
use sextant_scenario::Scenario;
use sextant_sim::layout::PlacedNode;
use sextant_sim::{Delays, Network, NetworkRecord, Packets, SleepUse, SlotUse, Survey};

use crate::summary::{
    DelayBin, DelaySummary, EnergySummary, MacSummary, NamedTraffic, NegotiatedSummary, NotListenedSummary,
    SinkSummary, SleepSummary, SlotSummary, TrafficSummary,
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
    let of_stations = |stations: &[usize]| {
        let index = || stations.iter().copied();
        let delays = delays(record, index());
        let mut energy = EnergySpent::default();
        index().for_each(|station| energy += record.energy[station]);
        let packets: Packets = index().map(|station| record.packets[station]).sum();
        summary(packets, energy, &delays, duration_s)
    };
    let of_nodes = |members: &[NodeId]| {
        let stations: Vec<usize> = members.iter().map(|node| node.index()).collect();
        of_stations(&stations)
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
    let sinks = collectors.zip(nodes.len()..record.deliveries.len()).map(|(name, station)| SinkSummary {
        name: name.clone(),
        received: record.deliveries[station],
        sent: (record.packets[station].offered > 0).then(|| of_stations(&[station])),
    });
    let all_delays = delays(record, 0..nodes.len());
    MacSummary {
        network: network.name.clone(),
        duration_s,
        warm_up_s: (!warm_up.is_zero()).then_some(warm_up.as_secs_f64()),
        all: of_nodes(&members),
        sleep: sleep(record, &members, nodes.len() + survey.robots.len(), nodes),
        slots: slots(record, &members, nodes.len() + survey.robots.len()),
        delay_histogram: all_delays.histogram().into_iter().map(DelayBin::from).collect(),
        sinks: sinks.collect(),
        groups: groups.collect(),
        nodes: by_node.collect(),
    }
}

/// What the stations of a network did in their slots, if it has any; sinks follow from `first_sink` on.
fn slots(record: &NetworkRecord, members: &[NodeId], first_sink: usize) -> Option<SlotSummary> {
    if record.slots.is_empty() {
        return None;
    }
    let nodes: Vec<&SlotUse> = members.iter().map(|node| &record.slots[node.index()]).collect();
    // One that died before the end of the warm-up has no time that counts.
    let counted: Vec<&SlotUse> = nodes.iter().copied().filter(|used| !used.span.is_zero()).collect();
    let duty_cycle = |used: &SlotUse| used.on.as_secs_f64() / used.span.as_secs_f64();
    let current_a = |used: &SlotUse| used.counts.charge_c() / used.span.as_secs_f64();
    let mut counts = SlotCounts::default();
    nodes.iter().for_each(|used| counts += used.counts);
    // A sink that is in another network has no slots in this one.
    let sinks = record.slots[first_sink..].iter().filter(|used| used.is_member && !used.span.is_zero());
    let joins: Vec<f64> = nodes.iter().filter_map(|used| Some(used.joined_after?.as_secs_f64())).collect();
    Some(SlotSummary {
        counted_nodes: (counted.len() < nodes.len()).then_some(counted.len()),
        duty_cycle: mean(counted.iter().map(|used| duty_cycle(used))),
        sink_duty_cycle: mean(sinks.map(duty_cycle)),
        idle_listen: counts.of(SlotKind::IdleListen),
        transmit_acknowledged: counts.of(SlotKind::TransmitAcknowledged),
        transmit_unacknowledged: counts.of(SlotKind::TransmitUnacknowledged),
        transmit: counts.of(SlotKind::Transmit),
        receive_acknowledge: counts.of(SlotKind::ReceiveAcknowledge),
        receive: counts.of(SlotKind::Receive),
        // No charge was published for a scan.
        mean_current_a: mean(counted.iter().map(|used| current_a(used)))
            .filter(|_| nodes.iter().all(|used| used.scanned.is_zero())),
        joined: nodes.iter().filter(|used| used.is_member).count(),
        joined_by_scan: Some(joins.len()).filter(|&count| count > 0),
        lost: nodes.iter().map(|used| used.lost).sum(),
        join_s: mean(joins.into_iter()),
        negotiated: negotiated(&counted),
    })
}

/// The mean of these values, in their order; `None` if there are none.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0_u32, 0.0), |(count, sum), value| (count + 1, sum + value));
    (count > 0).then(|| sum / f64::from(count))
}

/// How nodes agreed on cells, if they did.
fn negotiated(nodes: &[&SlotUse]) -> Option<NegotiatedSummary> {
    let used: Vec<MsfUse> = nodes.iter().filter_map(|used| used.msf).collect();
    if used.is_empty() {
        return None;
    }
    // Nodes that died, or lost the network, have no cells at the end.
    let at_end = nodes.iter().filter(|used| used.is_member).filter_map(|used| used.msf);
    let sum = |of: fn(&MsfUse) -> u64| used.iter().map(of).sum();
    Some(NegotiatedSummary {
        mean_cells: mean(used.iter().map(|used| used.mean_cells)).unwrap_or(0.0),
        cells: mean(at_end.map(|used| used.cells.into())),
        transactions: sum(|used| used.transactions),
        failures: sum(|used| used.failures),
        relocations: sum(|used| used.relocations),
    })
}

/// How the stations of a network slept, if they sleep between checks of the channel; sinks follow from `first_sink` on.
fn sleep(
    record: &NetworkRecord,
    members: &[NodeId],
    first_sink: usize,
    nodes: &[PlacedNode],
) -> Option<SleepSummary> {
    if record.sleep.is_empty() {
        return None;
    }
    let duty_cycle = |used: &SleepUse| used.on.as_secs_f64() / used.span.as_secs_f64();
    let used = |node: &NodeId| &record.sleep[node.index()];
    // One that died before the end of the warm-up has no time that counts.
    let counted: Vec<&NodeId> = members.iter().filter(|node| !used(node).span.is_zero()).collect();
    let share = |node: &NodeId| duty_cycle(used(node));
    let worst = counted.iter().copied().max_by(|a, b| share(a).total_cmp(&share(b)));
    let sinks = record.sleep[first_sink..].iter().filter(|used| used.is_member && !used.span.is_zero());
    let strobes = members.iter().map(|node| used(node).strobes).sum();
    // Strobes that nobody answered were sent for packets, too.
    let packets: u64 = members.iter().map(|node| record.packets[node.index()].sent + used(node).unanswered).sum();
    let energy = members.iter().map(|node| &record.energy[node.index()]);
    let power = |node: &NodeId| record.energy[node.index()].total_j() / used(node).span.as_secs_f64();
    Some(SleepSummary {
        counted_nodes: (counted.len() < members.len()).then_some(counted.len()),
        duty_cycle: mean(counted.iter().map(|node| share(node))),
        worst_duty_cycle: worst.map(share),
        worst_node: worst.map(|node| nodes[node.index()].name.clone()),
        sink_duty_cycle: mean(sinks.map(duty_cycle)),
        checks: members.iter().map(|node| used(node).checks).sum(),
        strobes,
        strobes_per_packet: (packets > 0).then(|| strobes as f64 / packets as f64),
        mean_power_w: mean(counted.iter().map(|node| power(node))),
        asleep_j: energy.map(|energy| energy.sleep_j).sum(),
    })
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
        died: packets.died,
        pending: packets.pending,
        energy_j: EnergySummary { tx: energy.tx_j, rx: energy.rx_j, idle: energy.idle_j + energy.sleep_j },
    }
}
