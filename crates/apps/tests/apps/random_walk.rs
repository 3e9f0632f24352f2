//! Random walks.

use sextant_apps::{RandomWalk, RandomWalkConfig, Surroundings};
use sextant_channel::{ObstacleField, Position};
use sextant_kernel::Seed;
use sextant_sim::Ending;
use sextant_sim::layout::{Region, RegionConfig};

use crate::world::{Trace, World, field};

fn at(x_m: f64, y_m: f64) -> Position {
    Position::new(x_m, y_m, 0.0)
}

/// A world with one node, which is too far away to be heard.
fn silent(field: ObstacleField) -> World {
    World { field, nodes: vec![at(1e6, 0.0)], robot_radius_m: 0.2, reach_m: 5.0, fading: None }
}

fn walk(world: &World, config: &RandomWalkConfig, start: Position, seed: u64, robot: u64) -> Trace {
    let surroundings = Surroundings { seed: Seed(seed), robot, ..world.surroundings(start) };
    world.survey(&mut RandomWalk::plan(config, &surroundings).expect("settings"), start, 1)
}

#[test]
fn the_mean_square_distance_of_a_free_walk_is_the_number_of_steps() {
    // R²/n of n steps in random directions has mean 1 and, nearly exponential, deviation 1: the mean of 400 walks is within
    // 0.25, five standard errors, but for one seed in 1.7 million.
    let world = silent(ObstacleField::default());
    for (region, steps_per_turn) in [(None, 1), (None, 4)] {
        let config = RandomWalkConfig { max_steps: 60, region, steps_per_turn, ..RandomWalkConfig::default() };
        let mut sum = 0.0;
        for seed in 0..400 {
            let trace = walk(&world, &config, at(0.0, 0.0), seed, 0);
            assert_eq!((trace.ending, trace.stops.len()), (Ending::StepsExhausted, 61));
            let end = trace.stops[60];
            // A straight run of k steps is one step of k metres. The mean square distance after n/k such steps is n
            // k.
            sum += end.dot(end) / (60.0 * f64::from(steps_per_turn));
        }
        assert!((sum / 400.0 - 1.0).abs() < 0.25, "{} at {steps_per_turn}", sum / 400.0);
    }
}

#[test]
fn a_walk_in_space_goes_as_far_along_each_axis() {
    // Sums of squares of n coordinates, each of mean n/3: 300 walks of 60 steps; five standard errors are 5 √(2/300).
    let world = silent(ObstacleField::default());
    let region = RegionConfig::Ball { center_m: Position::ORIGIN, radius_m: 1e3 };
    let config = RandomWalkConfig { max_steps: 60, region: Some(region), ..RandomWalkConfig::default() };
    let mut sums = [0.0; 3];
    for seed in 0..300 {
        let end = walk(&world, &config, Position::ORIGIN, seed, 0).stops[60];
        for (sum, coordinate) in sums.iter_mut().zip(<[f64; 3]>::from(end)) {
            *sum += coordinate * coordinate / (20.0 * 300.0);
        }
    }
    assert!(sums.iter().all(|sum| (sum - 1.0).abs() < 0.41), "{sums:?}");
}

