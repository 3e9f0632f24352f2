//! The automated S path in space.

use sextant_apps::{AutomatedS, AutomatedSConfig, LayersConfig, Until};
use sextant_channel::{ObstacleField, Position};
use sextant_sim::Ending;
use sextant_sim::layout::{LatticeConfig, NodesConfig, RegionConfig};

use crate::world::{Trace, World, place, solid_field};

fn world(region: RegionConfig, field: ObstacleField, reach_m: f64) -> World {
    let lattice = LatticeConfig {
        spacing_m: 1.0,
        jitter_m: 0.2,
        count: None,
        origin_m: None,
        clearance_m: 0.1,
        storey: None,
        region,
    };
    let nodes = place(&NodesConfig::Lattice(lattice), &field, 1);
    World { field, nodes, robot_radius_m: 0.2, reach_m, fading: None }
}

fn config(spacing_m: f64, floor_m: Option<f64>, ceiling_m: Option<f64>) -> AutomatedSConfig {
    AutomatedSConfig {
        lane_spacing_m: spacing_m,
        until: Until::Swept,
        layers: Some(LayersConfig { spacing_m, floor_m, ceiling_m }),
        ..AutomatedSConfig::default()
    }
}

fn survey(world: &World, config: &AutomatedSConfig, start: [f64; 3]) -> Trace {
    let start = Position::from(start);
    let mut controller = AutomatedS::plan(config, &world.surroundings(start)).expect("settings");
    world.survey(&mut controller, start, 1)
}

/// Checks that each node was heard, and that there is a stop within the lane spacing of each node.
fn assert_covered(world: &World, trace: &Trace, spacing_m: f64, what: &str) {
    assert_eq!(trace.ending, Ending::Complete, "{what}: {} stops", trace.stops.len());
    assert!(trace.least_packets() >= 5, "{what}");
    for node in &world.nodes {
        let gap_m = trace.nearest_stop_m(*node);
        assert!(gap_m < spacing_m, "{what}: {node:?} is {gap_m} m from the nearest stop");
    }
}

fn heights(trace: &Trace) -> (f64, f64) {
    let heights = || trace.stops.iter().map(|stop| stop.z_m);
    (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max))
}

fn ball() -> RegionConfig {
    RegionConfig::Ball { center_m: Position::new(1.0, -2.0, 3.0), radius_m: 6.0 }
}

fn hall() -> RegionConfig {
    RegionConfig::Box { min_m: Position::ORIGIN, max_m: Position::new(14.0, 10.0, 7.0) }
}

#[test]
fn a_ball_is_covered_from_any_start() {
    for spacing_m in [2.0, 3.0] {
        let world = world(ball(), ObstacleField::default(), 3.5);
        for start in [[-8.0, -2.0, 3.0], [1.0, -2.0, 3.0], [1.0, -2.0, -4.5], [6.0, 2.0, 6.0], [-12.0, -14.0, 1.0]] {
            let trace = survey(&world, &config(spacing_m, None, None), start);
            assert_covered(&world, &trace, spacing_m, &format!("{spacing_m} m from {start:?}"));
            // It turned where it heard nothing: at most one climb and the overshoot of a lane beyond the radio range.
            let (low_m, high_m) = heights(&trace);
            assert!(low_m >= 3.0 - 9.7 - spacing_m && high_m <= 3.0 + 9.7 + spacing_m, "{low_m} to {high_m}");
        }
    }
}

#[test]
fn a_box_is_covered_between_floor_and_ceiling() {
    for spacing_m in [2.0, 3.0] {
        let world = world(hall(), ObstacleField::default(), 3.5);
        for start in [[-2.0, 5.0, 0.0], [7.0, 5.0, 3.5], [15.0, -1.0, 7.0], [-1.0, 0.0, 1.3]] {
            let trace = survey(&world, &config(spacing_m, Some(0.0), Some(7.0)), start);
            assert_covered(&world, &trace, spacing_m, &format!("{spacing_m} m from {start:?}"));
            let (low_m, high_m) = heights(&trace);
            assert!(low_m >= 0.0 && high_m <= 7.0, "{low_m} to {high_m}");
        }
    }
}

