//! Logs that say little on the places of nodes, or err: nothing runs away, and each unreliable place has its concern.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed, Unwatched};
use sextant_mapper::{
    AlgorithmConfig, Area, AutoConfig, Calibration, Concern, EstimateKind, EstimatorFindings, FittedChannel,
    HeightReason, LinkModel, LinkModelConfig, MapError, Mapper, MlTmConfig, PlacePrior, ProfileConfig, Region,
    TopologyMap,
};

fn draw(address: [u64; 3]) -> f64 {
    Seed(11).uniform(Purpose::new(8), address)
}

/// `count` places in a box.
fn scattered(what: u64, count: u32, size_m: [f64; 3]) -> Vec<Position> {
    let along = |i: u32, axis: usize| size_m[axis] * draw([100 + what, u64::from(i), axis as u64]);
    (0..count).map(|i| Position::new(along(i, 0), along(i, 1), along(i, 2))).collect()
}

/// Packets received of ten, with the strength, for each node and stop: a margin of 22 dB a decade that is 0 at `reach_m`,
/// with 4 dB of shadowing of the link and 3 dB of fading.
fn log(stops: &[Position], nodes: &[Position], reach_m: f64) -> ReceptionLog {
    let link = |node: u32, stop: u32| {
        let normal = |i: u64| Seed(12).normal(Purpose::new(8), [u64::from(node), u64::from(stop), i]);
        let distance_m = nodes[node as usize].distance_m(stops[stop as usize]).max(0.3);
        let margin_db = -22.0 * (distance_m / reach_m).log10() + 4.0 * normal(0);
        let heard: Vec<f64> = (1..=10).map(|i| margin_db + 3.0 * normal(i)).filter(|margin| *margin > 0.0).collect();
        let received = u32::try_from(heard.len()).expect("ten at most");
        let rssi_dbm = (received > 0).then(|| heard.iter().sum::<f64>() / f64::from(received) - 90.0);
        Reception { rssi_dbm, ..Reception::heard(NodeId(node), stop, received, 10) }
    };
    with(stops, nodes.len(), link)
}

/// The log with an entry for each node and stop.
fn with(stops: &[Position], nodes: usize, link: impl Fn(u32, u32) -> Reception) -> ReceptionLog {
    let pairs = (0..nodes).flat_map(|node| (0..stops.len()).map(move |stop| (node, stop)));
    let number = |i: usize| u32::try_from(i).expect("a few");
    let receptions = pairs.map(|(node, stop)| link(number(node), number(stop))).collect();
    let stop = |&position: &Position| Stop::at(position);
    let names = (0..nodes).map(|node| format!("n{node}")).collect();
    ReceptionLog::new(names, stops.iter().map(stop).collect(), receptions, Vec::new()).expect("a log")
}

fn fitted() -> AlgorithmConfig {
    let config = MlTmConfig::new(0.25, ProfileConfig::Fitted(Default::default()));
    AlgorithmConfig::MlTm(MlTmConfig { estimate: EstimateKind::PosteriorMean, ..config })
}

fn calibrated() -> AlgorithmConfig {
    AlgorithmConfig::SelfCalibrated(Default::default())
}

fn strengths() -> AlgorithmConfig {
    AlgorithmConfig::RssGrid(sextant_mapper::RssGridConfig {
        grid_step_m: None,
        ranging: Default::default(),
        sensitivity_dbm: None,
        max_range_m: None,
        estimate: EstimateKind::PosteriorMean,
        z_range_m: None,
    })
}

fn map(config: AlgorithmConfig, log: &ReceptionLog) -> (TopologyMap, Option<EstimatorFindings>) {
    Mapper::try_from(config).expect("good settings").map_and_learn(log, &Unwatched).expect("a map")
}

/// The farthest that a node is from the nearest stop that heard it (m).
fn farthest_m(map: &TopologyMap, log: &ReceptionLog) -> f64 {
    let distance_m = |(node, place): (usize, Option<Position>)| {
        let heard = log.of(NodeId::from_index(node)).iter().filter(|reception| reception.received > 0);
        let place = place?;
        heard.map(|reception| log.stops()[reception.stop as usize].position.distance_m(place)).reduce(f64::min)
    };
    map.positions().into_iter().enumerate().filter_map(distance_m).fold(0.0, f64::max)
}

fn all_have(map: &TopologyMap, concern: Concern) -> bool {
    map.mapped() > 0 && map.concerns().filter(|&(_, of)| of == concern).count() == map.mapped()
}

