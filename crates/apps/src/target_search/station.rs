//! One type for the applications of all stations of a search.

use std::sync::Arc;

use sextant_kernel::NodeId;
use sextant_sim::{
    Application, Applications, Delivery, DriveEnd, NetworkId, Port, RobotBody, SendReport, Sensed, Timer,
};

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

    fn application(&mut self) -> &mut dyn Application {
        match self {
            Self::Node(node) => node.as_mut(),
            Self::Robot(robot) => robot.as_mut(),
            Self::Sink(sink) => sink.as_mut(),
        }
    }
}

impl Application for SearchStation {
    fn hears(&self) -> bool {
        true
    }

    fn senses(&self) -> bool {
        matches!(self, Self::Node(_))
    }

    fn has_task(&self) -> bool {
        matches!(self, Self::Robot(_))
    }

    fn started(&mut self, port: &mut Port<'_>) {
        self.application().started(port);
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        self.application().timed(timer, port);
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        self.application().delivered(delivery, port);
    }

    fn sent(&mut self, network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        self.application().sent(network, report, port);
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        self.application().sensed(sensed, port);
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        self.application().drive_ended(end, port);
    }
}
