//! What became of packets that go over several hops, and of their tree.

use std::collections::BTreeMap;

use sextant_kernel::{SimTime, StationId};

use super::config::{RoutedTo, TreeMetric};
use super::counts::Counts;
use super::deliveries::{Arrival, Deliveries, Left};
use super::links::UsableLinks;
use super::tree::Tree;

/// What became of the packets of a simulation with routing, and of its tree.
#[derive(Clone, Debug, Default)]
pub struct RoutingRecord {
    /// By station: nodes come first, then sinks.
    pub stations: Vec<RoutedStation>,
}

/// What became of the packets of a station, and its place in the tree.
#[derive(Clone, Debug, Default)]
pub struct RoutedStation {
    /// The packets that it offered.
    pub packets: Deliveries,
    /// What it did for the packets of all.
    pub counts: Counts,
    /// Its parent at the end, or when it died.
    pub parent: Option<StationId>,
    /// Hops to a sink along the parents at the end; `None` if no way leads there.
    pub depth: Option<u32>,
    /// Whether it died.
    pub is_dead: bool,
    /// Whether it lives, and its way along the parents at the end leads over living stations to a sink.
    pub has_way: bool,
    /// Hops of the shortest way to a sink over usable links of the layout; `None` if there is none.
    pub shortest_hops: Option<u32>,
    /// Expected transmissions of a packet to its parent: as the station worked them out, or by the layout at the start. `None` if
    /// they are not known.
    pub parent_etx: Option<f64>,
    /// Its parents, in the order of time, if it chose them itself: the first one is no change.
    pub parents: Vec<ParentChange>,
    /// Ways down that it keeps at the end, in a tree of RPL.
    pub routes: usize,
    /// When it first knew a way down to each station, in a root of RPL.
    pub known: BTreeMap<StationId, SimTime>,
}

/// A station has its first parent, or another one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParentChange {
    /// When.
    pub time: SimTime,
    /// The new one; `None` if it has lost its way.
    pub parent: Option<StationId>,
    /// Expected transmissions of a packet to the new one, as the station knew them then.
    pub etx: Option<f64>,
}

impl RoutedStation {
    /// How often it changed its parent after the first one.
    #[must_use]
    pub fn changes(&self) -> usize {
        self.parents.len().saturating_sub(1)
    }
}

/// What a station leaves behind.
#[derive(Clone, Debug, Default)]
pub(super) struct StationRecord {
    /// When each of its packets was offered.
    pub(super) offered: Vec<SimTime>,
    pub(super) arrived: Vec<Arrival>,
    /// Origin and number of the packets in its queue.
    pub(super) waiting: Vec<(StationId, u16)>,
    pub(super) parent: Option<StationId>,
    /// Expected transmissions to its parent, if it worked them out itself.
    pub(super) parent_etx: Option<f64>,
    pub(super) parents: Vec<ParentChange>,
    pub(super) counts: Counts,
    /// Ways down that it keeps.
    pub(super) routes: usize,
    /// When it first knew a way down to each station.
    pub(super) known: BTreeMap<StationId, SimTime>,
}

/// What a record needs to know of the simulation.
#[derive(Clone, Debug)]
pub(super) struct Context {
    /// The sinks.
    pub(super) roots: Vec<StationId>,
    /// Packets that are offered before it do not count.
    pub(super) counted_from: SimTime,
    /// Where the packets of nodes go.
    pub(super) to: RoutedTo,
    /// Whether each node died, by a fault or because its battery was empty.
    pub(super) dead: Vec<bool>,
}

