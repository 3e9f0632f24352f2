//! What became of packets that go over several hops, and of their tree.

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_sim::Delays;

use super::config::{RoutedTo, TreeMetric};
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

/// What became of packets.
#[derive(Clone, Debug, Default)]
pub struct Deliveries {
    /// Packets that there were.
    pub offered: u64,
    /// Those that arrived where they should.
    pub delivered: u64,
    /// Those that did not arrive and wait in a queue at the end.
    pub pending: u64,
    /// Copies that arrived after the first one.
    pub copies: u64,
    /// Time from the offer to the arrival.
    pub delays: Delays,
    /// Hops of all that arrived together, ...
    pub hops: u64,
    /// ... and the most of one.
    pub most_hops: u8,
    /// Hops of those that arrived and have a shortest way, each divided by the hops of that, together, ...
    pub stretch: f64,
    /// ... and their number.
    pub stretched: u64,
}

/// What a station did for the packets of all.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Beacons.
    pub beacons: u64,
    /// Frames with packets on air, retries included.
    pub transmissions: u64,
    /// Packets that it got again and dropped.
    pub duplicates: u64,
    /// How often a packet came again after more hops; it was sent on.
    pub loops: u64,
    /// Packets that found its queue full.
    pub queue_drops: u64,
    /// Packets that did not reach the next station in as many tries as allowed.
    pub given_up: u64,
    /// Packets that were dropped after too many hops.
    pub hop_limit_drops: u64,
    /// Packets that a station dropped because it knew no way down.
    pub no_route: u64,
    /// Frames with fragments that it gave to the MAC.
    pub fragments: u64,
    /// Packets that it could not put together: a fragment was lost, or there was no room.
    pub reassembly_failures: u64,
    /// What it did for a tree of RPL.
    pub rpl: RplCounts,
}

/// What a station did for a tree of RPL. Messages are counted when they are given to the MAC, on each hop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RplCounts {
    /// DIOs to all.
    pub dio: u64,
    /// DIOs to one neighbour: probes of links, and answers to packets with a wrong rank.
    pub unicast_dio: u64,
    /// DISs.
    pub dis: u64,
    /// DAOs.
    pub dao: u64,
    /// Answers to DAOs.
    pub dao_ack: u64,
    /// Frames with DAOs and their answers on air, retries included.
    pub transmissions: u64,
    /// DAOs and their answers that found a queue full, or were given up on a hop.
    pub lost: u64,
    /// DIOs that were left out because others had said the same.
    pub left_out: u64,
    /// Packets that came from a station with a rank that does not fit, each time.
    pub rank_errors: u64,
    /// Packets that were dropped for that.
    pub rank_error_drops: u64,
    /// DAOs that found a table of ways full.
    pub full_tables: u64,
    /// How often it forgot its neighbours, because no answer to its DAOs came.
    pub repairs: u64,
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

/// A packet that arrived where it should.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arrival {
    pub(super) origin: StationId,
    pub(super) number: u32,
    pub(super) hops: u8,
    pub(super) time: SimTime,
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
    /// Whether each node died.
    pub(super) dead: Vec<bool>,
}

