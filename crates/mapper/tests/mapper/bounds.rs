//! Logs with little evidence on the places of nodes: self-calibration keeps the nodes within reach of the stops that
//! heard them, and reports this.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{Calibration, SelfCalibrated, SelfCalibratedConfig, TopologyMap};

/// Links whose margin over the sensitivity falls with the logarithm of distance (standard deviations of the fading).
#[derive(Clone, Copy)]
struct Links {
    /// Margin at 1 m.
    margin: f64,
    /// Loss per e-fold distance.
    slope: f64,
    /// Standard deviation of the part that all packets of a link share.
    shadowing: f64,
    /// The same of a node and of a stop.
    offsets: f64,
    /// Packets of a node at a stop.
    packets: u32,
}

/// Links with heavy shadowing, as caused by walls.
const WALLS: Links = Links { margin: 3.0, slope: 0.8, shadowing: 1.5, offsets: 0.5, packets: 20 };

fn draw(address: [u64; 3]) -> f64 {
    Seed(7).uniform(Purpose::new(8), address)
}

/// `count` places in a rectangle, drawn under the address `what`.
fn scattered(what: u64, count: u32, width_m: f64, depth_m: f64) -> Vec<Position> {
    let along = |i: u32, axis: u64| draw([100 + what, u64::from(i), axis]);
    (0..count).map(|i| Position::new(width_m * along(i, 0), depth_m * along(i, 1), 0.0)).collect()
}

/// Stops every 2 m along a line, off it by up to `off_m`.
fn line(count: u32, off_m: f64) -> Vec<Position> {
    (0..count).map(|i| Position::new(2.0 * f64::from(i), off_m * draw([99, u64::from(i), 0]), 0.0)).collect()
}

/// What the nodes' packets do at each of `stops`, one way or another: an array of counts as in real logs.
fn log(stops: &[Position], nodes: &[Position], links: Links) -> ReceptionLog {
    let mut receptions = Vec::new();
    for (node, place) in (0_u32..).zip(nodes) {
        for (stop, at) in (0_u32..).zip(stops) {
            let normal =
                |what: u64, a: u32, b: u32| Seed(what).normal(Purpose::new(8), [u64::from(a), u64::from(b), what]);
            let fixed =
                links.shadowing * normal(1, node, stop) + links.offsets * (normal(2, node, 0) + normal(3, stop, 0));
            let margin = links.margin - links.slope * place.distance_m(*at).max(0.3).ln() + fixed;
            let is_heard = |packet: &u32| normal(4 + u64::from(*packet), node, stop) < margin;
            let received = u32::try_from((0..links.packets).filter(is_heard).count()).expect("a few packets");
            let node = NodeId(node);
            receptions.push(Reception::heard(node, stop, received, links.packets));
        }
    }
    let stop = |&position: &Position| Stop::at(position);
    let names = (0..nodes.len()).map(|node| format!("n{node}")).collect();
    ReceptionLog::new(names, stops.iter().map(stop).collect(), receptions, Vec::new()).expect("a log")
}

/// The map of `log`, after a look at what holds of any: no node is farther from a stop that heard it than all stops are
/// from each other, along an axis, nor far beyond what is heard if the stops are on one line; and nothing that is at
/// its bound has converged.
fn bounded(log: &ReceptionLog) -> (TopologyMap, Calibration) {
    let algorithm = SelfCalibrated::try_from(SelfCalibratedConfig::default()).expect("good settings");
    let (map, calibration) = algorithm.map(log, &Unwatched).expect("nobody interrupts");
    let calibration = calibration.expect("nodes were heard");
    let places = || log.stops().iter().map(|stop| stop.position);
    let longest_m = places().flat_map(|a| places().map(move |b| a.distance_m(b))).fold(0.0, f64::max);
    for (node, place) in (0_u32..).zip(map.positions()) {
        let Some(place) = place else { continue };
        for entry in log.of(NodeId(node)).iter().filter(|entry| entry.received > 0) {
            let from_m = place.distance_m(log.stops()[entry.stop as usize].position);
            assert!(from_m <= 1.5 * longest_m, "node {node} is {from_m} m from a stop that heard it");
        }
    }
    if !calibration.at_bound.is_empty() || calibration.curve_at_bound {
        assert!(!calibration.converged, "{:?}", calibration.at_bound);
    }
    for node in &calibration.at_bound {
        assert!(map.estimates[node.index()].is_some(), "{node:?} is at its bound and not on the map");
    }
    (map, calibration)
}

