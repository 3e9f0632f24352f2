//! The port through which a robot is driven.

use sextant_channel::{ObstacleField, Position};
use sextant_kernel::{NodeId, SimTime};

/// What one listening slot brought of one node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Heard {
    /// The node that was heard.
    pub node: NodeId,
    /// Packets received during the slot.
    pub packets: u32,
    /// Packets that the node sent from the first to the last one received, both counted: their sequence numbers tell.
    pub sent: u32,
    /// Mean received signal strength [dBm].
    pub rssi_dbm: f64,
}

/// How the command before ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CommandOutcome<'a> {
    /// Nothing was commanded yet.
    Started,
    /// The robot is where it was sent.
    Arrived,
    /// An obstacle is in the way: the robot stands before it. The point of the obstacle that was met [m].
    Blocked(Position),
    /// A slot of listening is over: the nodes heard, by node.
    Listened(&'a [Heard]),
}

/// All that a robot knows when it must decide.
pub struct Situation<'a> {
    /// Now.
    pub time: SimTime,
    /// Where the robot stands [m].
    pub position: Position,
    /// How the command before ended.
    pub outcome: CommandOutcome<'a>,
    /// Number of nodes in the network: all that the robot knows of it beforehand (thesis, chapter 3).
    pub node_count: usize,
    pub(crate) obstacles: &'a ObstacleField,
    pub(crate) radius_m: f64,
}

impl<'a> Situation<'a> {
    /// A situation for tests of controllers: what a robot of `radius_m` would know among `obstacles`.
    #[must_use]
    pub fn new(
        time: SimTime,
        position: Position,
        outcome: CommandOutcome<'a>,
        node_count: usize,
        obstacles: &'a ObstacleField,
        radius_m: f64,
    ) -> Self {
        Self { time, position, outcome, node_count, obstacles, radius_m }
    }

    /// How far the robot could drive straight in `direction` (any length above zero) before its hull meets
    /// an obstacle [m], at most `range_m`: the reading of its range sensors.
    #[must_use]
    pub fn clearance_m(&self, direction: Position, range_m: f64) -> f64 {
        self.obstacles.clearance_m(self.position, direction, range_m, self.radius_m)
    }
}

/// What a robot is told to do next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RobotCommand {
    /// Drive straight to this place [m]; ends [`CommandOutcome::Arrived`] or [`CommandOutcome::Blocked`].
    Drive(Position),
    /// Listen for one slot: a stop of the reception log; ends [`CommandOutcome::Listened`].
    Listen,
    /// The survey is over.
    Finish(Ending),
}

/// Why a survey is over.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// All of the path was driven, or each node was heard as often as wanted.
    Complete,
    /// The cap on steps was reached first.
    StepsExhausted,
    /// There is nowhere left to go.
    Stuck,
}

/// Drives one robot: asked once at the start and after each command.
pub trait Controller: Duplicate + Send + Sync {
    /// The next command.
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand;
}

/// Copies a controller behind its port, so that a planned path can be driven more than once. Whatever can be cloned has
/// it.
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
