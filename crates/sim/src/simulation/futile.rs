//! Nodes whose packets cannot arrive, which is known before the start.

use sextant_kernel::{NodeId, SimTime, StationId};

use super::stations::{Stations, know};
use crate::applications::traffic::{Next, Traffic};
use crate::link::{CellFault, Technology};
use crate::purpose;
use crate::service::network_id::NetworkId;
use crate::service::report::Destination;
use crate::setup::Setup;

impl Setup {
    /// The nodes with traffic whose packets reach nobody by the cells that a scenario lists for a network with slots, and why.
    ///
    /// # Panics
    /// If there is no such network.
    #[must_use]
    pub fn cell_faults(&self, id: NetworkId) -> Vec<(NodeId, CellFault)> {
        let Some(setup) = self.known() else { return Vec::new() };
        let stations = Stations::of(&setup);
        let Technology::Tsch(links) = &setup.networks[id.index()].technology else { return Vec::new() };
        let sinks: Vec<StationId> = stations.collectors(id).map(|(_, sink)| sink).collect();
        let fault = |(node, traffic): (NodeId, &Traffic)| {
            let to = stations.destination(id, traffic, node).ok()?;
            let listeners = match &to {
                Destination::All => &*sinks,
                Destination::Station(to) => std::slice::from_ref(to),
            };
            Some((node, links.cell_fault(StationId(node.0), Some(to), listeners)?))
        };
        setup.with_traffic(id).filter_map(fault).collect()
    }

    /// Those of some hops, each from a station to another one or to any, over which no packet goes by these cells, and why.
    ///
    /// # Panics
    /// If there is no such network.
    #[must_use]
    pub fn hop_faults(
        &self,
        id: NetworkId,
        hops: impl Iterator<Item = (StationId, Option<StationId>)>,
    ) -> Vec<((StationId, Option<StationId>), CellFault)> {
        let Some(setup) = self.known() else { return Vec::new() };
        let stations = Stations::of(&setup);
        let Technology::Tsch(links) = &setup.networks[id.index()].technology else { return Vec::new() };
        let all: Vec<StationId> = stations.roll.stations().collect();
        let fault = |(from, to): (StationId, Option<StationId>)| {
            let listeners = to.as_ref().map_or(&*all, std::slice::from_ref);
            Some(((from, to), links.cell_fault(from, to.map(Destination::Station), listeners)?))
        };
        hops.filter_map(fault).collect()
    }

    /// The same setup whose networks know their stations; `None` if some name is not known.
    fn known(&self) -> Option<Self> {
        let mut setup = self.clone();
        know(&mut setup).ok()?;
        Some(setup)
    }

    /// The nodes with traffic whose first packet is due at `end` or later.
    ///
    /// # Panics
    /// If there is no such network.
    pub fn late_nodes(&self, id: NetworkId, end: SimTime) -> impl Iterator<Item = NodeId> {
        let seed = purpose::traffic_seed(self.seed, id);
        let is_late = move |(node, traffic): &(NodeId, &Traffic)| matches!(traffic.next(seed, *node, 0, SimTime::ZERO), Next::At(due, _) if due >= end);
        self.with_traffic(id).filter(is_late).map(|(node, _)| node)
    }

    /// The nodes with traffic whose packets are due before `from`, or at `end` and later, but never between.
    ///
    /// # Panics
    /// If there is no such network.
    pub fn uncounted_nodes(&self, id: NetworkId, from: SimTime, end: SimTime) -> impl Iterator<Item = NodeId> {
        let seed = purpose::traffic_seed(self.seed, id);
        let technology = &self.networks[id.index()].technology;
        let is_uncounted = move |&(node, traffic): &(NodeId, &Traffic)| {
            let clock = technology.settings().radio().clock(self.seed, id, node);
            let true_time = |due| if traffic.follows_clock() { clock.instant(due) } else { due };
            let Next::At(first, _) = traffic.next(seed, node, 0, SimTime::ZERO) else { return false };
            // A saturated node goes on to the end.
            traffic.may_rest()
                && true_time(first) < from
                && match traffic.after_rest(seed, node, 0, from, true_time).next {
                    Next::At(due, _) => true_time(due) >= end,
                    Next::AfterTheLast(_) => false,
                    Next::Never => true,
                }
        };
        self.with_traffic(id).filter(is_uncounted).map(|(node, _)| node)
    }

    /// The nodes of a network that have packets.
    ///
    /// # Panics
    /// If there is no such network.
    pub(crate) fn with_traffic(&self, id: NetworkId) -> impl Iterator<Item = (NodeId, &Traffic)> {
        let network = &self.networks[id.index()];
        let nodes = (0..self.world.nodes.len()).map(NodeId::from_index).filter(|&node| network.has(node));
        let traffic = nodes.filter_map(|node| Some((node, network.traffic.of(node)?)));
        traffic.filter(|(_, traffic)| !traffic.is_silent())
    }
}
