//! One type for the applications of all stations.

use std::sync::Arc;

use sextant_sim::{Application, Applications, DriveEnd, Port, Timer};

use super::robot::BeamRobot;
use super::settings::BeamTracking;
use crate::mission::{LinkRecord, MissionTeam};
use crate::navigation::NavigationMap;

/// The application of a station.
#[derive(Debug)]
pub enum BeamStation {
    /// Of a robot.
    Robot(Box<BeamRobot>),
    /// Of a node or a sink: what nodes do follows from what the robot does.
    Still,
}

impl BeamTracking {
    /// The applications of all stations, which know `map`.
    #[must_use]
    pub fn stations(self: &Arc<Self>, map: &Arc<NavigationMap>, team: MissionTeam<'_>) -> Applications<BeamStation> {
        let robot = || {
            let robot = BeamRobot::new(Arc::clone(self), Arc::clone(map), team.network, team.nodes);
            BeamStation::Robot(Box::new(robot))
        };
        Applications {
            nodes: (0..team.nodes).map(|_| BeamStation::Still).collect(),
            robots: team.robots.iter().map(|_| robot()).collect(),
            sinks: (0..team.sinks).map(|_| BeamStation::Still).collect(),
        }
    }
}

impl BeamStation {
    /// What it leaves behind.
    #[must_use]
    pub fn into_record(self) -> Option<LinkRecord> {
        match self {
            Self::Robot(robot) => Some(robot.into_record()),
            Self::Still => None,
        }
    }
}

impl Application for BeamStation {
    fn has_task(&self) -> bool {
        matches!(self, Self::Robot(_))
    }

    fn started(&mut self, port: &mut Port<'_>) {
        if let Self::Robot(robot) = self {
            robot.started(port);
        }
    }

    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        if let Self::Robot(robot) = self {
            robot.timed(timer, port);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if let Self::Robot(robot) = self {
            robot.drive_ended(end, port);
        }
    }
}