#[test]
fn nodes_that_were_heard_alike_everywhere_have_no_evidence() {
    let nodes = scattered(1, 12, [20.0, 15.0, 0.0]);
    for size_m in [[20.0, 15.0, 0.0], [20.0, 15.0, 9.0]] {
        let stops = scattered(2, 20, size_m);
        let everywhere = with(&stops, nodes.len(), |node, stop| Reception::heard(NodeId(node), stop, 10, 10));
        for config in [fitted(), calibrated()] {
            let (map, learned) = map(config, &everywhere);
            assert!(all_have(&map, Concern::NoEvidence), "{:?}", map.concerns().collect::<Vec<_>>());
            assert!(farthest_m(&map, &everywhere) < 12.0);
            if let Some(calibration) = learned.as_ref().and_then(EstimatorFindings::get::<Calibration>) {
                assert!(!calibration.converged && calibration.curve_at_bound);
            }
        }
    }
}

#[test]
fn a_log_from_one_place_and_nodes_heard_once_have_no_evidence() {
    let nodes = scattered(3, 12, [10.0, 10.0, 0.0]);
    let one_place = log(&[Position::new(3.0, 4.0, 0.0); 15], &nodes, 8.0);
    let stops = scattered(4, 20, [10.0, 10.0, 0.0]);
    let heard_once = with(&stops, nodes.len(), |node, stop| Reception {
        rssi_dbm: (stop == node).then_some(-70.0),
        ..Reception::heard(NodeId(node), stop, u32::from(stop == node) * 7, 10)
    });
    for log in [one_place, heard_once] {
        for config in [fitted(), calibrated(), strengths()] {
            let name = format!("{config:?}");
            let (map, _) = map(config, &log);
            assert!(all_have(&map, Concern::NoEvidence), "{name}: {:?}", map.concerns().collect::<Vec<_>>());
            assert!(farthest_m(&map, &log) < 10.0, "{name}: {} m", farthest_m(&map, &log));
        }
    }
}

#[test]
fn no_node_leaves_the_reach_of_its_stops() {
    let nodes = scattered(5, 30, [20.0, 15.0, 0.0]);
    let line: Vec<Position> = (0..25).map(|i| Position::new(f64::from(i), 0.0, 0.0)).collect();
    let few = scattered(6, 3, [20.0, 15.0, 0.0]);
    let room = scattered(7, 25, [20.0, 15.0, 0.0]);
    // Two rooms a kilometre apart, each with nodes of its own.
    let beyond = |places: &[Position]| -> Vec<Position> {
        let moved = places.iter().map(|&place| place + Position::new(1000.0, 0.0, 0.0));
        places.iter().copied().chain(moved).collect()
    };
    let cases = [
        (line, nodes.clone(), 8.0),
        (few, nodes.clone(), 8.0),
        (room.clone(), nodes[..1].to_vec(), 8.0),
        (room.clone(), nodes.clone(), 60.0),
        (beyond(&room), beyond(&nodes), 8.0),
    ];
    for (stops, nodes, reach_m) in cases {
        let log = log(&stops, &nodes, reach_m);
        for config in [fitted(), calibrated(), strengths()] {
            let name = format!("{} stops, reach {reach_m} m: {config:?}", stops.len());
            let (map, _) = map(config, &log);
            assert!(farthest_m(&map, &log) < 25.0, "{name}: {} m", farthest_m(&map, &log));
        }
    }
}

#[test]
fn a_stop_with_a_wrong_place_far_away_moves_no_node() {
    let nodes = scattered(8, 30, [20.0, 15.0, 0.0]);
    let mut stops = scattered(9, 25, [20.0, 15.0, 0.0]);
    let sound = log(&stops, &nodes, 8.0);
    // A receiver without a fix reports the origin of the coordinates; the packets are those of its true place.
    stops[7] = Position::new(-480_000.0, -5_300_000.0, 0.0);
    let wrong = with(&stops, nodes.len(), |node, stop| {
        sound.of(NodeId(node)).iter().find(|entry| entry.stop == stop).expect("each pair has an entry")
    });
    for config in [fitted(), calibrated(), strengths()] {
        let (map, _) = map(config.clone(), &wrong);
        let errors_m =
            map.positions().into_iter().zip(&nodes).filter_map(|(place, node)| Some(place?.distance_m(*node)));
        let worst_m = errors_m.fold(0.0, f64::max);
        assert!(map.mapped() == 30 && worst_m < 25.0, "{config:?}: {worst_m} m");
    }
}

#[test]
fn nearly_level_stops_are_mapped_in_a_plane_and_others_within_reach() {
    let nodes = scattered(10, 30, [20.0, 15.0, 2.0]);
    for (tall_m, is_plane) in [(0.03, true), (0.2, true), (2.0, true), (8.0, false)] {
        let log = log(&scattered(11, 25, [20.0, 15.0, tall_m]), &nodes, 8.0);
        for config in [fitted(), calibrated(), strengths()] {
            let (map, _) = map(config.clone(), &log);
            let heights = map.heights.expect("heights are chosen");
            match heights.reason {
                HeightReason::UnevenStops(span_m) => assert!(is_plane && span_m <= tall_m, "{config:?}: {heights:?}"),
                reason => assert!(!is_plane && reason == HeightReason::Reach, "{config:?}: {heights:?}"),
            }
            assert!(heights.low_m > -20.0 && heights.high_m < 30.0, "{config:?}: {heights:?}");
        }
    }
}

