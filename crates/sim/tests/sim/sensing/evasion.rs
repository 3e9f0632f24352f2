//! Targets that flee from robots.

use std::time::Duration;

use proptest::prelude::*;
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::Seed;
use sextant_sim::layout::{Region, RegionConfig};
use sextant_sim::{
    Application, EvadeConfig, Leg, Odometry, OdometryConfig, Port, RandomWalkConfig, RobotBody, Setup,
    StraightConfig, Target, TargetMotionConfig, TurnConfig, World,
};

use super::{Notebook, block, seconds, targets};
use crate::network;

const SPEED_M_PER_S: f64 = 1.5;

fn evade(start: [f64; 3], region: RegionConfig) -> EvadeConfig {
    EvadeConfig {
        start_m: start.into(),
        speed_m_per_s: SPEED_M_PER_S,
        sight_m: 8.0,
        decide_s: 0.5,
        straight: StraightConfig::MeanM(6.0),
        turn: TurnConfig::UniformDeg(60.0),
        region,
    }
}

fn square() -> RegionConfig {
    RegionConfig::Rectangle { min_m: Position::ORIGIN, max_m: Position::new(20.0, 20.0, 0.0) }
}

fn target(config: &EvadeConfig, obstacles: &ObstacleField) -> Target {
    targets(&[TargetMotionConfig::Evade(config.clone())], obstacles).remove(0)
}

#[test]
fn a_target_goes_straight_away_from_a_robot_in_sight() {
    let none = ObstacleField::default();
    let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 1e4 };
    let mut course = target(&evade([3.0, 4.0, 0.0], region), &none).course(Seed(1));
    // The second robot is in sight too, but farther away.
    let robots = [Position::new(30.0, 0.0, 0.0), Position::ORIGIN];
    for step in 1..=4 {
        let leg = course.next_leg_among(&none, &robots).expect("it goes on");
        // From 5 m, at 1.5 m/s and half a second a leg; beyond 8 m it does not see the robot.
        let distance_m = 5.0 + 0.75 * f64::from(step);
        assert!(leg.to.distance_m(Position::new(0.6, 0.8, 0.0) * distance_m) < 1e-9, "{leg:?}");
        assert_eq!(leg.end, seconds(0.5 * f64::from(step)));
    }
    let (mut alone, blind) = (course.clone(), course.next_leg_among(&none, &robots));
    assert_eq!(blind, alone.next_leg(&none));
}

#[test]
fn a_target_that_sees_nobody_walks_at_random() {
    let obstacles = ObstacleField::new(vec![block([9.0, 2.0, 0.0], [3.0, 2.0, 4.0])]);
    let EvadeConfig { start_m, speed_m_per_s, straight, turn, region, .. } = evade([2.0, 2.0, 0.0], square());
    let walk = RandomWalkConfig { start_m, speed_m_per_s, straight, turn, region };
    let mut walk = targets(&[TargetMotionConfig::RandomWalk(walk)], &obstacles)[0].course(Seed(5));
    let mut evasion = target(&evade([2.0, 2.0, 0.0], square()), &obstacles).course(Seed(5));
    // A robot out of sight.
    let robots = [Position::new(100.0, 0.0, 0.0)];
    let (mut longest, mut piece) = (Duration::ZERO, evasion.next_leg_among(&obstacles, &robots).unwrap());
    for _ in 0..40 {
        let leg = walk.next_leg(&obstacles).unwrap();
        while piece.end.as_secs_f64() < leg.end.as_secs_f64() - 1e-6 {
            longest = longest.max(piece.end - piece.start);
            assert!(piece.to.distance_m(leg.at(piece.end)) < 1e-6, "{piece:?} on {leg:?}");
            piece = evasion.next_leg_among(&obstacles, &robots).unwrap();
        }
    }
    assert_eq!(longest, Duration::from_millis(500));
}

