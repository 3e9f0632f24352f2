//! Packets that went over several hops, as a summary.

use std::collections::BTreeMap;

use sextant_apps::routing::{Deliveries, RoutedStation, RoutedTo, RoutingRecord, TreeConfig};
use sextant_kernel::{SimTime, StationId};
use sextant_mac::EnergySpent;
use sextant_recording::messages::{ParentChangeMessage, TreeEdgeMessage};
use sextant_scenario::Scenario;
use sextant_sim::layout::PlacedNode;
use sextant_sim::{BatteryRecord, Death};

use super::rpl;
use super::simulator::Simulated;
use crate::summary::{
    AnswersSummary, DelaySummary, DepthSummary, FragmentsSummary, HopsSummary, RoutedNodeSummary, RoutingSummary,
};

/// What became of the packets that went over several hops, if they did.
pub(super) fn of(scenario: &Scenario, simulated: &Simulated) -> Option<RoutingSummary> {
    let (record, written) = (simulated.routing.as_ref()?, scenario.config().routing.as_ref()?);
    let nodes = &record.stations[..scenario.world().nodes.len()];
    let energy = &simulated.survey.networks.first()?.energy;
    let mut all = Deliveries::default();
    nodes.iter().for_each(|node| all += &node.packets);
    let counts = record.counts();
    let changes: usize = nodes.iter().map(|node| node.changes()).sum();
    let survey = &simulated.survey;
    let counted_from = SimTime::ZERO + scenario.warm_up();
    // Until when each node lived, or the end.
    let mut lived = vec![survey.end; nodes.len()];
    survey.deaths.iter().for_each(|death| lived[death.node.index()] = death.time);
    let node_hours = lived.iter().map(|end| end.as_secs_f64()).sum::<f64>() / 3600.0;
    let answers = (written.to == RoutedTo::SinkAndBack).then(|| answers(&record.stations[nodes.len()..]));
    let delivered_both = all.delivered + answers.as_ref().map_or(0, |answers| answers.delivered);
    Some(RoutingSummary {
        tree: written.tree.name(),
        to: match written.to {
            RoutedTo::Sink => None,
            RoutedTo::SinkAndBack => Some("sink_and_back"),
            RoutedTo::Nodes => Some("nodes"),
        },
        offered: all.offered,
        delivered: all.delivered,
        pending: all.pending,
        died: all.died,
        lost: all.lost(),
        delivery: delivery(&all),
        delay_s: DelaySummary::of(&all.delays),
        hops: hops(&all),
        stretch: mean(all.stretch, all.stretched),
        transmissions: counts.transmissions,
        transmissions_per_delivery: mean(counts.transmissions as f64, delivered_both),
        duplicates: counts.duplicates + all.copies,
        loops: counts.loops,
        queue_drops: counts.queue_drops,
        given_up: counts.given_up,
        hop_limit_drops: counts.hop_limit_drops,
        no_route: (written.to != RoutedTo::Sink).then_some(counts.no_route),
        answers,
        beacons: counts.beacons,
        rpl: match &written.tree {
            TreeConfig::Rpl(tree) => Some(rpl::of(scenario, tree, record, simulated)),
            TreeConfig::Given(_) | TreeConfig::Shortest(_) | TreeConfig::Collection(_) => None,
        },
        fragments: written.fragments.map(|_| FragmentsSummary {
            fragments: counts.fragments,
            reassembly_failures: counts.reassembly_failures,
        }),
        parent_changes: changes as u64,
        parent_changes_per_node_h: if node_hours > 0.0 { changes as f64 / node_hours } else { 0.0 },
        without_way: nodes.iter().filter(|node| !node.is_dead && !node.has_way).count(),
        depth: nodes.iter().filter(|node| node.has_way).filter_map(|node| node.depth).max().unwrap_or(0),
        by_depth: by_depth(nodes, energy, &survey.batteries, |node| lived[node] > counted_from),
        nodes: by_node(scenario, record, energy),
    })
}

fn mean(sum: f64, count: u64) -> Option<f64> {
    (count > 0).then(|| sum / count as f64)
}

fn delivery(packets: &Deliveries) -> Option<f64> {
    mean(packets.delivered as f64, packets.offered - packets.pending)
}

fn hops(packets: &Deliveries) -> Option<HopsSummary> {
    let mean = mean(packets.hops as f64, packets.delivered)?;
    Some(HopsSummary { mean, max: packets.most_hops })
}

/// What became of the answers of the sinks.
fn answers(sinks: &[RoutedStation]) -> AnswersSummary {
    let mut all = Deliveries::default();
    sinks.iter().for_each(|sink| all += &sink.packets);
    AnswersSummary {
        offered: all.offered,
        delivered: all.delivered,
        pending: all.pending,
        died: all.died,
        lost: all.lost(),
        delivery: delivery(&all),
        delay_s: DelaySummary::of(&all.delays),
        hops: hops(&all),
    }
}

/// Nodes of one depth.
#[derive(Default)]
struct SameDepth {
    packets: Deliveries,
    spent: EnergySpent,
    nodes: usize,
    /// Those that live, with a way over living ones.
    with_way: usize,
    /// Those that lived after the warm-up.
    counted: usize,
}

