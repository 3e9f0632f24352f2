//! A scripted world: robots drive until they meet an obstacle, and hear the nodes around them.

use sextant_apps::Surroundings;
use sextant_channel::{BoxConfig, Obstacle, ObstacleConfig, ObstacleField, Position, ShapeConfig};
use sextant_kernel::{Files, NodeId, Purpose, Seed, SimTime};
use sextant_sim::layout::NodesConfig;
use sextant_sim::{CommandOutcome, Controller, Ending, HeardNode, RobotCommand, Situation};

/// How near to an obstacle a blocked robot halts (m).
const HALT_M: f64 = 1e-3;

pub(crate) struct World {
    pub(crate) field: ObstacleField,
    pub(crate) nodes: Vec<Position>,
    pub(crate) robot_radius_m: f64,
    /// Nodes farther away than this are not heard (m).
    pub(crate) reach_m: f64,
    /// Exponent of path loss, and standard deviation of shadowing (dB). If absent, all nodes within range are heard.
    pub(crate) fading: Option<(f64, f64)>,
}

pub(crate) struct Trace {
    pub(crate) ending: Ending,
    /// Places of the robot, from its start, each reached by a straight drive.
    pub(crate) path: Vec<Position>,
    pub(crate) stops: Vec<Position>,
    /// Packets heard of each node.
    pub(crate) packets: Vec<u32>,
    pub(crate) commands: usize,
}

impl Trace {
    pub(crate) fn path_length_m(&self) -> f64 {
        self.path.windows(2).map(|drive| drive[0].distance_m(drive[1])).sum()
    }

    /// Distance from a place to the nearest stop (m).
    pub(crate) fn nearest_stop_m(&self, place: Position) -> f64 {
        self.stops.iter().map(|stop| stop.distance_m(place)).fold(f64::INFINITY, f64::min)
    }

    pub(crate) fn least_packets(&self) -> u32 {
        self.packets.iter().copied().min().expect("nodes")
    }
}

/// Boxes in space, each given by centre and size.
pub(crate) fn solid_field(boxes: &[([f64; 3], [f64; 3])]) -> ObstacleField {
    concrete(boxes.iter().map(|&(center, size_m)| BoxConfig::new(center.into(), size_m)))
}

/// Boxes that are 3 m high, each given by centre, size and yaw.
pub(crate) fn field(boxes: &[([f64; 2], [f64; 2], f64)]) -> ObstacleField {
    concrete(boxes.iter().map(|&([x, y], [width, depth], yaw_deg)| BoxConfig {
        center_m: Position::new(x, y, 0.0),
        size_m: [width, depth, 3.0],
        yaw_deg,
    }))
}

fn concrete(boxes: impl Iterator<Item = BoxConfig>) -> ObstacleField {
    let obstacle = |shape: BoxConfig| {
        let config = ObstacleConfig::absorbing(ShapeConfig::Box(shape), 4.6);
        Obstacle::try_from(config).expect("a box")
    };
    ObstacleField::new(boxes.map(obstacle).collect())
}

pub(crate) fn place(nodes: &NodesConfig, field: &ObstacleField, seed: u64) -> Vec<Position> {
    let nodes = nodes.place(field, Seed(seed), &Files::default()).expect("a layout that fits");
    nodes.into_iter().map(|node| node.position).collect()
}

