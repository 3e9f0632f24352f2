//! Self-calibrated maps of logs whose channel and obstacle only the tests know.

use std::sync::LazyLock;

use sextant_channel::{Contact, Position, Reception, ReceptionLog, Stop};
use sextant_kernel::{NodeId, Purpose, RobotId, Seed, SimTime, Unwatched};
use sextant_mapper::{
    AlgorithmConfig, Calibration, EstimateKind, Mapper, MlTmConfig, ObstacleKnowledge, ProfileConfig, Region,
    SelfCalibrated, SelfCalibratedConfig, TopologyMap,
};

/// Nothing is received farther away than this (m).
const RANGE_M: f64 = 8.0;
/// The obstacle is a square round the origin, half as wide (m).
const HALF_M: f64 = 3.0;
/// Standard deviations of the shadowing that a metre of the obstacle absorbs.
const ABSORPTION_PER_M: f64 = 2.0;

/// Step of the grids (m).
const STEP_M: f64 = 0.2;

/// The parameters of a survey.
#[derive(Clone, Copy)]
struct World {
    seed: u64,
    nodes: u32,
    /// Packets of a node at a stop.
    packets: u32,
    has_obstacle: bool,
    /// Height of the space that nodes are in (m); 0 for a plane.
    tall_m: f64,
    /// Whether the robot changes its height from lane to lane.
    climbs: bool,
}

const PLANE: World = World { seed: 1, nodes: 120, packets: 1, has_obstacle: true, tall_m: 0.0, climbs: false };

/// Φ(x) by the rational approximation 26.2.17 of Abramowitz and Stegun (1964), exact to 10⁻⁷: not the mapper's.
fn normal(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x.abs());
    let series = [0.319_381_530, -0.356_563_782, 1.781_477_937, -1.821_255_978, 1.330_274_429];
    let sum = series.iter().rev().fold(0.0, |sum, c| (sum + c) * t);
    let tail = (-0.5 * x * x).exp() * 0.398_942_280_4 * sum;
    if x >= 0.0 { 1.0 - tail } else { tail }
}

/// Length of the line within the obstacle (m).
fn chord_m(from: Position, to: Position) -> f64 {
    let way = to - from;
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (at, along) in [(from.x_m, way.x_m), (from.y_m, way.y_m)] {
        if along.abs() < 1e-12 {
            if at.abs() > HALF_M {
                return 0.0;
            }
        } else {
            let (a, b) = ((-HALF_M - at) / along, (HALF_M - at) / along);
            enter = enter.max(a.min(b));
            leave = leave.min(a.max(b));
        }
    }
    (leave - enter).max(0.0) * way.length_m()
}

/// Probability that a packet is received over a clear link.
fn clear(distance_m: f64) -> f64 {
    if distance_m > RANGE_M { 0.0 } else { 0.95 * normal(score(distance_m)) }
}

fn score(distance_m: f64) -> f64 {
    2.2 - 0.2 * distance_m
}

fn is_in_obstacle(place: Position, margin_m: f64) -> bool {
    place.x_m.abs() < HALF_M + margin_m && place.y_m.abs() < HALF_M + margin_m
}

