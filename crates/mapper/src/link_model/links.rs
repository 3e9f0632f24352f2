//! What a log says of the links between places of listening and nodes.

use std::collections::BTreeMap;

use sextant_channel::{Position, Reception, ReceptionLog};
use sextant_kernel::NodeId;

use crate::reach::{HeardNode, heard_nodes, reach_m};

/// A node is tied to at most about this many places.
const PLACES_PER_NODE: f64 = 220.0;
/// Places are taken into account up to this multiple of the reach from the middle of those that heard the node.
const HORIZON: f64 = 2.0;

/// A place where robots listened: one stop, or several that are near to each other.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// The middle of its stops (m).
    position: Position,
    /// Number of stops.
    stops: u32,
}

/// What was heard of a node at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Link {
    /// Number of the place.
    pub(super) place: usize,
    /// Packets received.
    pub(super) received: u32,
    /// Packets sent, at least one.
    pub(super) sent: u32,
    /// Mean strength of the packets received (dBm), if it was measured.
    pub(super) rssi_dbm: Option<f64>,
}

/// A node that was heard, and its links.
#[derive(Clone, Debug)]
pub(super) struct NodeLinks {
    pub(super) heard: HeardNode,
    pub(super) links: Vec<Link>,
}

/// Places, and the nodes that were heard there.
#[derive(Clone, Debug)]
pub(super) struct Links {
    /// Where robots listened (m): at one stop, or at several that are near to each other.
    pub(super) places: Vec<Position>,
    pub(super) nodes: Vec<NodeLinks>,
    /// How far nodes are heard (m).
    pub(super) reach_m: f64,
}

impl Links {
    /// The links of `log`; `None` if nothing was heard. Where stops are many within reach of a node, those in a cell of a
    /// grid are one place, at their middle: over so short a distance a link hardly changes.
    pub(super) fn of(log: &ReceptionLog) -> Option<Self> {
        let heard = heard_nodes(log);
        if heard.is_empty() {
            return None;
        }
        let reach_m = reach_m(log, &heard);
        let (places, place_of) = places(log, reach_m);
        let nodes = heard.into_iter().map(|heard| node_links(log, heard, &places, &place_of, reach_m)).collect();
        Some(Self { places: places.iter().map(|place| place.position).collect(), nodes, reach_m })
    }
}

/// The places, and the place of each stop.
fn places(log: &ReceptionLog, reach_m: f64) -> (Vec<Place>, Vec<usize>) {
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
fn crowd(places: &[Place], radius_m: f64) -> f64 {
    let probes = places.iter().step_by((places.len() / 16).max(1));
    let near =
        |probe: &Place| places.iter().filter(|place| place.position.distance_m(probe.position) <= radius_m).count();
    probes.map(near).max().unwrap_or(0) as f64
}

fn merged(log: &ReceptionLog, cell_m: f64) -> (Vec<Place>, Vec<usize>) {
    let mut cells: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut places: Vec<Place> = Vec::new();
    let place_of = log.stops().iter().map(|stop| {
        let at: [f64; 3] = stop.position.into();
        let cell = if cell_m > 0.0 { at.map(|along| (along / cell_m).floor()) } else { at };
        // Both zeros are one cell.
        let key = cell.map(|along| (along + 0.0).to_bits());
        let place = *cells.entry(key).or_insert_with(|| {
            places.push(Place { position: Position::ORIGIN, stops: 0 });
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
struct Sums {
    listed: u32,
    received: u64,
    sent: u64,
    rssi: f64,
    measured: f64,
}

fn node_links(log: &ReceptionLog, heard: HeardNode, places: &[Place], place_of: &[usize], reach_m: f64) -> NodeLinks {
    let mut sums: BTreeMap<usize, Sums> = BTreeMap::new();
    for Reception { stop, received, sent, rssi_dbm, .. } in log.of(heard.node).iter() {
        let sum = sums.entry(place_of[stop as usize]).or_default();
        sum.listed += 1;
        sum.received += u64::from(received);
        sum.sent += u64::from(sent);
        if let Some(rssi_dbm) = rssi_dbm.filter(|_| received > 0) {
            sum.rssi += rssi_dbm * f64::from(received);
            sum.measured += f64::from(received);
        }
    }
    let horizon_m = HORIZON * reach_m.max(heard.farthest_m);
    let within = places
        .iter()
        .enumerate()
        .filter(|(number, place)| sums.contains_key(number) || place.position.distance_m(heard.middle) <= horizon_m);
    let count = |packets: u64| u32::try_from(packets).unwrap_or(u32::MAX);
    let links = within.filter_map(|(number, place)| {
        let sum = sums.get(&number).copied().unwrap_or_default();
        // A pair that is not listed is one packet that was lost.
        let sent = sum.sent + u64::from(place.stops.saturating_sub(sum.listed));
        let rssi_dbm = (sum.measured > 0.0).then(|| sum.rssi / sum.measured);
        (sent > 0).then(|| Link { place: number, received: count(sum.received), sent: count(sent), rssi_dbm })
    });
    NodeLinks { links: links.collect(), heard }
}

impl NodeLinks {
    pub(super) fn node(&self) -> NodeId {
        self.heard.node
    }
}
