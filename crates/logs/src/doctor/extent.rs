//! Surveys that are too small, or strengths that are too large for their distances: places in other units than metres.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;
use sextant_kernel::text::counted;

use super::finding::Finding;
use crate::place::distance::plane_m;

/// The diagonal of a survey of several places is at least this (m).
const LEAST_M: f64 = 0.3;
const LEAST_PLACES: usize = 5;
/// Loss over one metre of free space at 433 MHz (dB), the lowest usual band: 20 lg(4π / λ) (Friis 1946).
const LOSS_AT_ONE_METRE_DB: f64 = 25.2;
/// Transmit power and gains of both antennas are at most this together (dBm): 36 dBm radiated is the most that is allowed
/// in any usual band (47 CFR 15.247).
const MOST_DBM: f64 = 40.0;
/// Of each node so many of the strongest stops are compared.
const STRONGEST: usize = 50;
/// So many nodes must agree, or all.
const LEAST_NODES: usize = 3;
/// And one in so many of them. Most nodes of a large log are hotspots of passers-by, heard at few stops, which tell no unit; one or
/// two that are heard everywhere are those that the surveyor carries.
const ONE_IN: usize = 30;

/// What is odd of the units of places.
pub(super) fn finding(log: &ReceptionLog) -> Option<Finding> {
    too_small(log).or_else(|| too_large(log))
}

fn too_small(log: &ReceptionLog) -> Option<Finding> {
    let mut places: Vec<[f64; 3]> = log.stops().iter().map(|stop| stop.position.into()).collect();
    places.sort_by(|a, b| a.map(f64::to_bits).cmp(&b.map(f64::to_bits)));
    places.dedup_by_key(|place| place.map(f64::to_bits));
    let along = |axis: usize| {
        let values = places.iter().map(|place| place[axis]);
        let [low, high] =
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], at| [low.min(at), high.max(at)]);
        high - low
    };
    if places.len() < LEAST_PLACES {
        return None;
    }
    let extent_m = libm::hypot(libm::hypot(along(0), along(1)), along(2));
    (extent_m < LEAST_M).then(|| Finding {
        check: "extent",
        odd: format!("all {} places of the survey are within {extent_m:.3} m", places.len()),
        cost: "the map is as many times too small as the survey".to_owned(),
        remedy: "places need metres: multiply those in kilometres by 1000; degrees belong into `lat` and `lon`"
            .to_owned(),
    })
}

fn too_large(log: &ReceptionLog) -> Option<Finding> {
    let all = Needed::of_nodes(log);
    let least = LEAST_NODES.min(log.node_count()).max(all.len().div_ceil(ONE_IN));
    let strong: Vec<&Needed> = all.iter().filter(|needed| needed.power_dbm > MOST_DBM).collect();
    let Needed { node, power_dbm, strength_dbm, apart_m } = strong.last().filter(|_| strong.len() >= least)?;
    let are = if strong.len() == 1 { "is" } else { "are" };
    Some(Finding {
        check: "extent",
        odd: format!(
            "{} of {} {are} heard so well so far apart that even free space takes more than {MOST_DBM:.0} dBm: {} with \
             {strength_dbm:.0} dBm or more at two places {apart_m:.0} m from each other, which takes a transmitter of {power_dbm:.0} \
             dBm",
            strong.len(),
            counted(all.len(), "node"),
            log.names()[node.index()]
        ),
        cost: "the map is as many times too large as the survey, or distances from strengths are wrong".to_owned(),
        remedy:
            "places need metres: divide those in centimetres by 100, those in millimetres by 1000; strengths need dBm"
                .to_owned(),
    })
}

/// The least power with which the usual node can have been heard as it was (dBm): the median over nodes. `None` if few nodes tell it.
pub(super) fn needed_power_dbm(log: &ReceptionLog) -> Option<f64> {
    let all = Needed::of_nodes(log);
    let is_told = all.len() >= LEAST_NODES.min(log.node_count());
    all.get(all.len() / 2).filter(|_| is_told).map(|needed| needed.power_dbm)
}

/// The least power with which a node can have been heard as it was, and the strength and the distance between two stops
/// that tell it: one of the two is at least half as far from the node.
struct Needed {
    node: NodeId,
    power_dbm: f64,
    strength_dbm: f64,
    apart_m: f64,
}

