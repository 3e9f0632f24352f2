//! Random walks of targets.

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::Seed;
use sextant_sim::layout::{Region, RegionConfig};
use sextant_sim::{AtEnd, Leg, RandomWalkConfig, StraightConfig, TargetConfig, TargetMotionConfig, TurnConfig};

use super::{block, targets, watched, way, world};

fn walk(start: [f64; 3], region: RegionConfig) -> RandomWalkConfig {
    RandomWalkConfig {
        start_m: start.into(),
        speed_m_per_s: 1.5,
        straight: StraightConfig::MeanM(6.0),
        turn: TurnConfig::UniformDeg(60.0),
        region,
    }
}

fn square() -> RegionConfig {
    RegionConfig::Rectangle { min_m: Position::ORIGIN, max_m: Position::new(20.0, 20.0, 0.0) }
}

/// The first `count` legs of a walk.
fn legs(walk: &RandomWalkConfig, obstacles: &ObstacleField, seed: u64, count: usize) -> Vec<Leg> {
    let motion = TargetMotionConfig::RandomWalk(walk.clone());
    let mut course = targets(&[motion], obstacles)[0].course(Seed(seed));
    std::iter::from_fn(|| course.next_leg(obstacles)).take(count).collect()
}

#[test]
fn a_walk_stays_in_its_region_and_outside_obstacles_at_its_speed() {
    let letter_u =
        vec![[0.0, 0.0], [20.0, 0.0], [20.0, 20.0], [14.0, 20.0], [14.0, 6.0], [6.0, 6.0], [6.0, 20.0], [0.0, 20.0]];
    let regions = [
        square(),
        RegionConfig::Disc { center_m: Position::new(4.0, 4.0, 0.0), radius_m: 9.0 },
        RegionConfig::Polygon { corners_m: letter_u, z_m: 0.0 },
        RegionConfig::Ball { center_m: Position::new(4.0, 4.0, 0.0), radius_m: 9.0 },
        RegionConfig::Box { min_m: Position::new(0.0, 0.0, -3.0), max_m: Position::new(20.0, 20.0, 3.0) },
        RegionConfig::Cylinder { base_m: Position::new(4.0, 4.0, -4.0), radius_m: 9.0, height_m: 8.0 },
    ];
    let obstacles =
        ObstacleField::new(vec![block([9.0, 2.0, 0.0], [3.0, 2.0, 4.0]), block([2.0, 9.0, 0.0], [2.0; 3])]);
    for region in regions {
        let inside = Region::try_from(&region).unwrap();
        let walk = walk([2.0, 2.0, 0.0], region.clone());
        let (mut contacts, mut length_m) = (0, 0.0);
        for seed in 0..4 {
            let legs = legs(&walk, &obstacles, seed, 2000);
            assert_eq!(legs.len(), 2000);
            for pair in legs.windows(2) {
                assert_eq!((pair[0].to, pair[0].end), (pair[1].from, pair[1].start));
            }
            for leg in &legs {
                let span = (leg.end - leg.start).as_secs_f64();
                let leg_m = leg.from.distance_m(leg.to);
                assert!((span * 1.5 - leg_m).abs() < 1e-8, "{leg:?}");
                for share in [0.1, 0.37, 0.5, 0.9, 1.0] {
                    let place = leg.from + (leg.to - leg.from) * share;
                    assert!(inside.contains(place), "{place:?} of {leg:?} is outside {region:?}");
                    assert!(obstacles.containing(place).is_none(), "{place:?} of {leg:?} is inside an obstacle");
                }
                contacts += u32::from(obstacles.distance_m(leg.to) < 2e-3);
                length_m += leg_m;
            }
        }
        assert!(contacts > 20 && length_m > 8000.0, "{contacts} contacts on {length_m} m in {region:?}");
    }
}

#[test]
fn straight_pieces_and_turns_follow_their_laws() {
    let free = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 1e6 };
    let laws = [(TurnConfig::UniformDeg(60.0), 60.0 / 3.0_f64.sqrt()), (TurnConfig::NormalDeg(25.0), 25.0)];
    for (turn, sigma_deg) in laws {
        const COUNT: usize = 20_000;
        let walk = RandomWalkConfig { turn, ..walk([0.0; 3], free.clone()) };
        let legs = legs(&walk, &ObstacleField::default(), 5, COUNT);
        let mean_m = legs.iter().map(|leg| leg.from.distance_m(leg.to)).sum::<f64>() / COUNT as f64;
        let direction = |leg: &Leg| (leg.to.y_m - leg.from.y_m).atan2(leg.to.x_m - leg.from.x_m);
        let turns: Vec<f64> = legs
            .windows(2)
            .map(|pair| (direction(&pair[1]) - direction(&pair[0])).to_degrees())
            .map(|turn| (turn + 540.0).rem_euclid(360.0) - 180.0)
            .collect();
        let mean = turns.iter().sum::<f64>() / turns.len() as f64;
        let square = turns.iter().map(|turn| turn * turn).sum::<f64>() / turns.len() as f64;
        // Five standard errors each: a false alarm in 1.7 million.
        let root = (COUNT as f64).sqrt();
        assert!((mean_m - 6.0).abs() < 5.0 * 6.0 / root, "mean of {mean_m} m");
        assert!(mean.abs() < 5.0 * sigma_deg / root, "mean turn of {mean}°");
        // The squares of a normal number have the standard deviation √2 σ², those of a uniform number less.
        assert!((square / sigma_deg.powi(2) - 1.0).abs() < 5.0 * 2.0_f64.sqrt() / root, "mean square {square}");
    }
}

