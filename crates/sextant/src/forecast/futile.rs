//! Packets that cannot arrive, or do not count: no cell leads to their destination, they are due in the warm-up, or after the end.

use std::collections::BTreeMap;

use sextant_apps::routing::Routing;
use sextant_kernel::text::counted;
use sextant_kernel::{NodeId, SimTime, StationId};
use sextant_sim::{CellFault, Technology};

use super::network::Reach;
use super::warning::Warnings;

impl Warnings<'_> {
    /// Nodes whose packets wait for ever, or go where nobody listens, by the cells that the scenario lists.
    pub(super) fn futile_cells(&mut self, reach: &Reach<'_>) {
        let Technology::Tsch(links) = &reach.network.technology else { return };
        if !links.lists_cells() {
            return;
        }
        let table = format!("{}mac.tsch.schedule.own", reach.table());
        if let Some(routing) = self.scenario.routing() {
            return self.futile_hops(reach, routing, &table);
        }
        let faults = self.setup.cell_faults(reach.id);
        for (fault, what) in [
            (CellFault::NoCell, "no cell in which its packets may go: they wait for ever; list one with `transmit`"),
            (
                CellFault::Unheard,
                "cells in which nobody listens for whom its packets are; list one with `receive` there, in the same timeslot \
                 and with the same channel offset",
            ),
        ] {
            let nodes: Vec<NodeId> =
                faults.iter().filter(|(_, found)| *found == fault).map(|(node, _)| *node).collect();
            if let Some(nodes) = self.first_of(&nodes) {
                self.warn(table.clone(), format!("{nodes} has {what}"));
            }
        }
    }

    /// The same of the hops that packets take, up to a sink and down from there.
    fn futile_hops(&mut self, reach: &Reach<'_>, routing: &Routing, table: &str) {
        let nodes = self.setup.world.nodes.len();
        let sinks: Vec<StationId> = (0..self.setup.sinks.len()).map(|i| StationId::from_index(nodes + i)).collect();
        let has_traffic = |node: &StationId| {
            let traffic = reach.network.traffic.of(NodeId(node.0));
            traffic.is_some_and(|traffic| !traffic.is_silent())
        };
        let origins = (0..nodes).map(StationId::from_index).filter(has_traffic);
        let faults = self.setup.hop_faults(reach.id, routing.hops(origins, &sinks).into_iter());
        for fault in [CellFault::NoCell, CellFault::Unheard] {
            let mut hops = faults.iter().filter(|(_, found)| *found == fault).map(|(hop, _)| *hop);
            let Some((from, to)) = hops.next() else { continue };
            let to = to.map_or_else(String::new, |to| format!(" to `{}`", self.name_of(to)));
            let more = match hops.count() {
                0 => String::new(),
                more => format!(" (and the same of {})", counted(more, "further hop")),
            };
            let from = self.name_of(from);
            let what = match fault {
                CellFault::NoCell => format!("`{from}` has no cell for packets{to}"),
                CellFault::Unheard => {
                    format!("nobody who should listens in the cells of `{from}` for packets{to}")
                }
            };
            self.warn(
                table,
                format!(
                    "{what}{more}: none arrives; list a cell with `transmit` there, and one with `receive` at the next \
                     station, in the same timeslot and with the same channel offset"
                ),
            );
        }
    }

    fn name_of(&self, station: StationId) -> &str {
        let nodes = &self.setup.world.nodes;
        match nodes.get(station.index()) {
            Some(node) => &node.name,
            None => &self.setup.sinks[station.index() - nodes.len()].name,
        }
    }

    /// Packets that are due after the end of the run, and nodes whose packets all are due outside the time that counts.
    pub(super) fn late_packets(&mut self, reach: &Reach<'_>) {
        let Some(duration) = self.setup.duration else { return };
        let end = SimTime::ZERO + duration;
        let end_s = duration.as_secs_f64();
        let is_listed = |node: &NodeId| {
            let traffic = reach.network.traffic.of(*node);
            traffic.is_some_and(|traffic| traffic.listed(end).is_some())
        };
        let late = self.setup.late_nodes(reach.id, end).filter(|node| !is_listed(node)).collect();
        self.each_kind(
            reach,
            late,
            &format!("its first packet after the end of the run, at {end_s} s, and sends nothing"),
        );
        let warm_up = self.scenario.warm_up();
        let uncounted = self.setup.uncounted_nodes(reach.id, SimTime::ZERO + warm_up, end).collect();
        let span =
            format!("the end of the warm-up, at {} s, and that of the run, at {end_s} s", warm_up.as_secs_f64());
        self.each_kind(reach, uncounted, &format!("no packet between {span}: nothing of it counts"));
        for traffic in reach.network.traffic.kinds() {
            if let Some([all, late]) = traffic.listed(end).filter(|[_, late]| *late > 0) {
                let all = counted(all, "packet");
                let message = format!("{late} of {all} of the table are due after the end of the run, at {end_s} s");
                self.warn(traffic.key(), message);
            }
        }
    }

    /// Says what these nodes have, for each kind of their traffic.
    fn each_kind(&mut self, reach: &Reach<'_>, nodes: Vec<NodeId>, what: &str) {
        let mut by_key: BTreeMap<&str, Vec<NodeId>> = BTreeMap::new();
        for node in nodes {
            if let Some(traffic) = reach.network.traffic.of(node) {
                by_key.entry(traffic.key()).or_default().push(node);
            }
        }
        for (key, nodes) in by_key {
            if let Some(nodes) = self.first_of(&nodes) {
                self.warn(key, format!("{nodes} has {what}"));
            }
        }
    }

    /// The name of the first node, and how many more there are; `None` without one.
    fn first_of(&self, nodes: &[NodeId]) -> Option<String> {
        let (first, others) = nodes.split_first()?;
        let name = &self.setup.world.nodes[first.index()].name;
        Some(match others.len() {
            0 => format!("`{name}`"),
            more => format!("`{name}` (and {} more)", counted(more, "node")),
        })
    }
}