#[test]
fn the_channel_is_found_in_the_strengths_and_a_log_without_them_is_refused() {
    let nodes = scattered(12, 60, [24.0, 24.0, 0.0]);
    let log = log(&scattered(13, 80, [24.0, 24.0, 0.0]), &nodes, 9.0);
    let (found, learned) = map(strengths(), &log);
    let learned = learned.expect("the channel");
    let channel: &FittedChannel = learned.get().expect("the channel");
    assert!(channel.converged, "{channel:?}");
    // 22 dB a decade; the strength is -90 dBm at 9 m; shadowing of 4 dB and fading of 3 dB.
    assert!((channel.exponent - 2.2).abs() < 0.5, "{channel:?}");
    let at_9_m = channel.tx_power_dbm - 10.0 * channel.exponent * 9.0_f64.log10();
    assert!((at_9_m + 90.0).abs() < 2.5, "{at_9_m} dBm: {channel:?}");
    assert!((channel.sigma_db - 5.0).abs() < 1.5 && (channel.sensitivity_dbm + 90.0).abs() < 1.5, "{channel:?}");
    let mean_m = |map: &TopologyMap| {
        let errors_m =
            map.positions().into_iter().zip(&nodes).map(|(place, node)| place.expect("heard").distance_m(*node));
        errors_m.sum::<f64>() / nodes.len() as f64
    };
    let (by_packets, _) = map(fitted(), &log);
    assert!(mean_m(&found) < mean_m(&by_packets), "{} m, {} m", mean_m(&found), mean_m(&by_packets));

    let without = log.receptions().iter().map(|reception| Reception { rssi_dbm: None, ..reception }).collect();
    let without = ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), without, Vec::new()).expect("a log");
    let refused = Mapper::try_from(strengths()).expect("good settings").map(&without).unwrap_err();
    assert!(matches!(refused, MapError::Missing { algorithm: "rss-grid", .. }), "{refused}");
    assert!(refused.to_string().contains("rssi_dbm"), "{refused}");
}

/// How many of the nodes are in their regions of 95 %.
fn held(map: &TopologyMap, nodes: &[Position]) -> usize {
    let regions =
        map.estimates.iter().map(|estimate| Region::of_95(estimate.as_ref().expect("heard")).expect("a region"));
    regions.zip(nodes).filter(|(region, node)| region.contains(**node)).count()
}

fn by_links() -> [AlgorithmConfig; 2] {
    [AlgorithmConfig::LinkModel(LinkModelConfig::default()), AlgorithmConfig::Auto(AutoConfig::default())]
}

#[test]
fn few_stops_leave_regions_as_wide_as_strengths_allow() {
    let nodes = scattered(20, 12, [20.0, 12.0, 0.0]);
    for stops in [vec![[3.0, 9.0]], vec![[3.0, 9.0], [0.0, 12.0]], vec![[3.0, 9.0], [0.0, 12.0], [6.0, 3.0]]] {
        let stops: Vec<Position> = stops.into_iter().map(|[x_m, y_m]| Position::new(x_m, y_m, 0.0)).collect();
        let log = log(&stops, &nodes, 60.0);
        for config in by_links() {
            let name = format!("{} stops, {config:?}", stops.len());
            let (map, _) = map(config, &log);
            assert!(all_have(&map, Concern::TooFew), "{name}: {:?}", map.concerns().collect::<Vec<_>>());
            assert!(held(&map, &nodes) >= 11, "{name}: {} of 12", held(&map, &nodes));
        }
    }
}

#[test]
fn a_node_whose_best_place_is_on_the_border_of_an_area_has_a_concern() {
    let nodes = scattered(21, 12, [20.0, 15.0, 0.0]);
    let stops: Vec<Position> =
        (0..48).map(|i| Position::new(3.0 * f64::from(i % 8), 3.0 * f64::from(i / 8), 0.0)).collect();
    let log = log(&stops, &nodes, 30.0);
    let model = LinkModel::try_from(LinkModelConfig::default()).expect("good settings");
    let edge = |high: [f64; 2]| -> Vec<usize> {
        let area = Area::rectangle([0.0, 0.0], high).expect("an area");
        let prior = PlacePrior::new(Some(area), None).expect("a prior");
        let (map, _) = model.map(&log, Some(&prior), &Unwatched).expect("a map");
        map.concerns().filter(|&(_, concern)| concern == Concern::AtEdge).map(|(node, _)| node.index()).collect()
    };
    let wrong = edge([10.0, 7.0]);
    let outside = (0..12).filter(|&node| nodes[node].x_m > 12.0 || nodes[node].y_m > 9.0);
    let missed: Vec<usize> = outside.filter(|node| !wrong.contains(node)).collect();
    assert!(missed.len() <= 2, "{missed:?} of {wrong:?}");
    assert!(edge([21.0, 15.0]).len() <= 4, "{:?}", edge([21.0, 15.0]));
}
