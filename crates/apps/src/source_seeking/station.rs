//! One type for the applications of all stations that take part in source seeking.

use std::sync::Arc;

use sextant_kernel::NodeId;
use sextant_sim::{Application, Applications, RobotBody, pass_on};

use super::node::SeekNode;
use super::record::SeekRecord;
use super::robot::SeekRobot;
use super::settings::SourceSeeking;
use crate::mission::MissionTeam;
use crate::navigation::NavigationMap;

/// The application of a station that takes part in source seeking.
#[derive(Debug)]
pub enum SeekStation {
    /// Of a node.
    Node(Box<SeekNode>),
    /// Of a robot.
    Robot(Box<SeekRobot>),
    /// Of a sink: it does nothing.
    Sink,
}

impl SourceSeeking {
    /// The applications of all stations, which know `map`.
    #[must_use]
    pub fn stations(self: &Arc<Self>, map: &Arc<NavigationMap>, team: MissionTeam<'_>) -> Applications<SeekStation> {
        let MissionTeam { nodes, robots, sinks, network, .. } = team;
        let radio = team.messages();
        let node = |node: usize| {
            let node = SeekNode::new(network, map.place(NodeId::from_index(node)), radio.tx_power());
            SeekStation::Node(Box::new(node))
        };
        let robot = |body: &RobotBody| {
            let robot = SeekRobot::new(Arc::clone(self), Arc::clone(map), network, body.speed_m_per_s);
            SeekStation::Robot(Box::new(robot))
        };
        Applications {
            nodes: (0..nodes).map(node).collect(),
            robots: robots.iter().map(robot).collect(),
            sinks: (0..sinks).map(|_| SeekStation::Sink).collect(),
        }
    }
}

impl SeekStation {
    /// What it leaves behind.
    #[must_use]
    pub fn into_record(self) -> SeekRecord {
        match self {
            Self::Node(node) => SeekRecord::Node(node.into_record()),
            Self::Robot(robot) => SeekRecord::Robot(Box::new(robot.into_record())),
            Self::Sink => SeekRecord::Sink,
        }
    }
}

macro_rules! held {
    ($self:ident.$method:ident($($argument:expr),*)) => {
        match $self {
            Self::Node(node) => node.$method($($argument),*),
            Self::Robot(robot) => robot.$method($($argument),*),
            Self::Sink => Default::default(),
        }
    };
}

impl Application for SeekStation {
    pass_on!(held);
}
