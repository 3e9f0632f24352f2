//! The stations: everything that has a radio. Nodes are the first stations, robots follow, sinks are the last.

mod motion;
mod odometry;
mod own_frame;
mod range_sensors;
mod robot;
mod robot_pose;
mod sink;
mod way;

use sextant_kernel::StationId;

pub use motion::Pose;
pub(crate) use motion::{Curve, LONGEST_S, Motion, Trip, time_of};
pub(crate) use odometry::Luck;
pub use odometry::{Odometry, OdometryConfig};
pub use own_frame::{OwnFrame, OwnFrameConfig};
pub(crate) use range_sensors::RangeSensors;
pub(crate) use robot::check_name;
pub use robot::{Listening, RobotBody, RobotConfig, RoleConfig};
pub use robot_pose::RobotPose;
pub use sink::{Sink, SinkConfig};
pub(crate) use way::Way;

/// Which stations are nodes, robots and sinks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Roll {
    pub(crate) nodes: usize,
    pub(crate) robots: usize,
    pub(crate) sinks: usize,
}

/// What a station is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StationKind {
    /// A sensor node, with its number among the nodes.
    Node(usize),
    /// A robot, with its number among the robots.
    Robot(usize),
    /// A fixed sink, with its number among the sinks.
    Sink(usize),
}

impl Roll {
    pub(crate) fn len(&self) -> usize {
        self.nodes + self.robots + self.sinks
    }

    pub(crate) fn kind(&self, station: StationId) -> StationKind {
        let index = station.index();
        if index < self.nodes {
            StationKind::Node(index)
        } else if index < self.nodes + self.robots {
            StationKind::Robot(index - self.nodes)
        } else {
            StationKind::Sink(index - self.nodes - self.robots)
        }
    }

    pub(crate) fn is_node(&self, station: StationId) -> bool {
        station.index() < self.nodes
    }

    pub(crate) fn is_robot(&self, station: StationId) -> bool {
        matches!(self.kind(station), StationKind::Robot(_))
    }

    pub(crate) fn robot(&self, robot: usize) -> StationId {
        StationId::from_index(self.nodes + robot)
    }

    pub(crate) fn stations(&self) -> impl Iterator<Item = StationId> + use<> {
        (0..self.len()).map(StationId::from_index)
    }
}