#[test]
fn a_turn_at_each_interval_comes_at_multiples_of_it() {
    let free = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 1e6 };
    let walk = RandomWalkConfig { straight: StraightConfig::EveryS(4.0), ..walk([0.0; 3], free) };
    for (i, leg) in legs(&walk, &ObstacleField::default(), 5, 100).iter().enumerate() {
        assert!((leg.end.as_secs_f64() - 4.0 * (i + 1) as f64).abs() < 1e-6);
    }
}

#[test]
fn a_target_at_the_border_is_reflected_like_light() {
    // Turns of 0.001 degrees at most: a billiard ball.
    let straight = StraightConfig::MeanM(1e5);
    let walk = RandomWalkConfig { straight, turn: TurnConfig::UniformDeg(1e-3), ..walk([3.0, 7.0, 0.0], square()) };
    let legs = legs(&walk, &ObstacleField::default(), 8, 50);
    let slope = |leg: &Leg| ((leg.to.y_m - leg.from.y_m) / (leg.to.x_m - leg.from.x_m)).abs();
    assert!(legs.iter().all(|leg| (slope(leg) / slope(&legs[0]) - 1.0).abs() < 1e-6));
}

#[test]
fn the_same_seed_gives_the_same_way_and_other_targets_do_not_change_it() {
    let motion = |start| TargetMotionConfig::RandomWalk(walk(start, square()));
    let (here, there) = (motion([2.0, 2.0, 0.0]), motion([9.0, 2.0, 0.0]));
    let nodes = [[5.0, 5.0, 0.0], [12.0, 8.0, 0.0]];
    let run = |motions: &[TargetMotionConfig], seed| watched(world(&nodes, motions, 4.0), 300.0, seed).1;
    let one = run(std::slice::from_ref(&here), 3);
    assert_eq!(one, run(std::slice::from_ref(&here), 3));
    assert_ne!(one, run(std::slice::from_ref(&here), 4));
    let two = run(&[here, there], 3);
    let of_first: Vec<_> = two.moved.into_iter().filter(|(target, ..)| target.0 == 0).collect();
    assert_eq!(of_first, one.moved);
}

#[test]
fn invalid_targets_are_rejected_with_their_key() {
    let obstacles = ObstacleField::new(vec![block([10.0, 10.0, 0.0], [4.0; 3])]);
    let refused = |motion: TargetMotionConfig| {
        TargetConfig { name: "intruder".into(), motion, screen: None }.build(0, &obstacles, Seed(1)).unwrap_err().key
    };
    let way = |places: &[[f64; 3]], speed| way(places, speed, AtEnd::Loop);
    let of_walk = |walk| refused(TargetMotionConfig::RandomWalk(walk));
    assert_eq!(refused(way(&[], 1.0)), "motion.waypoints.places_m");
    assert_eq!(refused(way(&[[0.0; 3], [10.0, 10.0, 0.0]], 1.0)), "motion.waypoints.places_m[1]");
    assert_eq!(refused(way(&[[0.0; 3], [20.0, 20.0, 0.0]], 1.0)), "motion.waypoints.places_m[1]");
    assert_eq!(refused(way(&[[0.0; 3], [9.0, 0.0, 0.0], [0.0; 3]], 1.0)), "motion.waypoints.places_m[0]");
    assert_eq!(refused(way(&[[0.0, f64::NAN, 0.0]], 1.0)), "motion.waypoints.places_m[0]");
    assert_eq!(refused(way(&[[0.0; 3], [1.0, 0.0, 0.0]], 0.0)), "motion.waypoints.speed_m_per_s");
    assert_eq!(of_walk(walk([10.0, 10.0, 0.0], square())), "motion.random_walk.start_m");
    assert_eq!(of_walk(walk([-1.0, 0.0, 0.0], square())), "motion.random_walk.start_m");
    let triangle = RegionConfig::Polygon { corners_m: vec![[0.0, 0.0], [9.0, 0.0], [0.0, 9.0]], z_m: 0.0 };
    assert_eq!(of_walk(walk([0.0, 3.0, 0.0], triangle)), "motion.random_walk.start_m");
    let good = walk([1.0, 1.0, 0.0], square());
    let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: -1.0 };
    assert_eq!(of_walk(RandomWalkConfig { region, ..good.clone() }), "motion.random_walk.region.disc.radius_m");
    let straight = StraightConfig::MeanM(0.0);
    assert_eq!(of_walk(RandomWalkConfig { straight, ..good.clone() }), "motion.random_walk.straight.mean_m");
    let turn = TurnConfig::NormalDeg(f64::NAN);
    assert_eq!(of_walk(RandomWalkConfig { turn, ..good }), "motion.random_walk.turn.normal_deg");
    let named = |name: &str| TargetConfig { name: name.into(), motion: way(&[[0.0; 3]], 1.0), screen: None };
    assert_eq!(named("a b").build(0, &obstacles, Seed(1)).unwrap_err().key, "name");
}
