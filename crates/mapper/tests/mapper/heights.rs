//! The heights at which nodes are searched for.

use sextant_channel::{Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, Seed};
use sextant_mapper::{
    AlgorithmConfig, EstimateKind, HeightReason, Mapper, MlTmConfig, ProfileConfig, SelfCalibratedConfig, TopologyMap,
};

/// Nothing is heard beyond this distance (m).
const RANGE_M: f64 = 6.0;

/// A survey of `nodes` nodes over 40 m by 40 m from stops 2 m apart whose heights differ by `uneven_m`.
fn survey(nodes: u32, uneven_m: f64) -> (ReceptionLog, Vec<Position>) {
    let draw = |address| Seed(5).uniform(Purpose::new(8), address);
    let stops: Vec<Stop> = (0..400_u32)
        .map(|i| {
            Stop::at(Position::new(
                2.0 * f64::from(i % 20),
                2.0 * f64::from(i / 20),
                uneven_m * draw([u64::from(i), 0, 0]),
            ))
        })
        .collect();
    let node = |i: u32| 38.0 * draw([u64::from(i), 1, 0]);
    let truth: Vec<Position> =
        (0..nodes).map(|i| Position::new(node(i), 38.0 * draw([u64::from(i), 2, 0]), 0.0)).collect();
    let mut receptions = Vec::new();
    for (node, place) in (0_u32..).zip(&truth) {
        for (stop, at) in (0_u32..).zip(&stops) {
            let p = 1.0 - place.distance_m(at.position) / RANGE_M;
            if draw([u64::from(node), u64::from(stop), 3]) < p {
                let node = NodeId(node);
                receptions.push(Reception::heard(node, stop, 1, 1));
            }
        }
    }
    let names = (0..nodes).map(|node| format!("n{node}")).collect();
    (ReceptionLog::new(names, stops, receptions, Vec::new()).expect("a log"), truth)
}

fn fitted(z_range_m: Option<[f64; 2]>) -> AlgorithmConfig {
    AlgorithmConfig::MlTm(MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        z_range_m,
        ..MlTmConfig::new(0.25, ProfileConfig::Fitted(Default::default()))
    })
}

fn map(config: AlgorithmConfig, log: &ReceptionLog) -> TopologyMap {
    Mapper::try_from(config).expect("good settings").map(log).expect("a small grid")
}

fn mean_error_m(map: &TopologyMap, truth: &[Position]) -> f64 {
    let errors = map.positions().into_iter().zip(truth).filter_map(|(place, truth)| Some(place?.distance_m(*truth)));
    errors.sum::<f64>() / map.mapped() as f64
}

#[test]
fn over_an_uneven_floor_344_nodes_are_mapped_in_one_plane() {
    let (uneven, truth) = survey(344, 0.05);
    for config in [fitted(None), AlgorithmConfig::SelfCalibrated(SelfCalibratedConfig::default())] {
        let found = map(config, &uneven);
        let heights = found.heights.expect("heights are chosen");
        let HeightReason::UnevenStops(span_m) = heights.reason else { panic!("{heights:?}") };
        assert!((span_m - 0.05).abs() < 0.001 && heights.low_m > 0.0 && heights.low_m < 0.05, "{heights:?}");
        assert!(found.positions().into_iter().flatten().all(|place| (place.z_m - heights.low_m).abs() < 1e-12));
        let error_m = mean_error_m(&found, &truth);
        assert!(found.mapped() > 330 && error_m < 0.3 * RANGE_M, "{} nodes, {error_m} m", found.mapped());
    }
}

#[test]
fn stops_at_one_height_are_level() {
    let (log, _) = survey(3, 0.0);
    for config in [fitted(None), AlgorithmConfig::SelfCalibrated(SelfCalibratedConfig::default())] {
        let heights = map(config, &log).heights.expect("heights are chosen");
        assert_eq!((heights.low_m, heights.high_m, heights.reason), (0.0, 0.0, HeightReason::LevelStops));
    }
}

#[test]
fn stops_at_several_heights_bound_the_heights_by_their_reach() {
    let (log, _) = survey(20, 2.0);
    for config in [fitted(None), AlgorithmConfig::SelfCalibrated(SelfCalibratedConfig::default())] {
        let found = map(config, &log);
        let heights = found.heights.expect("heights are chosen");
        assert_eq!(heights.reason, HeightReason::Reach);
        assert!(heights.low_m > -2.0 * RANGE_M && heights.high_m < 2.0 + 2.0 * RANGE_M, "{heights:?}");
        let places = found.positions().into_iter().flatten();
        assert!(places.clone().count() > 15);
        for place in places {
            assert!(place.z_m >= heights.low_m && place.z_m <= heights.high_m, "{place} beyond {heights:?}");
        }
    }
}

#[test]
fn settings_override_what_the_stops_say_of_heights() {
    for uneven_m in [0.0, 0.05, 2.0] {
        let (log, _) = survey(10, uneven_m);
        let set = Some([0.5, 1.5]);
        let calibrated = SelfCalibratedConfig { z_range_m: set, ..SelfCalibratedConfig::default() };
        for config in [fitted(set), AlgorithmConfig::SelfCalibrated(calibrated)] {
            let found = map(config, &log);
            let heights = found.heights.expect("heights are chosen");
            assert_eq!((heights.low_m, heights.high_m, heights.reason), (0.5, 1.5, HeightReason::Settings));
            assert!(found.positions().into_iter().flatten().all(|place| place.z_m >= 0.5 && place.z_m <= 1.5));
        }
    }
}

#[test]
fn a_few_raised_stops_do_not_lift_the_plane_of_all_nodes() {
    let (log, _) = survey(60, 0.0);
    let stops = log.stops().iter().enumerate().map(|(number, stop)| {
        let z_m = if number % 40 == 7 { 0.9 } else { -0.04 };
        Stop { position: Position::new(stop.position.x_m, stop.position.y_m, z_m), ..*stop }
    });
    let receptions = log.receptions().iter().collect();
    let log = ReceptionLog::new(log.names().to_vec(), stops.collect(), receptions, Vec::new()).expect("a log");
    let link_model = AlgorithmConfig::LinkModel(sextant_mapper::LinkModelConfig::default());
    // Half way between the lowest and the highest stop would be 0.43 m.
    for config in [fitted(None), link_model] {
        let found = map(config, &log);
        let reason = found.heights.expect("heights are chosen").reason;
        assert!(matches!(reason, HeightReason::UnevenStops(_)), "{reason:?}");
        assert!(found.positions().into_iter().flatten().all(|place| (place.z_m + 0.04).abs() < 1e-9));
    }
}