impl World {
    /// The surroundings of a robot that starts at `start`.
    pub(crate) fn surroundings(&self, start: Position) -> Surroundings<'_> {
        Surroundings { obstacles: &self.field, start, radius_m: self.robot_radius_m, seed: Seed(1), robot: 0 }
    }

    /// Drives the robot until its survey ends, and checks that the path is clear of obstacles.
    pub(crate) fn survey(&self, controller: &mut dyn Controller, start: Position, seed: u64) -> Trace {
        const MAX_COMMANDS: usize = 100_000;
        let mut trace = Trace {
            ending: Ending::Stuck,
            path: vec![start],
            stops: Vec::new(),
            packets: vec![0; self.nodes.len()],
            commands: 0,
        };
        let (mut heard, mut position) = (Vec::new(), start);
        let mut contact = None;
        let mut listened = false;
        loop {
            let outcome = match (trace.commands, listened, contact) {
                (0, ..) => CommandOutcome::Started,
                (_, true, _) => CommandOutcome::Listened(&heard),
                (_, false, Some(contact)) => CommandOutcome::Blocked(contact),
                (_, false, None) => CommandOutcome::Arrived,
            };
            let time = SimTime::from_nanos(trace.commands as u64);
            let situation =
                Situation::new(time, position, outcome, self.nodes.len(), &self.field, self.robot_radius_m);
            let command = controller.decide(&situation);
            trace.commands += 1;
            assert!(trace.commands < MAX_COMMANDS, "the survey does not end");
            match command {
                RobotCommand::Drive(to) => {
                    listened = false;
                    (position, contact) = self.drive(position, to);
                    trace.path.push(position);
                }
                RobotCommand::DriveArc { .. } => panic!("these controllers drive straight"),
                RobotCommand::Listen => {
                    listened = true;
                    heard = self.listen(position, trace.stops.len() as u64, Seed(seed));
                    for heard in &heard {
                        trace.packets[heard.node.index()] += heard.packets;
                    }
                    trace.stops.push(position);
                }
                RobotCommand::Finish(ending) => {
                    trace.ending = ending;
                    self.assert_clear(&trace.path);
                    return trace;
                }
            }
        }
    }

    fn drive(&self, from: Position, to: Position) -> (Position, Option<Position>) {
        let length_m = from.distance_m(to);
        if length_m <= 0.0 {
            return (from, None);
        }
        let direction = (to - from) * (1.0 / length_m);
        let clear_m = self.field.clearance_m(from, direction, length_m, self.robot_radius_m);
        if clear_m >= length_m {
            return (to, None);
        }
        let halt = from + direction * (clear_m - HALT_M).max(0.0);
        (halt, Some(from + direction * (clear_m + self.robot_radius_m)))
    }

    fn listen(&self, place: Position, stop: u64, seed: Seed) -> Vec<HeardNode> {
        let (exponent, sigma_db) = self.fading.unwrap_or((2.0, 0.0));
        let hear = |(i, node): (usize, &Position)| {
            let distance_m = node.distance_m(place);
            let shadowing_db = sigma_db * seed.normal(Purpose::new(4), [i as u64, stop, 0]);
            let loss_db = 10.0 * exponent * distance_m.max(0.1).log10() + self.field.loss(*node, place).0;
            let rssi_dbm = -50.0 - loss_db + shadowing_db;
            let is_heard = distance_m <= self.reach_m && (self.fading.is_none() || rssi_dbm >= -90.0);
            is_heard.then_some(HeardNode { node: NodeId::from_index(i), packets: 1, sent: 1, rssi_dbm })
        };
        self.nodes.iter().enumerate().filter_map(hear).collect()
    }

    /// Checks that no drive crosses an obstacle and that no place of the path is nearer to an obstacle than the
    /// radius of the robot's hull.
    fn assert_clear(&self, path: &[Position]) {
        const SAMPLE_M: f64 = 0.05;
        let mut crossings = Vec::new();
        for drive in path.windows(2) {
            self.field.crossings(drive[0], drive[1], &mut crossings);
            assert_eq!(crossings, [], "from {:?} to {:?}", drive[0], drive[1]);
            let samples = (drive[0].distance_m(drive[1]) / SAMPLE_M).ceil().max(1.0);
            let mut sample = 0.0;
            while sample <= samples {
                let place = drive[0] + (drive[1] - drive[0]) * (sample / samples);
                let distance_m = self.field.distance_m(place);
                assert!(distance_m >= self.robot_radius_m - 1e-6, "{place:?} is {distance_m} m from an obstacle");
                sample += 1.0;
            }
        }
    }
}
