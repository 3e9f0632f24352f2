//! One type for the applications of all stations of a search.

use std::sync::Arc;

use sextant_kernel::NodeId;
use sextant_sim::{Application, Applications, RobotBody, pass_on};

use super::node::{NodeSearchRecord, SearchNode};
use super::outbox::MessageCounts;
use super::record::RobotSearchRecord;
use super::robot::SearchRobot;
use super::settings::TargetSearch;
use super::sink::{Doubts, SearchSink};
use crate::mission::MissionTeam;
use crate::navigation::NavigationMap;

/// The application of a station that takes part in a search.
#[derive(Debug)]
pub enum SearchStation {
    /// Of a node.
    Node(Box<SearchNode>),
    /// Of a robot.
    Robot(Box<SearchRobot>),
    /// Of a sink.
    Sink(Box<SearchSink>),
}

/// What a station leaves behind.
#[derive(Clone, Debug, PartialEq)]
pub enum SearchRecord {
    /// A node.
    Node(NodeSearchRecord),
    /// A robot.
    Robot(Box<RobotSearchRecord>),
    /// A sink.
    Sink(MessageCounts),
}

impl TargetSearch {
    /// The applications of all stations, which know `map`.
    #[must_use]
    pub fn stations(
        self: &Arc<Self>,
        map: &Arc<NavigationMap>,
        team: MissionTeam<'_>,
    ) -> Applications<SearchStation> {
        let MissionTeam { nodes, robots, sinks, targets, network, duration, .. } = team;
        let radio = team.messages();
        let node = |node: usize| {
            let place = map.place(NodeId::from_index(node));
            let node = SearchNode::new(Arc::clone(self), network, place, radio.tx_power());
            SearchStation::Node(Box::new(node))
        };
        let robot = |(number, body): (usize, &RobotBody)| {
            let robot =
                SearchRobot::new(Arc::clone(self), Arc::clone(map), network, body, robots.len(), targets, duration);
            SearchStation::Robot(Box::new(robot.with_number(number)))
        };
        let doubts = self.doubt().map(|doubt| Doubts {
            confirming: doubt.confirming(),
            reach_m: doubt.reach_m(doubt.scale_of(map.bounds())),
        });
        Applications {
            nodes: (0..nodes).map(node).collect(),
            robots: robots.iter().enumerate().map(robot).collect(),
            sinks: (0..sinks)
                .map(|_| SearchStation::Sink(Box::new(SearchSink::new(network).with_doubts(doubts))))
                .collect(),
        }
    }
}

impl SearchStation {
    /// What it leaves behind.
    #[must_use]
    pub fn into_record(self) -> SearchRecord {
        match self {
            Self::Node(node) => SearchRecord::Node(node.into_record()),
            Self::Robot(robot) => SearchRecord::Robot(Box::new(robot.into_record())),
            Self::Sink(sink) => SearchRecord::Sink(sink.into_record()),
        }
    }
}

macro_rules! held {
    ($self:ident.$method:ident($($argument:expr),*)) => {
        match $self {
            Self::Node(node) => node.$method($($argument),*),
            Self::Robot(robot) => robot.$method($($argument),*),
            Self::Sink(sink) => sink.$method($($argument),*),
        }
    };
}

impl Application for SearchStation {
    pass_on!(held);
}