#[test]
fn nodes_far_from_all_stops_stay_within_reach_of_them_and_are_named() {
    let stops = scattered(0, 20, 10.0, 10.0);
    let nodes: Vec<Position> =
        scattered(1, 60, 10.0, 10.0).iter().map(|&p| p + Position::new(30.0, 0.0, 0.0)).collect();
    let links = Links { margin: 4.0, slope: 1.2, shadowing: 0.5, offsets: 0.3, packets: 16 };
    let (_, calibration) = bounded(&log(&stops, &nodes, links));
    assert!(!calibration.at_bound.is_empty() && !calibration.converged, "{:?}", calibration.at_bound);
}

#[test]
fn nodes_heard_at_a_few_stops_far_apart_stay_within_reach_of_them() {
    let links = Links { margin: -0.5, slope: 1.0, shadowing: 1.0, offsets: 0.5, packets: 3 };
    let (map, calibration) = bounded(&log(&scattered(2, 60, 40.0, 40.0), &scattered(3, 60, 40.0, 40.0), links));
    assert!(map.mapped() > 20 && calibration.curve.is_none(), "{} nodes heard", map.mapped());
    assert!(!calibration.at_bound.is_empty() && !calibration.converged, "{:?}", calibration.at_bound);
}

#[test]
fn a_curve_that_does_not_fall_within_the_survey_is_at_its_bound() {
    let flat = Links { margin: 0.6, slope: 0.0, shadowing: 1.0, offsets: 0.0, packets: 50 };
    let (_, calibration) = bounded(&log(&scattered(4, 15, 20.0, 20.0), &scattered(5, 80, 20.0, 20.0), flat));
    assert!(calibration.curve_at_bound && !calibration.converged);
}

#[test]
fn shadowing_of_links_few_stops_and_stops_on_a_line_push_no_node_out_of_reach() {
    let room = scattered(6, 60, 24.0, 12.0);
    for stops in [line(12, 0.05), line(12, 0.0), line(2, 0.0), scattered(7, 4, 24.0, 12.0)] {
        bounded(&log(&stops, &room, WALLS));
    }
    let huge = Links { margin: 2.0, slope: 1.2, shadowing: 3.0, offsets: 1.2, packets: 16 };
    bounded(&log(&scattered(8, 40, 30.0, 30.0), &scattered(9, 100, 30.0, 30.0), huge));
    // Nodes farther away are heard better.
    let inverted = Links { margin: 0.0, slope: -0.4, shadowing: 0.5, offsets: 0.3, packets: 50 };
    bounded(&log(&scattered(10, 15, 20.0, 20.0), &scattered(11, 80, 20.0, 20.0), inverted));
}

#[test]
fn in_a_survey_larger_than_the_reach_no_node_is_at_its_bound() {
    let stops: Vec<Position> =
        (0..400_u32).map(|i| Position::new(f64::from(i % 20), f64::from(i / 20), 0.0)).collect();
    let nodes: Vec<Position> =
        scattered(12, 40, 15.0, 15.0).iter().map(|&p| p + Position::new(2.0, 2.0, 0.0)).collect();
    let clear = Links { margin: 6.0, slope: 4.0, shadowing: 0.0, offsets: 0.0, packets: 4 };
    let (map, calibration) = bounded(&log(&stops, &nodes, clear));
    assert!(calibration.converged && calibration.at_bound.is_empty() && !calibration.curve_at_bound);
    let errors = map.positions().into_iter().zip(&nodes).map(|(place, node)| place.expect("heard").distance_m(*node));
    let worst_m = errors.fold(0.0, f64::max);
    assert!(worst_m < 1.0, "{worst_m} m");
}