impl RoutingRecord {
    /// The record of what nodes and sinks, in this order, `left` behind. There are no robots.
    pub(super) fn of(left: Vec<StationRecord>, links: &UsableLinks, context: &Context) -> Self {
        let shortest = Tree::shortest(links, &context.roots, TreeMetric::Hops);
        let tree = Tree::of(left.iter().map(|station| station.parent).collect());
        let is_root = |station: StationId| context.roots.contains(&station);
        let mut stations: Vec<RoutedStation> = (0..left.len())
            .map(StationId::from_index)
            .zip(&left)
            .map(|(station, left)| RoutedStation {
                packets: Deliveries::default(),
                counts: left.counts,
                parent: left.parent,
                depth: tree.depth(station, is_root),
                shortest_hops: shortest.depth(station, is_root),
                parent_etx: left.parent_etx.or_else(|| links.etx(station, left.parent?)),
                parents: left.parents.clone(),
                routes: left.routes,
                known: left.known.clone(),
            })
            .collect();
        let waiting = waiting(&left, &context.dead);
        let mut arrivals: Vec<Vec<Arrival>> = vec![Vec::new(); left.len()];
        for arrival in left.iter().flat_map(|station| &station.arrived) {
            arrivals[arrival.origin.index()].push(*arrival);
        }
        for (number, (station, mut arrived)) in stations.iter_mut().zip(arrivals).enumerate() {
            arrived.sort_by_key(|arrival| (arrival.number, arrival.time));
            let origin = StationId::from_index(number);
            station.packets = Deliveries::of(
                &left[number].offered,
                &arrived,
                |number| waiting.contains(&(origin, number)),
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

/// Origin and number of the packets in the queues of stations that live.
fn waiting(left: &[StationRecord], dead: &[bool]) -> BTreeSet<(StationId, u16)> {
    let lives = |&(number, _): &(usize, &StationRecord)| !dead.get(number).copied().unwrap_or(false);
    left.iter().enumerate().filter(lives).flat_map(|(_, station)| station.waiting.iter().copied()).collect()
}

impl Deliveries {
    /// What became of the packets that were `offered`, of which these `arrived`, by number and time.
    fn of(
        offered: &[SimTime],
        arrived: &[Arrival],
        waits: impl Fn(u16) -> bool,
        shortest_hops: Option<u32>,
        counted_from: SimTime,
    ) -> Self {
        let mut all = Self::default();
        let mut arrived = arrived.iter().peekable();
        for (number, &time) in (0..=u32::MAX).zip(offered) {
            let mut copies = 0;
            let mut first = None;
            while let Some(arrival) = arrived.next_if(|arrival| arrival.number <= number) {
                copies += u64::from(first.is_some());
                first = first.or(Some(arrival));
            }
            if time < counted_from {
                continue;
            }
            all.offered += 1;
            all.copies += copies;
            match first {
                Some(arrival) => all.deliver(arrival.time - time, arrival.hops, shortest_hops),
                None => {
                    #[expect(clippy::cast_possible_truncation, reason = "numbers of packets go round")]
                    let short = number as u16;
                    // Only the latest packet with these bits can wait.
                    let is_latest = offered.len() as u64 - u64::from(number) <= 1 << 16;
                    all.pending += u64::from(is_latest && waits(short));
                }
            }
        }
        all
    }

    fn deliver(&mut self, delay: Duration, hops: u8, shortest_hops: Option<u32>) {
        self.delivered += 1;
        self.delays.add(delay);
        self.hops += u64::from(hops);
        self.most_hops = self.most_hops.max(hops);
        if let Some(shortest) = shortest_hops.filter(|&shortest| shortest > 0) {
            self.stretch += f64::from(hops) / f64::from(shortest);
            self.stretched += 1;
        }
    }
}

impl std::ops::AddAssign<&Deliveries> for Deliveries {
    fn add_assign(&mut self, other: &Self) {
        // Without `..`, so that no field is forgotten.
        let Self { offered, delivered, pending, copies, delays, hops, most_hops, stretch, stretched } = other;
        self.offered += offered;
        self.delivered += delivered;
        self.pending += pending;
        self.copies += copies;
        self.delays.merge(delays);
        self.hops += hops;
        self.most_hops = self.most_hops.max(*most_hops);
        self.stretch += stretch;
        self.stretched += stretched;
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, other: Self) {
        // Without `..`, so that no field is forgotten.
        let Self {
            beacons,
            transmissions,
            duplicates,
            loops,
            queue_drops,
            given_up,
            hop_limit_drops,
            no_route,
            fragments,
            reassembly_failures,
            rpl,
        } = other;
        self.beacons += beacons;
        self.transmissions += transmissions;
        self.duplicates += duplicates;
        self.loops += loops;
        self.queue_drops += queue_drops;
        self.given_up += given_up;
        self.hop_limit_drops += hop_limit_drops;
        self.no_route += no_route;
        self.fragments += fragments;
        self.reassembly_failures += reassembly_failures;
        self.rpl += rpl;
    }
}

impl std::ops::AddAssign for RplCounts {
    fn add_assign(&mut self, other: Self) {
        // Without `..`, so that no field is forgotten.
        let Self {
            dio,
            unicast_dio,
            dis,
            dao,
            dao_ack,
            transmissions,
            lost,
            left_out,
            rank_errors,
            rank_error_drops,
            full_tables,
            repairs,
        } = other;
        self.dio += dio;
        self.unicast_dio += unicast_dio;
        self.dis += dis;
        self.dao += dao;
        self.dao_ack += dao_ack;
        self.transmissions += transmissions;
        self.lost += lost;
        self.left_out += left_out;
        self.rank_errors += rank_errors;
        self.rank_error_drops += rank_error_drops;
        self.full_tables += full_tables;
        self.repairs += repairs;
    }
}

impl std::iter::Sum for Counts {
    fn sum<I: Iterator<Item = Self>>(all: I) -> Self {
        all.fold(Self::default(), |mut sum, one| {
            sum += one;
            sum
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(s: u64) -> SimTime {
        SimTime::ZERO + Duration::from_secs(s)
    }

    #[test]
    fn each_packet_is_delivered_once_pending_or_lost() {
        let arrival = |number, hops, time_s| Arrival { origin: StationId(0), number, hops, time: at(time_s) };
        let offered = [at(1), at(2), at(3), at(4), at(5)];
        // Number 0 is before the warm-up, number 3 is lost, number 4 waits.
        let arrived = [arrival(0, 9, 2), arrival(1, 2, 4), arrival(1, 3, 9), arrival(2, 4, 6)];
        let all = Deliveries::of(&offered, &arrived, |number| number == 4, Some(2), at(2));
        assert_eq!((all.offered, all.delivered, all.pending, all.copies), (4, 2, 1, 1));
        assert_eq!((all.hops, all.most_hops, all.stretched, all.delays.mean_s()), (6, 4, 2, Some(2.5)));
        assert!((all.stretch - 3.0).abs() < 1e-12);
    }
}
