//! How long it took until the children of dead nodes had a way to a sink again.

use sextant_apps::routing::RoutingRecord;
use sextant_kernel::{SimTime, StationId};
use sextant_sim::Death;

use crate::summary::HealingSummary;

/// Something that changes a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Change {
    /// A station has this parent from now on, or none.
    Parent(Option<StationId>),
    /// It dies.
    Death,
}

/// The parents of stations at an instant; sinks follow from `first_sink` on.
struct Tree {
    parents: Vec<Option<StationId>>,
    dead: Vec<bool>,
    first_sink: usize,
}

impl Tree {
    /// Whether the parents of a station lead over living stations to a sink.
    fn has_way(&self, station: StationId) -> bool {
        let mut at = station;
        // A way with more hops goes round in a circle.
        for _ in 0..=self.parents.len() {
            match self.parents[at.index()] {
                _ if at.index() >= self.first_sink => return true,
                Some(parent) if !self.dead[at.index()] => at = parent,
                Some(_) | None => return false,
            }
        }
        false
    }
}

/// A node whose parent died then, and that has no way since.
struct Orphan {
    station: StationId,
    since: SimTime,
}

/// How long it took until the children of dead nodes had a way over living ones again; `None` if no node lost its parent. Sinks follow
/// from `first_sink` on.
pub(super) fn healing(record: &RoutingRecord, deaths: &[Death], first_sink: usize) -> Option<HealingSummary> {
    let stations = &record.stations;
    let mut tree = Tree { parents: vec![None; stations.len()], dead: vec![false; stations.len()], first_sink };
    let mut waiting: Vec<Orphan> = Vec::new();
    let (mut orphans, mut healed_s) = (0, Vec::new());
    for (time, change, station) in changes(record, deaths) {
        match change {
            Change::Parent(parent) => tree.parents[station.index()] = parent,
            Change::Death => {
                tree.dead[station.index()] = true;
                waiting.retain(|orphan| orphan.station != station);
                let children = (0..first_sink).filter(|&child| tree.parents[child] == Some(station));
                let orphaned = children.filter(|&child| !tree.dead[child]).map(StationId::from_index);
                let before = waiting.len();
                waiting.extend(orphaned.map(|station| Orphan { station, since: time }));
                orphans += (waiting.len() - before) as u64;
            }
        }
        waiting.retain(|orphan| {
            let is_healed = tree.has_way(orphan.station);
            healed_s.extend(is_healed.then(|| (time - orphan.since).as_secs_f64()));
            !is_healed
        });
    }
    let healed = healed_s.len() as u64;
    (orphans > 0).then(|| HealingSummary {
        orphans,
        healed,
        mean_s: (healed > 0).then(|| healed_s.iter().sum::<f64>() / healed as f64),
        max_s: healed_s.iter().copied().reduce(f64::max),
    })
}

/// What changed the tree, in the order of time. Of an instant, parents come before deaths.
fn changes(record: &RoutingRecord, deaths: &[Death]) -> Vec<(SimTime, Change, StationId)> {
    let mut changes = Vec::new();
    for (number, station) in record.stations.iter().enumerate() {
        let station_id = StationId::from_index(number);
        changes.extend(station.parents.iter().map(|change| (change.time, Change::Parent(change.parent), station_id)));
    }
    changes.extend(deaths.iter().map(|death| (death.time, Change::Death, StationId(death.node.0))));
    // One station changes its parent several times at an instant: the last one counts, so the sort must keep their order.
    changes.sort_by_key(|(time, change, _)| (*time, *change == Change::Death));
    changes
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use sextant_apps::routing::{ParentChange, RoutedStation};
    use sextant_kernel::NodeId;

    use super::*;

    fn at(s: u64) -> SimTime {
        SimTime::ZERO + Duration::from_secs(s)
    }

    /// Stations with these parents from these times (s) on.
    fn record(parents: &[&[(u64, Option<u32>)]]) -> RoutingRecord {
        let change = |&(s, parent): &(u64, Option<u32>)| ParentChange {
            time: at(s),
            parent: parent.map(StationId),
            etx: None,
        };
        let station = |parents: &&[(u64, Option<u32>)]| RoutedStation {
            parents: parents.iter().map(change).collect(),
            ..RoutedStation::default()
        };
        RoutingRecord { stations: parents.iter().map(station).collect() }
    }

    fn found(parents: &[&[(u64, Option<u32>)]], deaths: &[(u64, u32)]) -> Option<(u64, u64, Option<f64>)> {
        let deaths: Vec<Death> = deaths.iter().map(|&(s, node)| Death { node: NodeId(node), time: at(s) }).collect();
        let healing = healing(&record(parents), &deaths, parents.len() - 1)?;
        Some((healing.orphans, healing.healed, healing.max_s))
    }

    #[test]
    fn a_node_is_healed_when_its_way_leads_to_a_sink_again() {
        // Node 1 has its time by node 0, and node 2 by node 1; station 3 is the sink.
        let chain = |second: &'static [(u64, Option<u32>)], third: &'static [(u64, Option<u32>)]| {
            found(&[&[(1, Some(3))], second, third, &[]], &[(10, 0)])
        };
        let last: &[_] = &[(3, Some(1))];
        assert_eq!(found(&[&[(1, Some(3))], &[(2, Some(0))], last, &[]], &[]), None);
        assert_eq!(chain(&[(2, Some(0)), (14, Some(3))], last), Some((1, 1, Some(4.0))));
        // Its own child is no way, nor is none.
        assert_eq!(chain(&[(2, Some(0)), (14, Some(2)), (15, None)], last), Some((1, 0, None)));
        // It is one when that has found another one.
        assert_eq!(chain(&[(2, Some(0)), (14, Some(2))], &[(3, Some(1)), (20, Some(3))]), Some((1, 1, Some(10.0))));
        // A dead node is none either, and a node that dies is no orphan any more.
        assert_eq!(chain(&[(2, Some(0)), (9, Some(3)), (11, Some(0))], last), None);
        let both = found(&[&[(1, Some(3))], &[(2, Some(0))], &[(3, Some(1))], &[]], &[(10, 0), (12, 1)]);
        assert_eq!(both, Some((2, 0, None)));
    }
}
