//! The interface through which a controller drives a robot.

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{NodeId, Seed, SimTime, StationId};

use crate::purpose;
use crate::station::RangeSensors;

/// What a robot heard of one node during a listening slot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeardNode {
    /// The node that was heard.
    pub node: NodeId,
    /// Packets received during the slot.
    pub packets: u32,
    /// Packets that the node sent from the first to the last one received, both included, by their sequence numbers.
    pub sent: u32,
    /// Mean received signal strength (dBm).
    pub rssi_dbm: f64,
}

impl HeardNode {
    /// Adds what was heard of the same node in another network; returns `true`.
    pub(crate) fn add(&mut self, other: &Self) -> bool {
        let packets = self.packets + other.packets;
        let sum_dbm = |heard: &Self| f64::from(heard.packets) * heard.rssi_dbm;
        self.rssi_dbm = (sum_dbm(self) + sum_dbm(other)) / f64::from(packets);
        self.sent += other.sent;
        self.packets = packets;
        true
    }
}

/// How the last command ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CommandOutcome<'a> {
    /// There was no command yet.
    Started,
    /// The robot is at its destination.
    Arrived,
    /// An obstacle is in the way, and the robot has stopped in front of it. The point of contact on the obstacle (m).
    Blocked(Position),
    /// A listening slot is over: the nodes heard, by node.
    Listened(&'a [HeardNode]),
}

/// Everything that a robot knows when it must decide.
pub struct Situation<'a> {
    /// Current time.
    pub time: SimTime,
    /// Position of the robot by its odometry (m).
    pub position: Position,
    /// Where the robot looks by its odometry (rad), counterclockwise from the x axis.
    pub heading_rad: f64,
    /// How the last command ended.
    pub outcome: CommandOutcome<'a>,
    /// Number of nodes in the network: the only thing that the robot knows about it in advance (thesis, chapter 3).
    pub node_count: usize,
    pub(crate) sensors: RangeSensors<'a>,
    pub(crate) identity: Identity,
}

/// What a robot always knows of itself.
#[derive(Clone, Copy)]
pub(crate) struct Identity {
    pub(crate) station: StationId,
    pub(crate) seed: Seed,
    /// Whether it surveys a network whose links sweep sectors.
    pub(crate) sweeps_sectors: bool,
}

impl<'a> Situation<'a> {
    /// A situation for tests of controllers: what a robot with the radius `radius_m` would know among `obstacles`. It looks
    /// along the x axis, its networks do not sweep sectors, and it is the first station of a run with seed 0.
    #[must_use]
    pub fn new(
        time: SimTime,
        position: Position,
        outcome: CommandOutcome<'a>,
        node_count: usize,
        obstacles: &'a ObstacleField,
        radius_m: f64,
    ) -> Self {
        let sensors = RangeSensors { obstacles, radius_m, place: position, turn_rad: 0.0 };
        let identity = Identity { station: StationId(0), seed: Seed(0), sweeps_sectors: false };
        Self { time, position, heading_rad: 0.0, outcome, node_count, sensors, identity }
    }

    /// Whether the robot is in a network whose links sweep sectors: there it sweeps while it listens.
    #[must_use]
    pub fn sweeps_sectors(&self) -> bool {
        self.identity.sweeps_sectors
    }

    /// 128 random bits of this robot, for a generator of the controller's own: see [`program_seed`](crate::program_seed).
    #[must_use]
    pub fn program_seed(&self) -> u128 {
        purpose::program_seed(self.identity.seed, self.identity.station)
    }

    /// How far the robot could drive straight in `direction` (of any length above zero) before its hull touches
    /// an obstacle (m), at most `range_m`: the reading of its range sensors.
    #[must_use]
    pub fn clearance_m(&self, direction: Position, range_m: f64) -> f64 {
        self.sensors.clearance_m(direction, range_m)
    }
}

/// The next command for a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotCommand {
    /// Drive straight to this place (m); ends with [`CommandOutcome::Arrived`] or [`CommandOutcome::Blocked`].
    Drive(Position),
    /// Drive along an arc; ends as `Drive` does.
    DriveArc {
        /// Length of the arc (m), not negative.
        length_m: f64,
        /// Angle by which the heading turns on the way, counterclockwise (rad).
        turn_rad: f64,
    },
    /// Listen for one slot: a stop of the reception log; ends with [`CommandOutcome::Listened`].
    Listen,
    /// The survey is over.
    Finish(Ending),
}

/// Why a survey is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The whole path was driven, or each node was heard as often as requested.
    Complete,
    /// The limit on steps was reached first.
    StepsExhausted,
    /// No place to go is left.
    Stuck,
}

/// Stops of a planned path that are left out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StopsLeftOut {
    /// The robot cannot stand there: inside an obstacle, or too near to one.
    pub in_obstacles: usize,
    /// There is no way to them.
    pub unreachable: usize,
}

/// Drives one robot: asked for a command at the start and after each command.
pub trait Controller: Duplicate + Send + Sync {
    /// The next command.
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand;

    /// The stops of its planned path that are left out.
    fn left_out(&self) -> StopsLeftOut {
        StopsLeftOut::default()
    }
}

/// Copies a boxed controller, so that a planned path can be driven more than once. Implemented for every controller
/// that is `Clone`.
pub trait Duplicate {
    /// A controller in the same state.
    fn duplicate(&self) -> Box<dyn Controller>;
}

impl<C: Controller + Clone + 'static> Duplicate for C {
    fn duplicate(&self) -> Box<dyn Controller> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Controller> {
    fn clone(&self) -> Self {
        self.as_ref().duplicate()
    }
}
