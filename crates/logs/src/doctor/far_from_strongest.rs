//! Nodes that are mapped far from where they are heard strongest, beside stops that hear them far weaker.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::finding::Finding;
use crate::place::distance::plane_m;
use sextant_kernel::text::{counted, listed};

/// A node that was heard with a strength at fewer stops says nothing.
const LEAST: usize = 5;
/// It is far if its strongest stop is farther than its nearest by this share of the usual link, and so many of its nearest stops
/// hear it weaker by this (dB) in the median.
const FAR: f64 = 0.5;
const NEAREST: usize = 3;
const WEAKER_DB: f64 = 10.0;
/// One node may stand behind a wall.
const SEVERAL: usize = 2;

/// The stops that heard a node: where, and how strong (dBm).
type HeardLevels = Vec<(Position, f64)>;

/// What is odd of the `places` of a map of `log`.
pub(super) fn finding(log: &ReceptionLog, places: &[Option<Position>]) -> Option<Finding> {
    let of_node = |node: usize| {
        let place = (*places.get(node)?)?;
        let rows = log.of(NodeId::from_index(node));
        let rows = rows.iter().filter(|row| row.received > 0);
        let heard: HeardLevels =
            rows.filter_map(|row| Some((log.stops()[row.stop as usize].position, row.rssi_dbm?))).collect();
        (heard.len() >= LEAST).then_some((node, place, heard))
    };
    let nodes: Vec<(usize, Position, HeardLevels)> = (0..log.node_count()).filter_map(of_node).collect();
    let links: Vec<f64> = nodes.iter().filter_map(|(.., heard)| ln_link(heard)).collect();
    let usual_m = libm::exp(links.iter().sum::<f64>() / links.len() as f64);
    let far: Vec<String> = nodes
        .iter()
        .filter_map(|(node, place, heard)| {
            let apart_m = far_m(*place, heard, usual_m)?;
            Some(format!("{} ({apart_m:.1} m)", log.names()[*node]))
        })
        .collect();
    (far.len() >= SEVERAL).then(|| Finding {
        check: "far-from-strongest",
        odd: format!(
            "{} of {} are mapped far from where they are heard strongest, beside stops that hear them {WEAKER_DB:.0} dB weaker or \
             less: {}",
            far.len(),
            counted(nodes.len(), "node"),
            listed(&far)
        ),
        cost: "the map explains their strengths by something else than distance, and may be wrong about it".to_owned(),
        remedy: "compare with `algorithm=strongest-stop`, and trust places on which both agree".to_owned(),
    })
}

/// The strongest of the stops that heard a node.
fn strongest(heard: &HeardLevels) -> Option<(Position, f64)> {
    heard.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1))
}

/// The mean logarithm of the distances of the stops that heard a node from its strongest.
fn ln_link(heard: &HeardLevels) -> Option<f64> {
    let (middle, _) = strongest(heard)?;
    let distances = heard.iter().map(|(at, _)| plane_m(*at, middle)).filter(|distance_m| *distance_m > 0.0);
    let logs: Vec<f64> = distances.map(libm::log).collect();
    (!logs.is_empty()).then(|| logs.iter().sum::<f64>() / logs.len() as f64)
}

/// How far `place` is from the strongest stop, if that is far (m). Links are `usual_m` long.
fn far_m(place: Position, heard: &HeardLevels, usual_m: f64) -> Option<f64> {
    let (best, best_dbm) = strongest(heard)?;
    let mut by_distance: Vec<(f64, f64)> =
        heard.iter().map(|(at, level_dbm)| (plane_m(*at, place), *level_dbm)).collect();
    by_distance.sort_by(|a, b| a.0.total_cmp(&b.0));
    let apart_m = plane_m(place, best);
    let mut near_dbm: Vec<f64> = by_distance.iter().take(NEAREST).map(|(_, level_dbm)| *level_dbm).collect();
    near_dbm.sort_by(f64::total_cmp);
    let weaker_db = best_dbm - near_dbm[near_dbm.len() / 2];
    (apart_m - by_distance[0].0 > FAR * usual_m && weaker_db > WEAKER_DB).then_some(apart_m)
}