impl World {
    /// Eight lanes over 20 m by 20 m; nodes within 16 m by 16 m.
    fn survey(&self) -> (ReceptionLog, Vec<Position>) {
        let draw = |address| Seed(self.seed).uniform(Purpose::new(8), address);
        let stop = |x_m, y_m, z_m| Stop {
            robot: RobotId(0),
            time: SimTime::ZERO,
            position: Position::new(x_m, y_m, z_m),
            heading_rad: None,
        };
        let mut stops = Vec::new();
        for lane in 0..8_u32 {
            for step in 0..20_u32 {
                let step = if lane % 2 == 0 { step } else { 19 - step };
                let z_m = if self.climbs && lane % 2 == 1 { self.tall_m } else { 0.0 };
                stops.push(stop(2.7 * f64::from(lane) - 9.45, f64::from(step) - 9.5, z_m));
            }
        }
        stops.retain(|stop| !(self.has_obstacle && is_in_obstacle(stop.position, 0.2)));
        let mut truth = Vec::new();
        for draft in 0_u64.. {
            let along = |axis| 16.0 * draw([draft, axis, 1]) - 8.0;
            let place = Position::new(along(0), along(1), self.tall_m * draw([draft, 2, 1]));
            if !(self.has_obstacle && is_in_obstacle(place, 0.05)) {
                truth.push(place);
            }
            if truth.len() == self.nodes as usize {
                break;
            }
        }
        let mut receptions = Vec::new();
        for (node, place) in (0..self.nodes).zip(&truth) {
            for (stop, at) in (0..).zip(&stops) {
                let distance_m = place.distance_m(at.position);
                let absorbed = if self.has_obstacle { ABSORPTION_PER_M * chord_m(*place, at.position) } else { 0.0 };
                let p = if distance_m > RANGE_M { 0.0 } else { 0.95 * normal(score(distance_m) - absorbed) };
                let is_heard = |packet: &u32| draw([u64::from(node), u64::from(stop), 2 + u64::from(*packet)]) < p;
                let received = (0..self.packets).filter(is_heard).count();
                receptions.push(Reception {
                    node: NodeId(node),
                    stop,
                    received: u32::try_from(received).expect("a few packets"),
                    sent: self.packets,
                    sector: None,
                    rssi_dbm: None,
                    snr_db: None,
                });
            }
        }
        let met = [[-HALF_M, 0.0], [HALF_M, 0.5], [0.3, HALF_M], [-0.4, -HALF_M]];
        let contact = |[x_m, y_m]: [f64; 2]| Contact {
            robot: RobotId(0),
            time: SimTime::ZERO,
            position: Position::new(x_m, y_m, 0.0),
        };
        let contacts = if self.has_obstacle { met.map(contact).to_vec() } else { Vec::new() };
        let names = (0..self.nodes).map(|node| format!("n{node}")).collect();
        (ReceptionLog::new(names, stops, receptions, contacts).expect("a log"), truth)
    }
}

/// Settings for tests of accuracy.
fn settings() -> SelfCalibratedConfig {
    SelfCalibratedConfig { grid_step_m: Some(STEP_M), ..SelfCalibratedConfig::default() }
}

fn calibrated(config: SelfCalibratedConfig, log: &ReceptionLog) -> (TopologyMap, Calibration) {
    let (map, calibration) =
        SelfCalibrated::try_from(config).expect("good settings").map(log, &Unwatched).expect("nobody interrupts");
    (map, calibration.expect("nodes were heard"))
}

/// The map of the plane by the settings for tests of accuracy.
static OF_PLANE: LazyLock<(TopologyMap, Calibration)> = LazyLock::new(|| calibrated(settings(), &PLANE.survey().0));

/// The posterior mean under a profile fitted to the log.
fn fitted(log: &ReceptionLog) -> TopologyMap {
    let config = MlTmConfig {
        estimate: EstimateKind::PosteriorMean,
        ..MlTmConfig::new(STEP_M, ProfileConfig::Fitted(Default::default()))
    };
    let mapper = Mapper::try_from(AlgorithmConfig::MlTm(config)).expect("good settings");
    mapper.map(log).expect("a small grid")
}

fn mean_error_m(map: &TopologyMap, truth: &[Position]) -> f64 {
    let errors = map
        .positions()
        .into_iter()
        .zip(truth)
        .map(|(place, truth)| place.expect("every node was heard").distance_m(*truth));
    errors.sum::<f64>() / truth.len() as f64
}

fn coverage(map: &TopologyMap, truth: &[Position]) -> f64 {
    let inside = map.estimates.iter().zip(truth).filter(|(estimate, truth)| {
        let estimate = estimate.as_ref().expect("every node was heard");
        Region::of_95(estimate).expect("there is a covariance").contains(**truth)
    });
    inside.count() as f64 / truth.len() as f64
}