#[test]
fn a_target_in_a_corner_waits_and_one_at_a_wall_goes_along_it() {
    let none = ObstacleField::default();
    let corner = 1e-6;
    let mut course = target(&evade([corner, corner, 0.0], square()), &none).course(Seed(1));
    let leg = course.next_leg_among(&none, &[Position::new(2.0, 2.0, 0.0)]).unwrap();
    let here = Position::new(corner, corner, 0.0);
    assert_eq!(leg, Leg { from: here, to: here, start: seconds(0.0), end: seconds(0.5) });
    let mut course = target(&evade([corner, 10.0, 0.0], square()), &none).course(Seed(1));
    let leg = course.next_leg_among(&none, &[Position::new(2.0, 9.0, 0.0)]).unwrap();
    // Straight away is through the wall; 15 degrees and more from there it is not.
    assert!(leg.to.y_m > 10.7 && leg.to.x_m < 0.2, "{leg:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn a_target_never_leaves_its_region_nor_enters_obstacles(
        seed: u64,
        shape in 0..4_usize,
        chaser in [0.0..20.0_f64, 0.0..20.0, -2.0..2.0],
    ) {
        let obstacles =
            ObstacleField::new(vec![block([9.0, 2.0, 0.0], [3.0, 2.0, 4.0]), block([2.0, 9.0, 0.0], [2.0; 3])]);
        let center_m = Position::new(4.0, 4.0, 0.0);
        let config = match shape {
            0 => square(),
            1 => RegionConfig::Disc { center_m, radius_m: 9.0 },
            2 => RegionConfig::Ball { center_m, radius_m: 9.0 },
            _ => RegionConfig::Box { min_m: Position::new(0.0, 0.0, -3.0), max_m: Position::new(20.0, 20.0, 3.0) },
        };
        let region = Region::try_from(&config).unwrap();
        let mut course = target(&evade([2.0, 2.0, 0.0], config), &obstacles).course(Seed(seed));
        let mut robot = Position::from(chaser);
        let (mut here, mut fled) = (Position::new(2.0, 2.0, 0.0), 0);
        for _ in 0..400 {
            let leg = course.next_leg_among(&obstacles, &[robot]).expect("it goes on for ever");
            prop_assert_eq!(leg.from, here);
            let (span_s, leg_m) = ((leg.end - leg.start).as_secs_f64(), leg.from.distance_m(leg.to));
            prop_assert!(span_s > 0.0 && span_s <= 0.5 + 1e-9, "{leg:?}");
            prop_assert!(leg_m <= 0.0 || (span_s * SPEED_M_PER_S - leg_m).abs() < 1e-8, "{leg:?}");
            prop_assert!(region.contains(leg.to) && obstacles.blocking(leg.from, leg.to).is_none(), "{leg:?}");
            if robot.distance_m(here) < 8.0 {
                // It never goes nearer to the only robot in sight.
                prop_assert!(robot.distance_m(leg.to) >= robot.distance_m(here), "{leg:?} from {robot:?}");
                fled += 1;
            }
            here = leg.to;
            // A chaser as fast as the target.
            let way = here - robot;
            let step_m = (SPEED_M_PER_S * span_s).min(way.length_m());
            if way.length_m() > 0.0 {
                robot = robot + way * (step_m / way.length_m());
            }
        }
        prop_assert!(fled > 20, "{fled} legs in flight");
    }
}

/// A robot that drives along the x axis and believes to drive less.
struct Straight;

impl Application for Straight {
    fn started(&mut self, port: &mut Port<'_>) {
        port.drive(Position::new(4.0, 0.0, 0.0));
    }
}

#[test]
fn a_target_flees_from_the_true_place_of_a_robot() {
    let direction = |scale_error| {
        let config = OdometryConfig { scale_error, ..OdometryConfig::default() };
        let odometry = Odometry::try_from(config).expect("good settings");
        let none = ObstacleField::default();
        let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 1e4 };
        // It stands nearly still as long as it sees nobody.
        let config =
            EvadeConfig { speed_m_per_s: 0.01, sight_m: 5.5, decide_s: 0.1, ..evade([10.0, 0.0, 0.0], region) };
        let world = World { targets: vec![target(&config, &none)], ..World::default() };
        let body = RobotBody { odometry, speed_m_per_s: 1.0, ..network::body("chaser", Position::ORIGIN) };
        let setup = Setup {
            robots: network::own_robots([body]),
            duration: Some(Duration::from_secs(60)),
            faults: Default::default(),
            ..Setup::of(world, network::link(1.0, network::prompt()), Seed(1))
        };
        let mut notebook = Notebook::default();
        network::run_watched(setup, vec![Straight], &mut notebook);
        let places: Vec<Position> = notebook.moved.iter().map(|&(.., place)| place).collect();
        let last = places.len() - 1;
        let step = places[last] - places[last - 100];
        step * (1.0 / step.length_m())
    };
    // The robot truly drives 4 m, and is never in sight of the target, or 5.2 m, and is: the target is about 5 m from it,
    // and has strayed by 0.1 m at most.
    let (stroll, flight) = (direction(0.0), direction(0.3));
    assert!(stroll.x_m < 0.999, "{stroll:?}");
    assert!(flight.x_m > 0.9995, "{flight:?}");
}

#[test]
fn an_evasion_is_written_as_in_a_scenario() {
    let text = "start_m = [2.0, 2.0]\nspeed_m_per_s = 1.5\nsight_m = 8.0\ndecide_s = 0.5\nstraight.mean_m = 6.0\n\
                turn.uniform_deg = 60.0\nregion.rectangle = { min_m = [0.0, 0.0], max_m = [20.0, 20.0] }\n";
    assert_eq!(toml::from_str::<EvadeConfig>(text).expect("an evasion"), evade([2.0, 2.0, 0.0], square()));
}

#[test]
fn invalid_evasions_are_refused_with_their_key() {
    let obstacles = ObstacleField::new(vec![block([10.0, 10.0, 0.0], [4.0; 3])]);
    let key = |config: EvadeConfig| {
        let motion = TargetMotionConfig::Evade(config);
        let target = sextant_sim::TargetConfig { name: "t".into(), motion, screen: None };
        target.build(0, &obstacles, Seed(1)).unwrap_err().key
    };
    let good = evade([1.0, 1.0, 0.0], square());
    assert_eq!(key(evade([10.0, 10.0, 0.0], square())), "motion.evade.start_m");
    assert_eq!(key(evade([-1.0, 1.0, 0.0], square())), "motion.evade.start_m");
    assert_eq!(key(EvadeConfig { sight_m: -1.0, ..good.clone() }), "motion.evade.sight_m");
    assert_eq!(key(EvadeConfig { decide_s: 0.0, ..good.clone() }), "motion.evade.decide_s");
    assert_eq!(key(EvadeConfig { speed_m_per_s: 0.0, ..good }), "motion.evade.speed_m_per_s");
}
