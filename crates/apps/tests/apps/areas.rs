//! Robots with an area each.

use sextant_apps::{AutomatedS, AutomatedSConfig, LayersConfig, Until};
use sextant_channel::{ObstacleField, Position};
use sextant_sim::Ending;
use sextant_sim::layout::{LatticeConfig, NodesConfig, Region, RegionConfig};

use crate::world::{Trace, World, field, place};

fn at(x_m: f64, y_m: f64) -> Position {
    Position::new(x_m, y_m, 0.0)
}

fn world(field: ObstacleField) -> World {
    let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 13.7 };
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
    World { field, nodes, robot_radius_m: 0.2, reach_m: 6.0, fading: Some((2.7, 9.6)) }
}

fn survey(world: &World, config: &AutomatedSConfig, start: Position) -> Trace {
    let mut controller = AutomatedS::plan(config, &world.surroundings(start)).expect("settings");
    world.survey(&mut controller, start, 1)
}

fn in_area(area: &RegionConfig, lane_spacing_m: f64) -> AutomatedSConfig {
    AutomatedSConfig { area: Some(area.clone()), lane_spacing_m, until: Until::Swept, ..AutomatedSConfig::default() }
}

#[test]
fn robots_keep_to_their_areas_and_together_survey_all() {
    let halves = |half: f64| RegionConfig::Rectangle {
        min_m: at(half.min(0.0) * 30.0, -30.0),
        max_m: at(half.max(0.0) * 30.0, 30.0),
    };
    // A wedge has lanes of many lengths and a slanting border.
    let wedge = |half: f64| RegionConfig::Polygon {
        corners_m: vec![[-25.0, -30.0], [25.0, 30.0], [half * 40.0, half * -40.0]],
        z_m: 0.0,
    };
    let boxes = [([-5.5, -3.5], [4.5, 4.0], 0.0), ([5.0, -4.5], [4.5, 4.5], 30.0), ([0.5, 5.5], [5.5, 3.5], 0.0)];
    for world in [world(ObstacleField::default()), world(field(&boxes))] {
        for lane_spacing_m in [2.0, 3.0] {
            let areas: [&dyn Fn(f64) -> RegionConfig; 2] = [&halves, &wedge];
            for area in areas {
                let robots = [-1.0, 1.0].map(|half| {
                    let area = area(half);
                    let start = at(half * 14.0, half * -14.0);
                    let trace = survey(&world, &in_area(&area, lane_spacing_m), start);
                    assert_eq!(trace.ending, Ending::Complete);
                    let area = Region::try_from(&area).expect("a region");
                    assert!(trace.stops.iter().all(|&stop| area.contains(stop)), "a stop outside");
                    trace
                });
                for node in 0..world.nodes.len() {
                    let packets: u32 = robots.iter().map(|robot| robot.packets[node]).sum();
                    assert!(packets >= 5, "node {node}: {packets} packets");
                }
                // At a slanting border a lane ends up to one step before the border.
                let far: Vec<f64> = (world.nodes.iter())
                    .map(|&node| robots.iter().map(|robot| robot.nearest_stop_m(node)).fold(f64::INFINITY, f64::min))
                    .filter(|&gap_m| gap_m >= lane_spacing_m + 0.5)
                    .collect();
                assert!(far.is_empty(), "{lane_spacing_m}: {far:?}");
            }
        }
    }
}

#[test]
fn an_area_that_holds_the_network_changes_nothing_until_the_network_is_heard() {
    let world = world(field(&[([4.0, 0.0], [4.0, 6.0], 10.0)]));
    let area = RegionConfig::Rectangle { min_m: at(-90.0, -90.0), max_m: at(90.0, 90.0) };
    let without = AutomatedSConfig { lane_spacing_m: 3.0, ..AutomatedSConfig::default() };
    let with = AutomatedSConfig { area: Some(area), ..without.clone() };
    let start = at(-18.0, 0.0);
    assert_eq!(survey(&world, &with, start).path, survey(&world, &without, start).path);
}

#[test]
fn an_area_in_space_limits_the_heights_too() {
    let world = World {
        nodes: (0..1000)
            .map(|i| Position::new(f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)))
            .collect(),
        reach_m: 3.0,
        fading: None,
        ..world(ObstacleField::default())
    };
    let area = RegionConfig::Box { min_m: Position::new(-9.0, -9.0, 0.0), max_m: Position::new(5.0, 19.0, 6.0) };
    let config = AutomatedSConfig {
        layers: Some(LayersConfig { spacing_m: 2.0, ..LayersConfig::default() }),
        ..in_area(&area, 2.0)
    };
    let trace = survey(&world, &config, Position::new(-2.0, 0.0, 1.0));
    assert_eq!(trace.ending, Ending::Complete);
    let inside = Region::try_from(&area).expect("a region");
    assert!(trace.stops.iter().all(|&stop| inside.contains(stop)));
    for node in world.nodes.iter().filter(|&&node| inside.contains(node)) {
        assert!(trace.nearest_stop_m(*node) < 2.0, "{node:?}");
    }
}

#[test]
fn a_robot_that_starts_outside_its_area_is_rejected() {
    let world = world(ObstacleField::default());
    let area = RegionConfig::Disc { center_m: at(0.0, 0.0), radius_m: 5.0 };
    let error = AutomatedS::plan(&in_area(&area, 2.0), &world.surroundings(at(6.0, 0.0))).unwrap_err();
    assert_eq!((error.key.as_str(), error.found()), ("area", "a region without the robot's start [6, 0, 0]"));
    let flat = RegionConfig::Disc { center_m: at(0.0, 0.0), radius_m: 0.0 };
    let error = AutomatedS::plan(&in_area(&flat, 2.0), &world.surroundings(at(0.0, 0.0))).unwrap_err();
    assert_eq!(error.key, "area.disc.radius_m");
}