#[test]
fn a_walk_stays_in_its_region_and_out_of_obstacles_and_gets_everywhere() {
    let boxes = [([3.0, 3.0], [2.0, 2.0], 20.0), ([7.0, 6.0], [1.0, 5.0], -35.0)];
    let world = silent(field(&boxes));
    let regions = [
        RegionConfig::Rectangle { min_m: at(0.0, 0.0), max_m: at(10.0, 10.0) },
        RegionConfig::Disc { center_m: at(5.0, 5.0), radius_m: 5.0 },
        RegionConfig::Box { min_m: Position::new(0.0, 0.0, -2.0), max_m: Position::new(10.0, 10.0, 4.0) },
    ];
    for region in regions {
        for steps_per_turn in [1, 30] {
            let config = RandomWalkConfig {
                region: Some(region.clone()),
                max_steps: 3000,
                steps_per_turn,
                ..RandomWalkConfig::default()
            };
            let trace = walk(&world, &config, at(1.5, 5.0), 5, 0);
            let inside = Region::try_from(&region).expect("a region");
            assert!(trace.stops.iter().all(|&stop| inside.contains(stop)));
            for step in trace.stops.windows(2) {
                assert!((step[0].distance_m(step[1]) - 1.0).abs() < 1e-9);
            }
            for corner in [at(2.0, 2.0), at(8.0, 2.0), at(2.0, 8.0), at(8.0, 8.0)] {
                let gap_m = trace.nearest_stop_m(corner);
                assert!(gap_m < 2.0, "{gap_m} m from {corner:?} in {region:?}");
            }
        }
    }
}

#[test]
fn a_walk_ends_when_each_node_has_been_heard_as_often_as_wanted() {
    let nodes = vec![at(0.0, 0.0), at(10.0, 10.0)];
    let world = World { nodes, reach_m: 4.0, ..silent(ObstacleField::default()) };
    let region = Some(RegionConfig::Rectangle { min_m: at(0.0, 0.0), max_m: at(10.0, 10.0) });
    for packets_per_node in [1, 5] {
        let config = RandomWalkConfig { region: region.clone(), packets_per_node, ..RandomWalkConfig::default() };
        let trace = walk(&world, &config, at(5.0, 5.0), 3, 0);
        assert_eq!((trace.ending, trace.least_packets()), (Ending::Complete, packets_per_node));
    }
}

#[test]
fn a_walk_depends_on_seed_and_robot_only() {
    let world = silent(ObstacleField::default());
    let config = RandomWalkConfig { max_steps: 50, ..RandomWalkConfig::default() };
    let path = |seed, robot| walk(&world, &config, at(0.0, 0.0), seed, robot).path;
    assert_eq!(path(1, 0), path(1, 0));
    assert_ne!(path(1, 0), path(2, 0));
    assert_ne!(path(1, 0), path(1, 1));
}

#[test]
fn a_robot_with_no_free_direction_is_stuck() {
    let walls = [
        ([0.0, 0.8], [3.0, 0.4], 0.0),
        ([0.0, -0.8], [3.0, 0.4], 0.0),
        ([0.8, 0.0], [0.4, 3.0], 0.0),
        ([-0.8, 0.0], [0.4, 3.0], 0.0),
    ];
    let trace = walk(&silent(field(&walls)), &RandomWalkConfig::default(), at(0.0, 0.0), 1, 0);
    assert_eq!((trace.ending, trace.stops.len()), (Ending::Stuck, 1));
}

#[test]
fn invalid_settings_are_rejected_with_their_key() {
    let world = silent(ObstacleField::default());
    let surroundings = world.surroundings(at(0.0, 0.0));
    let key = |config: RandomWalkConfig| RandomWalk::plan(&config, &surroundings).unwrap_err().key;
    let settings = RandomWalkConfig::default;
    let disc = |x_m: f64, radius_m: f64| Some(RegionConfig::Disc { center_m: at(x_m, 0.0), radius_m });
    assert_eq!(key(RandomWalkConfig { step_m: 0.0, ..settings() }), "step_m");
    assert_eq!(key(RandomWalkConfig { steps_per_turn: 0, ..settings() }), "steps_per_turn");
    assert_eq!(key(RandomWalkConfig { packets_per_node: 0, ..settings() }), "packets_per_node");
    assert_eq!(key(RandomWalkConfig { max_steps: 0, ..settings() }), "max_steps");
    assert_eq!(key(RandomWalkConfig { region: disc(0.0, -1.0), ..settings() }), "region.disc.radius_m");
    assert_eq!(key(RandomWalkConfig { region: disc(3.0, 2.0), ..settings() }), "region");
}