#[test]
fn curve_obstacle_and_places_are_recovered_from_the_log_alone() {
    let (mut error_m, mut fitted_m, mut covered) = (0.0, 0.0, 0.0);
    let surveys = 2;
    for seed in 0..surveys {
        let (log, truth) = World { seed, packets: 2, ..PLANE }.survey();
        let (map, calibration) = calibrated(settings(), &log);
        error_m += mean_error_m(&map, &truth);
        covered += coverage(&map, &truth);
        fitted_m += mean_error_m(&fitted(&log), &truth);
        let curve = calibration.curve.expect("the log is rich");
        assert!((curve.range_m() - RANGE_M).abs() < 0.1 * RANGE_M, "{}", curve.range_m());
        let errors = (1..74).map(|i| 0.1 * f64::from(i)).map(|d| curve.probability(d) - clear(d));
        let root_mean_square = (errors.map(|error| error * error).sum::<f64>() / 73.0).sqrt();
        assert!(root_mean_square < 0.04, "the curve is {root_mean_square} off");

        assert_eq!(calibration.knowledge, ObstacleKnowledge::FromLog);
        let obstacles = calibration.obstacles.expect("there is an obstacle");
        let area_m2 = obstacles.sure_m2();
        assert!((area_m2 / (4.0 * HALF_M * HALF_M) - 1.0).abs() < 0.5, "{area_m2} m²");
        let line = |y_m: f64| obstacles.absorbed(Position::new(-6.0, y_m, 0.0), Position::new(6.0, y_m, 0.0));
        let across = [-2.0, -1.0, 0.0, 1.0, 2.0].map(line).iter().sum::<f64>() / 5.0;
        assert!(across > 1.2, "{across} standard deviations across the obstacle");
        for y_m in [-6.0, 6.0] {
            let beside = line(y_m);
            assert!(beside < 0.5, "{beside} standard deviations beside it");
        }
    }
    let [error_m, fitted_m, covered] = [error_m, fitted_m, covered].map(|sum: f64| sum / surveys as f64);
    assert!(error_m < 0.8 * fitted_m, "{error_m} m, fitted profile {fitted_m} m");
    // 240 nodes: a coverage of 0.95 has a standard deviation of 0.014, and the model is estimated too.
    assert!((covered - 0.95).abs() < 0.05, "{covered}");
}

#[test]
fn knowledge_of_obstacles_is_used_as_far_as_it_is_allowed() {
    let (log, truth) = PLANE.survey();
    let with = |obstacles| {
        let (map, calibration) = if obstacles == settings().obstacles {
            OF_PLANE.clone()
        } else {
            calibrated(SelfCalibratedConfig { obstacles, ..settings() }, &log)
        };
        assert_eq!(calibration.knowledge, obstacles);
        (mean_error_m(&map, &truth), calibration.obstacles)
    };
    let (blind_m, none) = with(ObstacleKnowledge::None);
    let (receptions_m, found) = with(ObstacleKnowledge::FromReceptions);
    assert!(none.is_none() && receptions_m < 0.8 * blind_m, "{receptions_m} m, without obstacles {blind_m} m");
    // Drives show where there is no obstacle, so that the obstacle is found only where no robot drove.
    let (_, known) = with(ObstacleKnowledge::FromLog);
    let on_lane = |map: Option<sextant_mapper::AbsorptionMap>| {
        let map = map.expect("there is an obstacle");
        map.absorbed(Position::new(-4.05, -9.0, 0.0), Position::new(-4.05, 9.0, 0.0))
    };
    assert!(on_lane(known).abs() < 1e-12 && on_lane(found) >= 0.0);
}

/// The same survey by two robots at the same time, each in its half: its log with their names, and the log that takes both
/// for one.
fn by_two_robots(log: &ReceptionLog) -> [ReceptionLog; 2] {
    let stops = log.stops();
    let of = |robot: u32| {
        let is_west = move |index: &usize| (stops[*index].position.x_m < 0.0) == (robot == 0);
        (0..stops.len()).filter(is_west).map(move |index| (RobotId(robot), index))
    };
    let (mut west, mut east) = (of(0), of(1));
    let mut order: Vec<(RobotId, usize)> = Vec::new();
    while order.len() < stops.len() {
        order.extend(west.next());
        order.extend(east.next());
    }
    let mut place = vec![0; stops.len()];
    for (i, &(_, index)) in order.iter().enumerate() {
        place[index] = u32::try_from(i).expect("a few stops");
    }
    let receptions: Vec<Reception> =
        log.receptions().iter().map(|r| Reception { stop: place[r.stop as usize], ..r }).collect();
    [true, false].map(|knows| {
        let stop = |&(robot, index): &(RobotId, usize)| Stop {
            robot: if knows { robot } else { RobotId(0) },
            ..stops[index]
        };
        let stops = order.iter().map(stop).collect();
        ReceptionLog::new(log.names().to_vec(), stops, receptions.clone(), log.contacts().to_vec()).expect("a log")
    })
}

#[test]
fn knowing_the_paths_of_two_robots_is_not_worse_than_not_knowing_them() {
    let [mut known_m, mut unknown_m, mut joined_m] = [0.0; 3];
    for seed in 20..23 {
        let (log, truth) = World { seed, packets: 2, ..PLANE }.survey();
        let [two, one] = by_two_robots(&log);
        let error = |obstacles, log: &ReceptionLog| {
            mean_error_m(&calibrated(SelfCalibratedConfig { obstacles, ..settings() }, log).0, &truth) / 3.0
        };
        known_m += error(ObstacleKnowledge::FromLog, &two);
        unknown_m += error(ObstacleKnowledge::FromReceptions, &two);
        joined_m += error(ObstacleKnowledge::FromLog, &one);
    }
    assert!(known_m < 1.02 * unknown_m, "{known_m} m with the paths, {unknown_m} m without");
    // Lines between the places of two robots cross the obstacle. They must not count as drives.
    assert!(joined_m > 1.2 * known_m, "{joined_m} m as if one robot had driven, {known_m} m");
}

