//! Targets on their ways, and what the sensors of nodes say.

mod crossings;
mod errors;
mod evasion;
mod fields;
mod visits;
mod walks;

use std::time::Duration;

use sextant_channel::{BoxConfig, Obstacle, ObstacleConfig, ObstacleField, Position, ShapeConfig};
use sextant_kernel::{Files, NodeId, Seed, SimTime};
use sextant_sim::{
    Application, AtEnd, Observer, Port, Sensed, Sensors, SensorsConfig, Setup, Target, TargetConfig, TargetId,
    TargetMotionConfig, TargetSensorConfig, WaypointsConfig, World,
};

use crate::network::{self, Ended};

/// A node that writes down what its sensors say.
#[derive(Clone, Debug, Default)]
struct Watcher {
    is_blind: bool,
    sensed: Vec<(SimTime, Sensed)>,
}

impl Application for Watcher {
    fn senses(&self) -> bool {
        !self.is_blind
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        self.sensed.push((port.now(), *sensed));
    }
}

/// Writes down where targets are and what sensors say.
#[derive(Debug, Default, PartialEq)]
struct Notebook {
    moved: Vec<(TargetId, SimTime, Position)>,
    sensed: Vec<(NodeId, SimTime, Sensed)>,
    gone: Vec<(TargetId, SimTime)>,
}

impl Observer for Notebook {
    fn target_moved(&mut self, target: TargetId, time: SimTime, position: Position) {
        self.moved.push((target, time, position));
    }

    fn target_gone(&mut self, target: TargetId, time: SimTime) {
        self.gone.push((target, time));
    }

    fn sensed(&mut self, node: NodeId, time: SimTime, sensed: &Sensed) {
        self.sensed.push((node, time, *sensed));
    }
}

pub(crate) fn seconds(seconds: f64) -> SimTime {
    SimTime::ZERO + Duration::from_secs_f64(seconds)
}

/// A target over `places` at `speed_m_per_s`.
pub(crate) fn way(places: &[[f64; 3]], speed_m_per_s: f64, at_end: AtEnd) -> TargetMotionConfig {
    let places_m = places.iter().copied().map(Position::from).collect();
    TargetMotionConfig::Waypoints(WaypointsConfig { places_m, speed_m_per_s, at_end })
}

/// Targets called `t0`, `t1`, ... among `obstacles`.
pub(crate) fn targets(motions: &[TargetMotionConfig], obstacles: &ObstacleField) -> Vec<Target> {
    let target = |(i, motion): (usize, &TargetMotionConfig)| {
        TargetConfig { name: format!("t{i}"), motion: motion.clone(), screen: None }
            .build(i as u64, obstacles, Seed(1))
            .expect("good settings")
    };
    motions.iter().enumerate().map(target).collect()
}

/// Sensors that detect targets within `radius_m`.
pub(crate) fn discs(radius_m: f64) -> Sensors {
    let targets = Some(TargetSensorConfig::perfect(radius_m));
    Sensors::try_from(SensorsConfig { targets, fields: None }).expect("good settings")
}

/// Nodes at `places` that sense `targets` within `radius_m`.
fn world(places: &[[f64; 3]], motions: &[TargetMotionConfig], radius_m: f64) -> World {
    let places: Vec<Position> = places.iter().copied().map(Position::from).collect();
    let targets = targets(motions, &ObstacleField::default());
    World { nodes: network::nodes(&places), targets, sensors: discs(radius_m), ..World::default() }
}

/// Runs `applications` in `world`, without radios, for `duration_s`.
fn run<A: Application>(
    world: World,
    applications: Vec<A>,
    duration_s: f64,
    seed: u64,
    observer: &mut impl Observer,
) -> Ended<A> {
    let setup = Setup {
        duration: Some(Duration::from_secs_f64(duration_s)),
        ..Setup::of(world, network::link(1.0, network::prompt()), Seed(seed))
    };
    network::run_watched(setup, applications, observer)
}

/// What all nodes of `world` sense in `duration_s`.
fn watched(world: World, duration_s: f64, seed: u64) -> (Ended<Watcher>, Notebook) {
    let mut notebook = Notebook::default();
    let watchers = vec![Watcher::default(); world.nodes.len()];
    let ended = run(world, watchers, duration_s, seed, &mut notebook);
    (ended, notebook)
}

/// A box of concrete.
fn block(center: [f64; 3], size_m: [f64; 3]) -> Obstacle {
    let config = ObstacleConfig {
        name: Some("block".into()),
        ..ObstacleConfig::of(
            ShapeConfig::Box(BoxConfig { center_m: center.into(), size_m, yaw_deg: 20.0 }),
            "concrete",
        )
    };
    Obstacle::read(config, &Files::default()).expect("a good block")
}