impl Needed {
    /// Those of all nodes that tell it, from the least power.
    fn of_nodes(log: &ReceptionLog) -> Vec<Self> {
        let mut needed: Vec<Self> =
            (0..log.node_count()).filter_map(|node| needed(log, NodeId::from_index(node))).collect();
        needed.sort_by(|a, b| a.power_dbm.total_cmp(&b.power_dbm));
        needed
    }
}

fn needed(log: &ReceptionLog, node: NodeId) -> Option<Needed> {
    let place = |stop: u32| log.stops()[stop as usize].position;
    let heard = log.of(node).iter().filter(|reception| reception.received > 0);
    let mut heard: Vec<(f64, Position)> =
        heard.filter_map(|reception| Some((reception.rssi_dbm?, place(reception.stop)))).collect();
    heard.retain(|(strength_dbm, _)| *strength_dbm < 0.0);
    heard.sort_by(|a, b| b.0.total_cmp(&a.0));
    heard.truncate(STRONGEST);
    let mut most: Option<Needed> = None;
    for (number, (weaker_dbm, at)) in heard.iter().enumerate() {
        // Of the stronger ones, the farthest needs the most power.
        let square = |other: Position| (at.x_m - other.x_m).powi(2) + (at.y_m - other.y_m).powi(2);
        let stronger = heard[..number].iter().map(|(_, other)| *other);
        let Some(farthest) = stronger.max_by(|a, b| square(*a).total_cmp(&square(*b))) else { continue };
        let apart_m = plane_m(*at, farthest);
        let power_dbm = weaker_dbm + 20.0 * libm::log10((0.5 * apart_m).max(1e-9)) + LOSS_AT_ONE_METRE_DB;
        if most.as_ref().is_none_or(|most| power_dbm > most.power_dbm) {
            most = Some(Needed { node, power_dbm, strength_dbm: *weaker_dbm, apart_m });
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use sextant_channel::{Reception, Stop};

    use super::*;
    use crate::doctor::tests::{changed, lanes, node};

    #[test]
    fn centimetres_are_found_among_many_nodes_that_tell_no_unit() {
        // Four access points in a hall of 50 m, and a hundred hotspots that are heard at three stops of one room each.
        let places: Vec<Position> = (0..77).map(|i| lanes()[i] * 2.5).collect();
        let rows = |node: u32, level: &dyn Fn(Position) -> Option<f64>| {
            let heard = (0_u32..).zip(&places).filter_map(|(stop, at)| Some((stop, level(*at)?)));
            let row = |(stop, dbm)| Reception { rssi_dbm: Some(dbm), ..Reception::heard(NodeId(node), stop, 1, 1) };
            heard.map(row).collect::<Vec<Reception>>()
        };
        let access_point = |number: u32| {
            let from = node(number) * 2.5;
            rows(number, &|at| Some(-25.0 - 15.0 * libm::log10(from.distance_m(at).max(1.0))))
        };
        let hotspot = |number: u32| {
            let from = places[(number % 77) as usize];
            rows(number, &|at| (from.distance_m(at) < 5.5).then(|| -75.0 - from.distance_m(at)))
        };
        let receptions = (0..4).flat_map(access_point).chain((4..104).flat_map(hotspot)).collect();
        let names = (0..104).map(|number| format!("n{number}")).collect();
        let stops = places.iter().map(|place| Stop::at(*place)).collect();
        let log = ReceptionLog::new(names, stops, receptions, Vec::new()).unwrap();
        assert_eq!(finding(&log), None);
        let centimetres = changed(&log, |stop| Stop { position: stop.position * 100.0, ..stop }, |row| row);
        let found = finding(&centimetres).unwrap();
        assert!(found.odd.starts_with("4 of 104 nodes are heard so well so far apart"), "{found}");
        // A phone of the surveyor alone says nothing.
        let names = |node: NodeId| node.0 == 0 || node.0 >= 4;
        let rows = centimetres.receptions().iter().filter(|row| names(row.node)).collect();
        let one =
            ReceptionLog::new(centimetres.names().to_vec(), centimetres.stops().to_vec(), rows, Vec::new()).unwrap();
        assert_eq!(finding(&one), None);
    }
}
