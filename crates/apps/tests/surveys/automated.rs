//! The automated S path.

use sextant_apps::{AutomatedS, AutomatedSConfig, Until};
use sextant_channel::Position;
use sextant_sim::Ending;
use sextant_sim::layout::{LatticeConfig, NodesConfig, RegionConfig};

use crate::world::{Trace, World, field, place};

fn lattice(region: RegionConfig, spacing_m: f64, count: usize) -> NodesConfig {
    let count = Some(count);
    NodesConfig::Lattice(LatticeConfig { spacing_m, jitter_m: 0.2, count, origin_m: None, clearance_m: 0.1, region })
}

fn survey(world: &World, config: &AutomatedSConfig, start: [f64; 2], seed: u64) -> Trace {
    let mut controller = AutomatedS::try_from(config).expect("settings");
    world.survey(&mut controller, Position::new(start[0], start[1], 0.0), seed)
}

/// The disc of chapter 3: 496 nodes, three concrete boxes, suburban.
fn circular(seed: u64) -> World {
    let field = field(&CIRCULAR);
    let region = RegionConfig::Disc { center_m: Position::ORIGIN, radius_m: 13.7 };
    let nodes = place(&lattice(region, 1.04, 496), &field, seed);
    World { field, nodes, robot_radius_m: 0.2, reach_m: 10.0, fading: Some((2.7, 9.6)) }
}

const CIRCULAR: [([f64; 2], [f64; 2], f64); 3] =
    [([-5.5, -3.5], [4.5, 4.0], 0.0), ([5.0, -4.5], [4.5, 4.5], 0.0), ([0.5, 5.5], [5.5, 3.5], 0.0)];

#[test]
fn all_nodes_of_a_disc_with_three_obstacles_are_heard_five_times() {
    for seed in 1..=5 {
        let world = circular(seed);
        let trace = survey(&world, &AutomatedSConfig::default(), [-18.0, 0.0], seed);
        assert_eq!(trace.ending, Ending::Complete);
        assert!(trace.least_packets() >= 5);
    }
}

#[test]
fn print_stops() {
    for until in [Until::Heard, Until::Swept] {
        for lane_spacing_m in [2.5, 3.0, 3.5, 4.0, 5.0] {
            for seed in 1..=2 {
                let config = AutomatedSConfig { until, lane_spacing_m, ..AutomatedSConfig::default() };
                let trace = survey(&circular(seed), &config, [-18.0, 0.0], seed);
                println!("{until:?} {lane_spacing_m} {seed}: {} stops {} m {:?} {}", trace.stops.len(), trace.path_length_m(), trace.ending, trace.commands);
            }
        }
    }
}
