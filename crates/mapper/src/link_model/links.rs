//! What a log says of the links between places of listening and nodes.

use std::collections::BTreeMap;

use sextant_channel::{Position, Reception, ReceptionLog};
use sextant_kernel::NodeId;

use crate::log_facts::gross_strengths;
use crate::log_facts::reach::{HeardNode, heard_nodes, reach_m};

/// A node is tied to at most about this many places.
const PLACES_PER_NODE: f64 = 220.0;
/// Stops near the strongest receptions of a node are places of their own: those in the cells of this many of them.
const STRONGEST: usize = 24;
/// At most so many.
const FINE_PLACES: usize = 90;
/// Where the borders of cells lie relative to the origin, in cells: rows of stops are not on them.
const PHASE: f64 = 0.381_966;
/// Places are taken into account up to this multiple of the reach from the middle of those that heard the node.
const HORIZON: f64 = 2.0;

/// A place where robots listened: one stop, or several that are near to each other.
#[derive(Clone, Copy, Debug)]
struct ListeningPlace {
    /// The middle of its stops (m).
    position: Position,
    /// Number of stops.
    stops: u32,
}

/// What was heard of a node at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct HeardLink {
    /// Number of the place.
    pub(super) place: usize,
    /// Packets received.
    pub(super) received: u32,
    /// Packets sent, at least one.
    pub(super) sent: u32,
    /// Mean strength of the packets received (dBm), if it was measured.
    pub(super) rssi_dbm: Option<f64>,
    /// The probability that the link is dead whatever its power.
    pub(super) outage: f64,
}

/// A node that was heard, and its links.
#[derive(Clone, Debug)]
pub(super) struct NodeLinks {
    pub(super) heard: HeardNode,
    pub(super) links: Vec<HeardLink>,
}

/// Places, and the nodes that were heard there.
#[derive(Clone, Debug)]
pub(super) struct PlaceLinks {
    /// Where robots listened (m): at one stop, or at several that are near to each other.
    pub(super) places: Vec<Position>,
    pub(super) nodes: Vec<NodeLinks>,
    /// How far nodes are heard (m).
    pub(super) reach_m: f64,
}

/// The stops in cells of a grid, and each by itself.
#[derive(Clone, Debug)]
pub(super) struct StopCells {
    /// Each stop by itself: its place. Stops at the same place are one.
    fine: Vec<ListeningPlace>,
    fine_of: Vec<usize>,
    /// The cells, and that of each stop and of each fine place.
    coarse: Vec<ListeningPlace>,
    coarse_of: Vec<usize>,
    cell_of_fine: Vec<usize>,
    uses_rssi: bool,
}

impl PlaceLinks {
    /// The links of `log`; `None` if nothing was heard. Where stops are many within reach of a node, those in a cell of a
    /// grid are one place, at their middle: over so short a distance a link hardly changes. Near the strongest receptions of
    /// a node it does, and there each stop is a place.
    ///
    /// Strengths are left out unless `uses_rssi`.
    pub(super) fn of(log: &ReceptionLog, uses_rssi: bool) -> Option<Self> {
        let heard = heard_nodes(log);
        if heard.is_empty() {
            return None;
        }
        let reach_m = reach_m(log, &heard);
        Some(StopCells::of(log, reach_m, uses_rssi).links(log, heard, reach_m))
    }
}

impl StopCells {
    /// Those of the stops of `log`, over which nodes are heard within `reach_m`.
    pub(super) fn of(log: &ReceptionLog, reach_m: f64, uses_rssi: bool) -> Self {
        let (fine, fine_of) = merged(log, 0.0);
        let (coarse, coarse_of) = places(log, reach_m);
        let mut cell_of_fine = vec![0; fine.len()];
        for (&place, &cell) in fine_of.iter().zip(&coarse_of) {
            cell_of_fine[place] = cell;
        }
        Self { fine, fine_of, coarse, coarse_of, cell_of_fine, uses_rssi }
    }

