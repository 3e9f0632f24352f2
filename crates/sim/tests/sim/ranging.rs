//! Ranges that robots measure: when they come, to whom, from where, and behind obstacles.

use std::time::Duration;

use sextant_channel::{
    BoxConfig, IdealExchangeConfig, Obstacle, ObstacleConfig, ObstacleField, Position, RangeExchangeConfig,
    RangingDevice, RangingDeviceConfig, ShapeConfig,
};
use sextant_kernel::NodeId;
use sextant_sim::{
    DeathsConfig, FaultsConfig, Listening, Odometry, OdometryConfig, PeriodicConfig, Robot, RobotBody, Setup,
    Simulation, Survey, TrafficConfig, Unobserved,
};

use crate::network;

fn exact() -> RangingDeviceConfig {
    RangingDeviceConfig { noise_m: 0.0, excess_m: 0.0, ..RangingDeviceConfig::default() }
}

fn ideal(interval_s: f64) -> RangeExchangeConfig {
    RangeExchangeConfig::Ideal(IdealExchangeConfig { interval_s })
}

/// Twenty-five nodes in a square, and a robot that drives round it twice with such a device.
fn setup(device: RangingDeviceConfig, listening: Listening) -> Setup {
    let places: Vec<_> = (0..25).map(|i| Position::new(f64::from(i % 5), f64::from(i / 5), 0.0)).collect();
    let traffic = TrafficConfig::Beacon(PeriodicConfig::each(20, 0.5, 0.1));
    let corners = [[4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 0.0]].map(Position::from);
    let robot = network::tour([corners, corners].concat(), 0.25, Duration::from_secs(1));
    let robot = Robot { body: RobotBody { listening, ..robot.body }, ..robot };
    let setup = Setup { robots: vec![robot], ..network::setup(&places, -30.0, network::suburb(5.0), traffic, 3) };
    network::with(setup, |network| network.ranging = Some(RangingDevice::try_from(device).expect("good settings")))
}

fn survey(setup: Setup) -> Survey {
    Simulation::new(setup).expect("good settings").run(&mut Unobserved)
}

fn place(node: NodeId) -> Position {
    Position::new(f64::from(node.0 % 5), f64::from(node.0 / 5), 0.0)
}

#[test]
fn each_received_packet_brings_the_distance_from_where_the_robot_is() {
    for listening in [Listening::AtStops, Listening::AlsoWhileDriving] {
        let survey = survey(setup(exact(), listening));
        let log = survey.log();
        let packets: u32 = log.receptions().iter().map(|reception| reception.received).sum();
        assert!(packets > 100 && log.ranges().len() == packets as usize);
        for range in log.ranges() {
            let distance_m = range.position.distance_m(place(range.node));
            assert!((range.range_m - distance_m).abs() < 1e-9, "{range:?}");
        }
        let is_moving = |speed: f64| (speed - 1.0).abs() < 1e-6;
        let speeds = || log.ranges().iter().map(|range| range.velocity.distance_m(Position::ORIGIN));
        assert!(speeds().all(|speed| speed.abs() < 1e-12 || is_moving(speed)));
        assert_eq!(speeds().any(is_moving), listening == Listening::AlsoWhileDriving);
        // Each belongs to the stop at which it was measured.
        for (stop, range) in log.stops_of_ranges().into_iter().zip(log.ranges()) {
            assert!(log.at(range.node, stop).is_some_and(|reception| reception.received > 0), "{range:?}");
        }
    }
}

#[test]
fn ranges_without_frames_come_at_regular_times_from_the_nodes_that_live() {
    let device = RangingDeviceConfig { exchange: ideal(0.25), max_range_m: Some(3.0), ..exact() };
    let whole = survey(setup(device, Listening::AtStops));
    let log = whole.log();
    for node in (0..25).map(NodeId) {
        let near = log.stops().iter().filter(|stop| stop.position.distance_m(place(node)) <= 3.0).count();
        assert_eq!(log.ranges_to(node).len(), 4 * near, "{node:?}");
    }
    let deaths = Some(DeathsConfig { share: Some(1.0), names: None, from_s: 0.0, to_s: 5.0 });
    let faults = FaultsConfig { deaths, ..FaultsConfig::default() };
    let setup = setup(device, Listening::AtStops);
    let faults = faults.build(&setup.world.nodes, setup.seed).expect("good faults");
    let dying = survey(Setup { faults, ..setup });
    let last = dying.log().ranges().iter().map(|range| range.time.as_secs_f64()).fold(0.0, f64::max);
    assert!(!dying.log().ranges().is_empty() && last <= 5.0, "{last}");
}

#[test]
fn ranges_behind_an_obstacle_are_too_long_and_rarer() {
    let device = RangingDeviceConfig {
        exchange: ideal(0.01),
        noise_m: 0.01,
        excess_m: 2.0,
        dropout_behind_obstacles: Some(0.5),
        ..RangingDeviceConfig::default()
    };
    let wall = ObstacleConfig::of(
        ShapeConfig::Box(BoxConfig::new(Position::new(2.0, 2.0, 0.0), [1.5, 1.5, 2.0])),
        "concrete",
    );
    let mut setup = setup(device, Listening::AtStops);
    setup.world.obstacles = ObstacleField::new(vec![Obstacle::try_from(wall).expect("a box")]);
    let survey = survey(setup);
    // From the corner at the origin, the opposite corner is behind the wall, and the neighbour is not.
    let from_origin = |node: u32| -> Vec<f64> {
        let here = |range: &&sextant_channel::RangeSample| range.position.distance_m(Position::ORIGIN) < 1e-6;
        let ranges = survey.log().ranges_to(NodeId(node)).iter().filter(here);
        ranges.map(|range| range.range_m - place(NodeId(node)).distance_m(Position::ORIGIN)).collect()
    };
    let (clear, blocked) = (from_origin(1), from_origin(24));
    assert!(clear.iter().all(|error| error.abs() < 0.1));
    let mean = blocked.iter().sum::<f64>() / blocked.len() as f64;
    assert!((mean - 2.0).abs() < 0.7, "{mean} of {}", blocked.len());
    assert!(blocked.len() * 10 < clear.len() * 7, "{} of {}", blocked.len(), clear.len());
}

#[test]
fn places_of_ranges_are_those_that_the_robot_believes() {
    let odometry = OdometryConfig { heading_drift_rad_per_m: 0.05, ..OdometryConfig::default() };
    let mut setup = setup(exact(), Listening::AtStops);
    setup.robots[0].body.odometry = Odometry::try_from(odometry).expect("good settings");
    let survey = survey(setup);
    let log = survey.log();
    let off_m = |range: &sextant_channel::RangeSample| range.range_m - range.position.distance_m(place(range.node));
    assert!(log.ranges().iter().any(|range| off_m(range).abs() > 0.3));
    for (stop, range) in log.stops_of_ranges().into_iter().zip(log.ranges()) {
        assert!(log.stops()[stop as usize].position.distance_m(range.position) < 1e-9);
    }
}

#[test]
fn without_a_device_nothing_changes_and_nothing_is_measured() {
    let mut without = setup(exact(), Listening::AtStops);
    without.networks[0].ranging = None;
    let (without, with) = (survey(without), survey(setup(exact(), Listening::AtStops)));
    assert!(without.log().ranges().is_empty());
    assert_eq!(without.log().receptions(), with.log().receptions().to_vec());
    assert_eq!((without.events, without.packets), (with.events, with.packets));
}
