//! Packets that cannot arrive: no cell leads to their destination, or they are due after the end.

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

    /// Packets that are due after the end of the run.
    pub(super) fn late_packets(&mut self, reach: &Reach<'_>) {
        let Some(duration) = self.setup.duration else { return };
        let end = SimTime::ZERO + duration;
        let end_s = duration.as_secs_f64();
        let mut late: BTreeMap<String, Vec<NodeId>> = BTreeMap::new();
        for node in self.setup.late_nodes(reach.id, end) {
            if let Some(traffic) = reach.network.traffic.of(node).filter(|traffic| traffic.listed(end).is_none()) {
                late.entry(traffic.key().to_owned()).or_default().push(node);
            }
        }
        for (key, nodes) in late {
            if let Some(nodes) = self.first_of(&nodes) {
                let message =
                    format!("{nodes} has its first packet after the end of the run, at {end_s} s, and sends nothing");
                self.warn(key, message);
            }
        }
        for traffic in reach.network.traffic.kinds() {
            if let Some([all, late]) = traffic.listed(end).filter(|[_, late]| *late > 0) {
                let all = counted(all, "packet");
                let message = format!("{late} of {all} of the table are due after the end of the run, at {end_s} s");
                self.warn(traffic.key(), message);
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