    /// The links of the nodes of `log`, which has the same stops.
    pub(super) fn links(&self, log: &ReceptionLog, heard: Vec<HeardNode>, reach_m: f64) -> PlaceLinks {
        let nodes = heard.into_iter().map(|heard| node_links(log, heard, self, reach_m)).collect();
        let places = self.fine.iter().chain(&self.coarse).map(|place| place.position).collect();
        PlaceLinks { places, nodes, reach_m }
    }

    /// The cells whose stops are places of their own for `node`: those of its strongest receptions.
    fn opened(&self, log: &ReceptionLog, node: NodeId) -> Vec<bool> {
        let mut opened = vec![false; self.coarse.len()];
        if self.fine.len() == self.coarse.len() {
            return opened;
        }
        let heard = log.of(node).iter().filter(|reception| reception.received > 0);
        let strength = |reception: &Reception| {
            let share = f64::from(reception.received) / f64::from(reception.sent);
            (reception.rssi_dbm.filter(|_| self.uses_rssi).unwrap_or(f64::NEG_INFINITY), share)
        };
        let mut strongest: Vec<Reception> = heard.collect();
        strongest.sort_by(|a, b| {
            let (a, b) = (strength(a), strength(b));
            b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1))
        });
        let mut inside = vec![0; self.coarse.len()];
        for &cell in &self.cell_of_fine {
            inside[cell] += 1;
        }
        let mut count = 0;
        for reception in strongest.iter().take(STRONGEST) {
            let cell = self.coarse_of[reception.stop as usize];
            if !opened[cell] && count + inside[cell] <= FINE_PLACES {
                opened[cell] = true;
                count += inside[cell];
            }
        }
        opened
    }
}

/// The places, and the place of each stop.
fn places(log: &ReceptionLog, reach_m: f64) -> (Vec<ListeningPlace>, Vec<usize>) {
    let stops = log.stops();
    let mut cell_m = 0.0;
    loop {
        let merged = merged(log, cell_m);
        if crowd(&merged.0, HORIZON * reach_m) <= PLACES_PER_NODE || merged.0.len() < 2 {
            return merged;
        }
        cell_m = if cell_m > 0.0 { 1.4 * cell_m } else { reach_m / (4.0 * (stops.len() as f64).sqrt().max(10.0)) };
    }
}

/// The greatest number of places within `radius_m` of one of a few of them.
fn crowd(places: &[ListeningPlace], radius_m: f64) -> f64 {
    let probes = places.iter().step_by((places.len() / 16).max(1));
    let near = |probe: &ListeningPlace| {
        places.iter().filter(|place| place.position.distance_m(probe.position) <= radius_m).count()
    };
    probes.map(near).max().unwrap_or(0) as f64
}

fn merged(log: &ReceptionLog, cell_m: f64) -> (Vec<ListeningPlace>, Vec<usize>) {
    let mut cells: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut places: Vec<ListeningPlace> = Vec::new();
    let place_of = log.stops().iter().map(|stop| {
        let at: [f64; 3] = stop.position.into();
        let cell = if cell_m > 0.0 { at.map(|along| (along / cell_m + PHASE).floor()) } else { at };
        // Both zeros are one cell.
        let key = cell.map(|along| (along + 0.0).to_bits());
        let place = *cells.entry(key).or_insert_with(|| {
            places.push(ListeningPlace { position: Position::ORIGIN, stops: 0 });
            places.len() - 1
        });
        places[place].position = places[place].position + stop.position;
        places[place].stops += 1;
        place
    });
    let place_of = place_of.collect();
    for place in &mut places {
        place.position = place.position * (1.0 / f64::from(place.stops));
    }
    (places, place_of)
}

/// Sums over the stops of a place.
#[derive(Clone, Copy, Default)]
struct PlaceSums {
    listed: u32,
    received: u64,
    sent: u64,
    rssi: f64,
    measured: f64,
}