#[test]
fn a_robot_without_limits_stays_between_two_slabs() {
    let slab = |z_m: f64| ([7.0, 5.0, z_m], [60.0, 60.0, 1.0]);
    let world = world(hall(), solid_field(&[slab(-0.8), slab(7.8)]), 3.5);
    let trace = survey(&world, &config(2.0, None, None), [-2.0, 5.0, 0.5]);
    assert_covered(&world, &trace, 2.0, "between slabs");
    let (low_m, high_m) = heights(&trace);
    assert!(low_m >= -0.1 && high_m <= 7.1, "{low_m} to {high_m}");
}

#[test]
fn obstacles_in_space_are_driven_round_above_and_below() {
    let boxes =
        [([7.0, 5.0, 3.5], [3.0, 3.0, 3.0]), ([3.0, 8.0, 1.0], [2.0, 2.0, 2.0]), ([11.0, 2.0, 6.0], [2.0, 2.0, 2.0])];
    let world = world(hall(), solid_field(&boxes), 3.5);
    for start in [[-2.0, 5.0, 0.0], [7.0, -2.0, 3.5]] {
        let trace = survey(&world, &config(2.0, Some(0.0), Some(7.0)), start);
        assert_eq!(trace.ending, Ending::Complete);
        assert!(trace.least_packets() >= 5);
    }
}

#[test]
fn a_survey_until_all_is_heard_is_no_longer_than_one_until_all_is_swept() {
    let world = world(ball(), ObstacleField::default(), 3.5);
    let swept = config(2.0, None, None);
    let heard = AutomatedSConfig { until: Until::Heard, ..swept.clone() };
    let (heard, swept) = (survey(&world, &heard, [-8.0, -2.0, 3.0]), survey(&world, &swept, [-8.0, -2.0, 3.0]));
    assert_eq!(heard.ending, Ending::Complete);
    assert!(heard.least_packets() >= 5);
    assert!(swept.stops.starts_with(&heard.stops) && swept.stops.len() > heard.stops.len());
}

#[test]
fn a_node_out_of_reach_ends_a_survey_in_layers() {
    let mut world = world(ball(), ObstacleField::default(), 3.5);
    world.nodes.push(Position::new(200.0, 0.0, 0.0));
    for coverage_check in [true, false] {
        let config = AutomatedSConfig { coverage_check, ..config(3.0, None, None) };
        assert_eq!(survey(&world, &config, [-8.0, -2.0, 3.0]).ending, Ending::Stuck);
    }
}

#[test]
fn the_same_world_gives_the_same_survey() {
    let world = world(ball(), ObstacleField::default(), 3.5);
    let paths = [0, 1].map(|_| survey(&world, &config(2.0, None, None), [-8.0, -2.0, 3.0]).path);
    assert_eq!(paths[0], paths[1]);
}

#[test]
fn invalid_layers_are_rejected_with_their_key() {
    let world = world(ball(), ObstacleField::default(), 3.5);
    let surroundings = world.surroundings(Position::ORIGIN);
    let key = |spacing_m: f64, floor_m: f64, ceiling_m: f64| {
        let layers = LayersConfig { spacing_m, floor_m: Some(floor_m), ceiling_m: Some(ceiling_m) };
        let config = AutomatedSConfig { layers: Some(layers), ..AutomatedSConfig::default() };
        AutomatedS::plan(&config, &surroundings).unwrap_err().key
    };
    assert_eq!(key(0.0, -1.0, 1.0), "layers.spacing_m");
    assert_eq!(key(1.0, f64::NAN, 1.0), "layers.floor_m");
    assert_eq!(key(1.0, -1.0, f64::INFINITY), "layers.ceiling_m");
    assert_eq!(key(1.0, 1.0, -1.0), "layers.ceiling_m");
    assert_eq!(key(1.0, 0.5, 2.0), "layers.floor_m");
    assert_eq!(key(1.0, -2.0, -0.5), "layers.ceiling_m");
}
