//! Packets that cannot arrive, or do not count: no cell leads to their destination, they are due in the warm-up, or after the end.

use std::collections::BTreeMap;

use sextant_kernel::text::counted;
use sextant_kernel::{NodeId, SimTime};
use sextant_sim::{CellFault, PacketWay, Technology};

use super::network::Reach;
use super::warning::Warnings;

impl Warnings<'_> {
    /// Nodes whose packets wait for ever, or go where nobody listens, by the cells that the scenario lists.
    pub(super) fn futile_cells(&mut self, reach: &Reach<'_>) {
        let Technology::Tsch(links) = &reach.network.technology else { return };
        if !links.lists_cells() {
            return;
        }
        let way = match self.scenario.routing() {
            Some(_) => PacketWay::OverHops,
            None => PacketWay::Direct,
        };
        let faults = self.setup.cell_faults(reach.id, way);
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
                self.warn(format!("{}mac.tsch.schedule.own", reach.table()), format!("{nodes} has {what}"));
            }
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
