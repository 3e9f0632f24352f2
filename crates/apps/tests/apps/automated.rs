//! The automated S path.

use sextant_apps::{AutomatedS, AutomatedSConfig, Until};
use sextant_channel::{ObstacleField, Position};
use sextant_sim::Ending;
use sextant_sim::layout::{LatticeConfig, NodesConfig, RegionConfig};

use crate::world::{Trace, World, field, place};

fn lattice(region: RegionConfig, spacing_m: f64, count: usize) -> NodesConfig {
    let count = Some(count);
    NodesConfig::Lattice(LatticeConfig {
        spacing_m,
        jitter_m: 0.2,
        count,
        origin_m: None,
        clearance_m: 0.1,
        storey: None,
        region,
    })
}

fn survey(world: &World, config: &AutomatedSConfig, start: [f64; 2], seed: u64) -> Trace {
    let start = Position::new(start[0], start[1], 0.0);
    let mut controller = AutomatedS::plan(config, &world.surroundings(start)).expect("settings");
    world.survey(&mut controller, start, seed)
}

/// The disc of chapter 3: 496 nodes, three concrete boxes, suburban.
fn circular(seed: u64) -> World {
    let field = field(&CIRCULAR);
    let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 13.7 };
    let nodes = place(&lattice(region, 1.0, 496), &field, seed);
    World { field, nodes, robot_radius_m: 0.2, reach_m: 10.0, fading: Some((2.7, 9.6)) }
}

const CIRCULAR: [([f64; 2], [f64; 2], f64); 3] =
    [([-5.5, -3.5], [4.5, 4.0], 0.0), ([5.0, -4.5], [4.5, 4.5], 0.0), ([0.5, 5.5], [5.5, 3.5], 0.0)];

/// The sparse grid of chapter 3: 700 of 900 sites, light trees.
fn sparse(seed: u64) -> World {
    let region = RegionConfig::Rectangle { min_m: Position::ORIGIN, max_m: Position::new(30.0, 30.0, 0.0) };
    let field = field(&[]);
    let nodes = place(&lattice(region, 1.0, 700), &field, seed);
    World { field, nodes, robot_radius_m: 0.2, reach_m: 10.0, fading: Some((3.6, 8.2)) }
}

/// The concave network of chapter 3: a square around a U of concrete that is open to the north; suburban.
fn concave(seed: u64) -> World {
    const U: [([f64; 2], [f64; 2], f64); 3] = [
        ([7.325, 12.325], [4.0, 14.0], 0.0),
        ([17.325, 12.325], [4.0, 14.0], 0.0),
        ([12.325, 7.325], [6.0, 4.0], 0.0),
    ];
    let region = RegionConfig::Rectangle { min_m: Position::ORIGIN, max_m: Position::new(24.65, 24.65, 0.0) };
    let field = field(&U);
    let nodes = place(&lattice(region, 0.9, 554), &field, seed);
    World { field, nodes, robot_radius_m: 0.2, reach_m: 10.0, fading: Some((2.7, 9.6)) }
}

#[test]
fn all_nodes_of_the_networks_of_chapter_3_are_heard_five_times_with_about_as_many_stops_as_in_the_thesis() {
    // 444, 423 and 438 s at 1 m/s with a stop each metre (thesis, section 3.5).
    type Network = fn(u64) -> World;
    let cases: [(Network, [f64; 2], Until, f64, f64); 3] = [
        (circular, [-18.0, 0.0], Until::Swept, 5.0, 444.0),
        (sparse, [-5.0, 0.0], Until::Heard, 3.75, 423.0),
        (concave, [-5.0, 0.0], Until::Swept, 5.0, 438.0),
    ];
    for (network, start, until, lane_spacing_m, published) in cases {
        for seed in 1..=3 {
            let config = AutomatedSConfig { until, lane_spacing_m, ..AutomatedSConfig::default() };
            let trace = survey(&network(seed), &config, start, seed);
            assert_eq!(trace.ending, Ending::Complete);
            assert!(trace.least_packets() >= 5);
            let stops = trace.stops.len() as f64;
            assert!((stops / published - 1.0).abs() < 0.05, "{stops} stops, {published} published");
        }
    }
}

#[test]
fn the_survey_is_complete_for_every_start_lane_spacing_and_check() {
    // The obstacles are rotated, so that lanes meet them at an angle. The start is anywhere, even out of radio range.
    let boxes = [([-5.5, -3.5], [4.5, 4.0], 20.0), ([5.0, -4.5], [4.5, 4.5], 45.0), ([0.5, 5.5], [9.0, 3.5], -10.0)];
    let field = field(&boxes);
    let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 13.7 };
    let nodes = place(&lattice(region, 1.0, 400), &field, 1);
    let world = World { field, nodes, robot_radius_m: 0.3, reach_m: 6.0, fading: Some((3.6, 8.2)) };
    for start in [[-18.0, 0.0], [0.0, 0.0], [12.0, -5.0], [0.0, 10.0], [30.0, 30.0]] {
        for lane_spacing_m in [2.0, 3.0, 4.7, 6.0] {
            // Without the check, nodes behind obstacles are missed if the lanes are as far apart as the radio range.
            let checks: &[bool] = if lane_spacing_m < world.reach_m { &[true, false] } else { &[true] };
            for until in [Until::Heard, Until::Swept] {
                for &coverage_check in checks {
                    let config =
                        AutomatedSConfig { lane_spacing_m, until, coverage_check, ..AutomatedSConfig::default() };
                    let trace = survey(&world, &config, start, 1);
                    let what = format!(
                        "{start:?}, {lane_spacing_m} m, {until:?}, {coverage_check}: {} stops",
                        trace.stops.len()
                    );
                    assert_eq!(trace.ending, Ending::Complete, "{what}");
                    assert!(trace.least_packets() >= 5, "{what}");
                }
            }
        }
    }
}