/// The nodes by their depth, and last those without one; `batteries` is empty if they have none. Energies are those of nodes that count.
fn by_depth(
    nodes: &[RoutedStation],
    energy: &[EnergySpent],
    batteries: &[BatteryRecord],
    counts: impl Fn(usize) -> bool,
) -> Vec<DepthSummary> {
    let mut depths: BTreeMap<(bool, Option<u32>), SameDepth> = BTreeMap::new();
    for (number, (node, &spent)) in nodes.iter().zip(energy).enumerate() {
        let same = depths.entry((node.depth.is_none(), node.depth)).or_default();
        same.packets += &node.packets;
        same.spent += spent;
        same.nodes += 1;
        same.with_way += usize::from(node.has_way);
        same.counted += usize::from(counts(number));
    }
    let of_depth = |depth: Option<u32>| {
        let own = nodes.iter().zip(batteries).filter(move |(node, _)| node.depth == depth);
        own.map(|(_, battery)| battery)
    };
    let dead = |depth: Option<u32>| of_depth(depth).filter(|battery| battery.depleted.is_some()).count();
    let summary =
        |((_, depth), SameDepth { packets, spent, nodes, with_way, counted }): ((bool, Option<u32>), SameDepth)| {
            DepthSummary {
                depth,
                nodes,
                with_way: (with_way < nodes).then_some(with_way),
                counted_nodes: (counted < nodes).then_some(counted),
                offered: packets.offered,
                delivered: packets.delivered,
                delivery: delivery(&packets),
                delay_s: packets.delays.mean_s(),
                energy_j: spent.total_j() / counted.max(1) as f64,
                energy_tx_j: spent.tx_j / counted.max(1) as f64,
                depleted: (!batteries.is_empty()).then(|| dead(depth)),
                lifetime_d: super::battery::lifetimes(of_depth(depth)),
            }
        };
    depths.into_iter().map(summary).collect()
}

fn by_node(scenario: &Scenario, record: &RoutingRecord, energy: &[EnergySpent]) -> Vec<RoutedNodeSummary> {
    let nodes = &scenario.world().nodes;
    let summary = |((placed, node), &spent): ((&PlacedNode, &RoutedStation), &EnergySpent)| RoutedNodeSummary {
        name: placed.name.clone(),
        parent: node.parent.map(|parent| name_of(scenario, parent)),
        depth: node.depth,
        shortest_hops: node.shortest_hops,
        offered: node.packets.offered,
        delivered: node.packets.delivered,
        delay_s: node.packets.delays.mean_s(),
        transmissions: node.counts.transmissions,
        parent_changes: node.changes() as u64,
        energy_j: spent.total_j(),
    };
    nodes.iter().zip(&record.stations).zip(energy).map(summary).collect()
}

/// The tree at the end, for a recording; a node that died has the time of its death.
pub(super) fn edges(scenario: &Scenario, record: &RoutingRecord, deaths: &[Death]) -> Vec<TreeEdgeMessage> {
    let died: BTreeMap<u32, u64> = deaths.iter().map(|death| (death.node.0, death.time.as_nanos())).collect();
    let nodes = record.stations[..scenario.world().nodes.len()].iter();
    let edge = |(node, station): (u32, &RoutedStation)| TreeEdgeMessage {
        node,
        parent: station.parent.map(|parent| name_of(scenario, parent)).unwrap_or_default(),
        depth: station.depth,
        etx: station.parent_etx,
        changes: u32::try_from(station.changes()).unwrap_or(u32::MAX),
        parent_station: station.parent.map(|parent| parent.0),
        died_ns: died.get(&node).copied(),
    };
    (0..).zip(nodes).map(edge).collect()
}

/// The parents that nodes chose, for a recording: in the order of time, and of the nodes.
pub(super) fn parent_changes(scenario: &Scenario, record: &RoutingRecord) -> Vec<ParentChangeMessage> {
    let name = |parent: Option<StationId>| parent.map(|parent| name_of(scenario, parent)).unwrap_or_default();
    let nodes = record.stations[..scenario.world().nodes.len()].iter();
    let mut changes = Vec::new();
    for (node, station) in (0..).zip(nodes) {
        let mut before = None;
        for change in &station.parents {
            changes.push(ParentChangeMessage {
                time_ns: change.time.as_nanos(),
                node,
                old_parent: name(before),
                new_parent: name(change.parent),
                etx: change.etx,
                parent_station: change.parent.map(|parent| parent.0),
            });
            before = change.parent;
        }
    }
    changes.sort_by_key(|change| change.time_ns);
    changes
}

/// The name of a node or a sink.
fn name_of(scenario: &Scenario, station: StationId) -> String {
    let nodes = &scenario.world().nodes;
    match nodes.get(station.index()) {
        Some(node) => node.name.clone(),
        None => {
            let sink = scenario.config().sinks.get(station.index() - nodes.len());
            sink.map(|sink| sink.name.clone()).unwrap_or_default()
        }
    }
}