fn node_links(log: &ReceptionLog, heard: HeardNode, cells: &StopCells, reach_m: f64) -> NodeLinks {
    let opened = cells.opened(log, heard.node);
    let fine = cells.fine.len();
    let mut sums: BTreeMap<usize, PlaceSums> = BTreeMap::new();
    let gross = if cells.uses_rssi { gross_strengths::of_node(log, heard.node) } else { Vec::new() };
    for Reception { stop, received, sent, rssi_dbm, .. } in log.of(heard.node).iter() {
        let (place, cell) = (cells.fine_of[stop as usize], cells.coarse_of[stop as usize]);
        let sum = sums.entry(if opened[cell] { place } else { fine + cell }).or_default();
        sum.listed += 1;
        sum.received += u64::from(received);
        sum.sent += u64::from(sent);
        let is_gross = gross.iter().any(|gross| gross.stop == stop);
        if let Some(rssi_dbm) = rssi_dbm.filter(|_| received > 0 && cells.uses_rssi && !is_gross) {
            sum.rssi += rssi_dbm * f64::from(received);
            sum.measured += f64::from(received);
        }
    }
    let horizon_m = HORIZON * reach_m.max(heard.farthest_m);
    let is_used = |number: usize| match number.checked_sub(fine) {
        Some(cell) => !opened[cell],
        None => opened[cells.cell_of_fine[number]],
    };
    let within = cells.fine.iter().chain(&cells.coarse).enumerate().filter(|&(number, place)| {
        is_used(number) && (sums.contains_key(&number) || place.position.distance_m(heard.middle) <= horizon_m)
    });
    let count = |packets: u64| u32::try_from(packets).unwrap_or(u32::MAX);
    let links = within.filter_map(|(number, place)| {
        let sum = sums.get(&number).copied().unwrap_or_default();
        // A pair that is not listed is one packet that was lost.
        let sent = sum.sent + u64::from(place.stops.saturating_sub(sum.listed));
        let rssi_dbm = (sum.measured > 0.0).then(|| sum.rssi / sum.measured);
        let (received, sent) = (count(sum.received), count(sent));
        (sent > 0).then_some(HeardLink { place: number, received, sent, rssi_dbm, outage: 0.0 })
    });
    NodeLinks { links: links.collect(), heard }
}

/// A strength of so much more counts e times as much for the middle of the places that heard a node (dB).
const WEIGHT_DB: f64 = 4.0;

impl NodeLinks {
    /// The middle of the places that heard the node: weighted by the sixth power of the share of packets that arrived, or
    /// by strength (m).
    pub(super) fn middle(&self, places: &[Position]) -> Position {
        let strongest = self.links.iter().filter_map(|link| link.rssi_dbm).fold(f64::NEG_INFINITY, f64::max);
        let weight = |link: &HeardLink| {
            let share = f64::from(link.received) / f64::from(link.sent);
            link.rssi_dbm.map_or(share.powi(6), |rssi_dbm| libm::exp((rssi_dbm - strongest) / WEIGHT_DB))
        };
        let total: f64 = self.links.iter().map(weight).sum();
        if total <= 0.0 {
            return self.heard.middle;
        }
        self.links.iter().fold(Position::ORIGIN, |sum, link| sum + places[link.place] * (weight(link) / total))
    }

    /// The place that heard the node best: strongest, or without strengths with the greatest share of its packets.
    pub(super) fn strongest(&self) -> Option<usize> {
        let share = |link: &HeardLink| f64::from(link.received) / f64::from(link.sent);
        let strength = |link: &HeardLink| link.rssi_dbm.unwrap_or(f64::NEG_INFINITY);
        let heard = self.links.iter().filter(|link| link.received > 0);
        let best = heard.max_by(|a, b| strength(a).total_cmp(&strength(b)).then(share(a).total_cmp(&share(b))));
        best.map(|link| link.place)
    }

    pub(super) fn node(&self) -> NodeId {
        self.heard.node
    }
}