#[test]
fn a_node_out_of_reach_ends_the_survey_at_the_cap_or_when_all_places_were_tried() {
    let mut world = circular(1);
    world.nodes.push(Position::new(200.0, 0.0, 0.0));
    let config = AutomatedSConfig { coverage_check: false, max_steps: 3000, ..AutomatedSConfig::default() };
    let trace = survey(&world, &config, [-18.0, 0.0], 1);
    assert_eq!(trace.ending, Ending::StepsExhausted);
    assert!(trace.commands <= 2 * 3000 + 2, "{}", trace.commands);
    let config = AutomatedSConfig { max_steps: 3000, ..AutomatedSConfig::default() };
    let trace = survey(&world, &config, [-18.0, 0.0], 1);
    assert_eq!(trace.ending, Ending::Stuck);
    let missing: Vec<usize> = (0..world.nodes.len()).filter(|&i| trace.packets[i] < 5).collect();
    assert_eq!(missing, [496], "all others were heard");
}

#[test]
fn a_robot_that_hears_nobody_searches_up_to_the_cap() {
    let nodes = vec![Position::new(1000.0, 0.0, 0.0)];
    let world = World { field: ObstacleField::default(), nodes, robot_radius_m: 0.2, reach_m: 10.0, fading: None };
    let config = AutomatedSConfig { max_steps: 200, ..AutomatedSConfig::default() };
    let trace = survey(&world, &config, [0.0, 0.0], 1);
    assert_eq!((trace.ending, trace.stops.len()), (Ending::StepsExhausted, 201));
}

#[test]
fn lanes_cover_the_space_behind_an_obstacle() {
    // A wall crosses the second and third lane. There must be a stop near each metre behind it.
    let field = field(&[([7.5, 10.0], [9.0, 1.0], 0.0)]);
    let region = RegionConfig::Rectangle { min_m: Position::ORIGIN, max_m: Position::new(25.0, 20.0, 0.0) };
    let nodes = place(&lattice(region, 1.0, 480), &field, 1);
    let world = World { field, nodes, robot_radius_m: 0.2, reach_m: 4.0, fading: None };
    let lane_spacing_m = 3.0;
    let config = AutomatedSConfig { until: Until::Swept, lane_spacing_m, ..AutomatedSConfig::default() };
    let trace = survey(&world, &config, [-2.0, 2.0], 1);
    assert_eq!(trace.ending, Ending::Complete);
    for node in &world.nodes {
        let nearest_m = trace.stops.iter().map(|stop| stop.distance_m(*node)).fold(f64::INFINITY, f64::min);
        assert!(nearest_m < lane_spacing_m, "{node:?} is {nearest_m} m from the nearest stop");
    }
}

#[test]
fn the_same_world_gives_the_same_survey() {
    let config = AutomatedSConfig::default();
    let [once, twice] = [0, 1].map(|_| survey(&circular(3), &config, [-18.0, 0.0], 3));
    assert_eq!(once.path, twice.path);
    assert_eq!(once.packets, twice.packets);
    assert_ne!(once.packets, survey(&circular(3), &config, [-18.0, 0.0], 4).packets);
}

#[test]
fn more_silent_stops_lead_farther_beyond_the_network() {
    // One node in the middle, heard within 5 m: lanes end at the first stops beyond, 1 m apart.
    let world = World {
        field: ObstacleField::default(),
        nodes: vec![Position::ORIGIN],
        robot_radius_m: 0.2,
        reach_m: 5.0,
        fading: None,
    };
    for silent_stops_to_turn in [1, 3] {
        let packets_per_node = 12;
        let config = AutomatedSConfig { silent_stops_to_turn, packets_per_node, ..AutomatedSConfig::default() };
        let trace = survey(&world, &config, [0.0, -0.5], 1);
        let farthest_m = trace.stops.iter().map(|stop| stop.y_m).fold(0.0, f64::max);
        assert!((farthest_m - (4.5 + f64::from(silent_stops_to_turn))).abs() < 1e-9, "{farthest_m}");
    }
}

#[test]
fn invalid_settings_are_rejected_with_their_key() {
    let world = circular(1);
    let surroundings = world.surroundings(Position::new(-18.0, 0.0, 0.0));
    let key = |config: AutomatedSConfig| AutomatedS::plan(&config, &surroundings).unwrap_err().key;
    let settings = AutomatedSConfig::default;
    assert_eq!(key(AutomatedSConfig { step_m: 0.0, ..settings() }), "step_m");
    assert_eq!(key(AutomatedSConfig { lane_spacing_m: f64::NAN, ..settings() }), "lane_spacing_m");
    assert_eq!(key(AutomatedSConfig { lane_spacing_m: 0.5, ..settings() }), "lane_spacing_m");
    assert_eq!(key(AutomatedSConfig { packets_per_node: 0, ..settings() }), "packets_per_node");
    assert_eq!(key(AutomatedSConfig { max_steps: 0, ..settings() }), "max_steps");
    assert_eq!(key(AutomatedSConfig { silent_stops_to_turn: 0, ..settings() }), "silent_stops_to_turn");
    assert_eq!(key(AutomatedSConfig { silent_below_nodes: 0, ..settings() }), "silent_below_nodes");
}
