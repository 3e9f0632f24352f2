//! What stations leave behind.

use sextant_channel::Position;
use sextant_kernel::SimTime;

/// What a station leaves behind.
#[derive(Clone, Debug, PartialEq)]
pub enum SeekRecord {
    /// A node.
    Node(NodeSeekRecord),
    /// A robot.
    Robot(Box<RobotSeekRecord>),
    /// A sink: it takes no part.
    Sink,
}

/// What a node leaves behind.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NodeSeekRecord {
    /// Answers that it gave to its link.
    pub answers: u64,
    /// Payload of these (octets).
    pub octets: u64,
    /// Answers that the link did not take, because its queue was full.
    pub refused: u64,
}

/// What a robot leaves behind.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RobotSeekRecord {
    /// Its arrivals.
    pub arrivals: Vec<Arrival>,
    /// What it was doing at the end.
    pub state: SeekState,
    /// Largest value of the field that it believed to be at.
    pub largest: Option<f64>,
    /// When it first knew its place and the field there.
    pub oriented: Option<SimTime>,
    /// Sources that it removed.
    pub removed: usize,
    /// Angle turned, in both directions together (rad).
    pub turned_rad: f64,
    /// Times that an obstacle was in its way.
    pub blocked: u64,
    /// Times that it was stuck, or off the map, and drove to a random place on the map.
    pub wandered: u64,
    /// Polls that it gave to its link.
    pub polls: u64,
    /// Payload of these (octets).
    pub octets: u64,
    /// Polls that the link did not take, because its queue was full.
    pub refused: u64,
    /// Answers that it received.
    pub answers: u64,
}

/// A robot was where the field has the value that it sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arrival {
    /// When.
    pub time: SimTime,
    /// The value of the field that it believed to be at.
    pub value: f64,
    /// Where it was on the map (m); `None` if it did not know.
    pub place: Option<Position>,
    /// Where it was by its odometry (m).
    pub odometry: Position,
    /// Sources that it removed there.
    pub removed: usize,
}

/// What a robot is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeekState {
    /// It waits until it has heard enough nodes.
    #[default]
    Waiting,
    /// It drives along an arc until it knows how the map is turned.
    Orienting,
    /// It seeks.
    Seeking,
    /// It goes round an obstacle.
    Avoiding,
    /// It was stuck, or off the map, and drives to a random place on the map.
    Wandering,
    /// It circles the level set.
    Circling,
    /// It has arrived as often as it should, and stands.
    Arrived,
}