impl RoutingRecord {
    /// The record of what nodes and sinks, in this order, `left` behind. There are no robots.
    pub(super) fn of(left: Vec<StationRecord>, links: &UsableLinks, context: &Context) -> Self {
        let shortest = Tree::shortest(links, &context.roots, TreeMetric::Hops);
        let is_dead = |number: usize| context.dead.get(number).copied().unwrap_or(false);
        let tree = Tree::of(left.iter().map(|station| station.parent).collect());
        let living = left.iter().enumerate().map(|(number, station)| station.parent.filter(|_| !is_dead(number)));
        let living = Tree::of(living.collect());
        let is_root = |station: StationId| context.roots.contains(&station);
        let mut stations: Vec<RoutedStation> = (0..left.len())
            .map(StationId::from_index)
            .zip(&left)
            .map(|(station, left)| RoutedStation {
                packets: Deliveries::default(),
                counts: left.counts,
                parent: left.parent,
                depth: tree.depth(station, is_root),
                is_dead: is_dead(station.index()),
                has_way: living.depth(station, is_root).is_some(),
                shortest_hops: shortest.depth(station, is_root),
                parent_etx: left.parent_etx.or_else(|| links.etx(station, left.parent?)),
                parents: left.parents.clone(),
                routes: left.routes,
                known: left.known.clone(),
            })
            .collect();
        let kept = kept(&left, is_dead);
        let mut arrivals: Vec<Vec<Arrival>> = vec![Vec::new(); left.len()];
        for arrival in left.iter().flat_map(|station| &station.arrived) {
            arrivals[arrival.origin.index()].push(*arrival);
        }
        for (number, (station, arrived)) in stations.iter_mut().zip(arrivals).enumerate() {
            let origin = StationId::from_index(number);
            station.packets = Deliveries::of(
                &left[number].offered,
                &arrived,
                |number| kept.get(&(origin, number)).copied(),
                station.shortest_hops.filter(|_| context.to != RoutedTo::Nodes),
                context.counted_from,
            );
        }
        Self { stations }
    }

    /// What all stations together did.
    #[must_use]
    pub fn counts(&self) -> Counts {
        self.stations.iter().map(|station| station.counts).sum()
    }
}

/// Origin and number of the packets in queues, and whether any of them lives.
fn kept(left: &[StationRecord], is_dead: impl Fn(usize) -> bool) -> BTreeMap<(StationId, u16), Left> {
    let (dead, living): (Vec<_>, Vec<_>) = left.iter().enumerate().partition(|(number, _)| is_dead(*number));
    let all = |stations: Vec<(usize, &StationRecord)>, of: Left| {
        let waiting = stations.into_iter().flat_map(|(_, station)| station.waiting.clone());
        waiting.map(move |packet| (packet, of)).collect::<Vec<_>>()
    };
    // Those of the living count where both have one.
    all(dead, Left::Dead).into_iter().chain(all(living, Left::Waiting)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain to the sink 3, whose middle station died.
    #[test]
    fn a_way_over_a_dead_station_is_no_way_and_what_waits_there_ends_with_it() {
        let station = |parent: Option<u32>, waiting: &[u16]| StationRecord {
            offered: vec![SimTime::ZERO],
            waiting: waiting.iter().map(|&number| (StationId(0), number)).collect(),
            parent: parent.map(StationId),
            ..StationRecord::default()
        };
        let left = [station(Some(1), &[]), station(Some(2), &[0]), station(Some(3), &[]), station(None, &[])];
        let context = |dead: Vec<bool>| Context {
            roots: vec![StationId(3)],
            counted_from: SimTime::ZERO,
            to: RoutedTo::Sink,
            dead,
        };
        let links = UsableLinks::none(4);
        let record = |dead| RoutingRecord::of(left.to_vec(), &links, &context(dead)).stations;
        let states = |stations: &[RoutedStation]| -> Vec<(bool, bool, Option<u32>)> {
            stations.iter().map(|station| (station.is_dead, station.has_way, station.depth)).collect()
        };
        let all_live = record(vec![false; 3]);
        let hops = |hops| (false, true, Some(hops));
        assert_eq!(states(&all_live), [hops(3), hops(2), hops(1), hops(0)]);
        assert_eq!(all_live[0].packets.pending, 1);
        let one_dead = record(vec![false, true, false]);
        assert_eq!(states(&one_dead), [(false, false, Some(3)), (true, false, Some(2)), hops(1), hops(0)]);
        assert_eq!((one_dead[0].packets.pending, one_dead[0].packets.died), (0, 1));
    }
}
