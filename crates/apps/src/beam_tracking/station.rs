//! One type for the applications of all stations.

use std::sync::Arc;

use sextant_sim::{Application, Applications, pass_on};

use super::robot::BeamRobot;
use super::settings::BeamTracking;
use crate::mission::{LinkRecord, MissionTeam};
use crate::navigation::NavigationMap;

/// The application of a station.
#[derive(Debug)]
pub(super) enum BeamStation {
    /// Of a robot.
    Robot(Box<BeamRobot>),
    /// Of a node or a sink: what nodes do follows from what the robot does.
    Still,
}

impl BeamTracking {
    /// The applications of all stations, which know `map`.
    #[must_use]
    pub(super) fn stations(
        self: &Arc<Self>,
        map: &Arc<NavigationMap>,
        team: MissionTeam<'_>,
    ) -> Applications<BeamStation> {
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
    pub(super) fn into_record(self) -> Option<LinkRecord> {
        match self {
            Self::Robot(robot) => Some(robot.into_record()),
            Self::Still => None,
        }
    }
}

macro_rules! held {
    ($self:ident.$method:ident($($argument:expr),*)) => {
        match $self {
            Self::Robot(robot) => robot.$method($($argument),*),
            Self::Still => Default::default(),
        }
    };
}

impl Application for BeamStation {
    pass_on!(held);
}