#[test]
fn in_an_open_network_no_obstacle_is_found_and_the_map_is_as_good_as_with_a_fitted_profile() {
    let (mut error_m, mut fitted_m) = (0.0, 0.0);
    for seed in 10..12 {
        let (log, truth) = World { seed, has_obstacle: false, ..PLANE }.survey();
        let (map, calibration) = calibrated(settings(), &log);
        assert_eq!((calibration.knowledge, calibration.obstacles), (ObstacleKnowledge::FromLog, None));
        assert!(calibration.converged, "{} rounds", calibration.rounds);
        error_m += mean_error_m(&map, &truth) / 2.0;
        fitted_m += mean_error_m(&fitted(&log), &truth) / 2.0;
    }
    assert!(error_m < 1.05 * fitted_m, "{error_m} m, fitted profile {fitted_m} m");
}

#[test]
fn counts_of_packets_tell_more_than_one_packet() {
    let error = |packets| {
        let (log, truth) = World { seed: 3, packets, ..PLANE }.survey();
        mean_error_m(&calibrated(settings(), &log).0, &truth)
    };
    let (one, four) = (error(1), error(4));
    assert!(four < 0.75 * one, "{one} m with one packet a stop, {four} m with four");
}

#[test]
fn the_map_is_the_same_for_any_number_of_threads() {
    let (log, _) = World { nodes: 60, ..PLANE }.survey();
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads start");
        pool.install(|| calibrated(settings(), &log))
    };
    let (one, two) = (with(1), with(2));
    let bits = |map: &TopologyMap| -> Vec<[u64; 3]> {
        map.positions().into_iter().flatten().map(|place| <[f64; 3]>::from(place).map(f64::to_bits)).collect()
    };
    assert_eq!(bits(&one.0), bits(&two.0));
    assert_eq!(one, two);
}

#[test]
fn a_dead_stop_is_found_and_pairs_without_evidence_count_for_nothing() {
    let (log, truth) = PLANE.survey();
    let dead = 70;
    let change = |to: fn(Reception) -> Reception| {
        let receptions = log.receptions().iter().map(|entry| if entry.stop == dead { to(entry) } else { entry });
        let receptions = receptions.collect();
        ReceptionLog::new(log.names().to_vec(), log.stops().to_vec(), receptions, log.contacts().to_vec())
            .expect("a log")
    };
    let (map, calibration) = calibrated(settings(), &change(|entry| Reception { received: 0, ..entry }));
    assert!(calibration.efficiency[dead as usize] < 0.45, "{}", calibration.efficiency[dead as usize]);
    let mut others = calibration.efficiency.clone();
    others.swap_remove(dead as usize);
    let least = others.into_iter().fold(f64::INFINITY, f64::min);
    assert!(least > 0.6, "a stop that works has {least}");
    let unknown = change(|entry| Reception { received: 0, sent: 0, ..entry });
    let (silent, calibration) = calibrated(settings(), &unknown);
    assert!(calibration.efficiency[dead as usize] > 0.8, "{}", calibration.efficiency[dead as usize]);
    let whole = mean_error_m(&OF_PLANE.0, &truth);
    for map in [map, silent] {
        assert!(mean_error_m(&map, &truth) < 1.2 * whole);
    }
}

#[test]
fn in_space_obstacles_are_searched_for_only_if_all_stops_have_one_height() {
    for (climbs, knowledge) in [(true, ObstacleKnowledge::None), (false, ObstacleKnowledge::FromLog)] {
        let (log, truth) = World { nodes: 60, packets: 2, tall_m: 2.0, climbs, ..PLANE }.survey();
        let z_range_m = Some([0.0, 2.0]);
        let (map, calibration) =
            calibrated(SelfCalibratedConfig { z_range_m, grid_step_m: Some(0.4), ..settings() }, &log);
        assert_eq!(calibration.knowledge, knowledge);
        assert_eq!(calibration.obstacles.is_some(), !climbs);
        // The middle of the stops that heard a node, weighted by packets.
        let middle = |node: usize| {
            let heard = log.of(NodeId::from_index(node)).iter().map(|entry| (entry.stop, f64::from(entry.received)));
            let place = |(stop, packets): (u32, f64)| log.stops()[stop as usize].position * packets;
            let packets: f64 = heard.clone().map(|(_, packets)| packets).sum();
            heard.map(place).fold(Position::ORIGIN, |sum, place| sum + place) * (1.0 / packets)
        };
        let middles_m: f64 = (0..truth.len()).map(|node| middle(node).distance_m(truth[node])).sum();
        let error_m = mean_error_m(&map, &truth);
        assert!(error_m < 0.75 * middles_m / 60.0, "{error_m} m, middles of stops {} m", middles_m / 60.0);
        assert!(map.positions().into_iter().flatten().all(|place| place.z_m >= 0.0 && place.z_m <= 2.0));
    }
}

#[test]
fn logs_with_little_evidence_are_mapped_as_well_as_possible() {
    let algorithm = SelfCalibrated::try_from(SelfCalibratedConfig::default()).expect("good settings");
    let stop = |x_m, y_m| Stop {
        robot: RobotId(0),
        time: SimTime::ZERO,
        position: Position::new(x_m, y_m, 0.0),
        heading_rad: None,
    };
    let heard = |node, stop| Reception {
        node: NodeId(node),
        stop,
        received: 1,
        sent: 1,
        sector: None,
        rssi_dbm: None,
        snr_db: None,
    };
    let names = |count| (0..count).map(|node| format!("n{node}")).collect::<Vec<_>>();
    let log = |nodes, stops: Vec<Stop>, receptions| {
        ReceptionLog::new(names(nodes), stops, receptions, Vec::new()).expect("a log")
    };
    // An empty log, no stops, no nodes, nothing heard.
    for log in [
        log(0, vec![], vec![]),
        log(3, vec![], vec![]),
        log(0, vec![stop(0.0, 0.0)], vec![]),
        log(3, vec![stop(0.0, 0.0); 4], vec![]),
    ] {
        let (map, calibration) = algorithm.map(&log, &Unwatched).unwrap();
        assert_eq!((map.mapped(), calibration), (0, None));
    }
    // One reception; one node heard along a line; all stops in one place, and one that heard nothing.
    let line: Vec<Stop> = (0..12).map(|i| stop(f64::from(i), 0.0)).collect();
    let logs = [
        log(2, vec![stop(2.0, 1.0)], vec![heard(1, 0)]),
        log(1, line.clone(), (3..9).map(|stop| heard(0, stop)).collect()),
        log(2, vec![stop(1.0, 1.0); 9], (0..8).flat_map(|stop| [heard(0, stop), heard(1, stop)]).collect()),
    ];
    for (log, mapped) in logs.iter().zip([1, 1, 2]) {
        let (map, calibration) = algorithm.map(log, &Unwatched).unwrap();
        let calibration = calibration.expect("something was heard");
        assert_eq!((map.mapped(), calibration.efficiency.len()), (mapped, log.stops().len()));
        assert!(map.positions().into_iter().flatten().all(Position::is_finite));
        assert!(calibration.curve.is_none_or(|curve| curve.probabilities().iter().all(|p| (0.0..=1.0).contains(p))));
    }
    let (map, _) = algorithm.map(&logs[1], &Unwatched).unwrap();
    let place = map.positions()[0].expect("it was heard");
    assert!((place.x_m - 5.5).abs() < 0.5, "{place:?}");
    assert_eq!(algorithm.map(&logs[0], &Unwatched).unwrap().1.expect("something was heard").curve, None);
}

#[test]
fn the_mapper_returns_what_was_learned() {
    let (log, _) = World { nodes: 40, ..PLANE }.survey();
    let mapper =
        Mapper::try_from(AlgorithmConfig::SelfCalibrated(SelfCalibratedConfig::default())).expect("good settings");
    assert_eq!(mapper.name(), "self-calibrated");
    let (map, learned) = mapper.map_and_learn(&log, &Unwatched).expect("a small grid");
    assert_eq!(map.algorithm, "self-calibrated");
    assert!(learned.unwrap().get::<Calibration>().unwrap().curve.is_some());
    let bad = SelfCalibratedConfig { max_rounds: 0, ..SelfCalibratedConfig::default() };
    let error = Mapper::try_from(AlgorithmConfig::SelfCalibrated(bad)).expect_err("no rounds");
    assert_eq!(error.key, "self_calibrated.max_rounds");
}
