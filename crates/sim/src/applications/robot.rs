//! Robots: bodies, and what they are there for.

use super::broadcast::Broadcast;
use super::controller::Controller;
use crate::station::RobotBody;

/// A robot: a body, and what it is there for. A copy starts afresh from where this one is.
#[derive(Clone)]
pub struct Robot {
    /// The body.
    pub body: RobotBody,
    /// What it is there for.
    pub task: RobotTask,
}

/// What a robot is there for.
#[derive(Clone)]
pub enum RobotTask {
    /// It surveys: it drives as its controller says, listens at its stops, and logs what it hears.
    Survey(Box<dyn Controller>),
    /// It is a mobile anchor: it sends a message to all at each stop. It hears nothing, and its stops are in no log:
    /// mappers would take them for stops where it heard no node.
    MobileAnchor {
        /// What drives it.
        controller: Box<dyn Controller>,
        /// What it sends.
        broadcast: Box<dyn Broadcast>,
    },
    /// A given application says what it does: see [`Simulation::with`](crate::Simulation::with).
    Own,
}

impl Robot {
    /// Whether it listens at its stops, and logs them.
    #[must_use]
    pub fn is_surveying(&self) -> bool {
        matches!(self.task, RobotTask::Survey(_))
    }

    /// Whether it is a mobile anchor.
    #[must_use]
    pub(crate) fn is_mobile_anchor(&self) -> bool {
        matches!(self.task, RobotTask::MobileAnchor { .. })
    }

    /// The same as a mobile anchor that sends `broadcast`; a robot with a given application stays as it is.
    #[must_use]
    pub fn with_broadcast(self, broadcast: Box<dyn Broadcast>) -> Self {
        let task = match self.task {
            RobotTask::Survey(controller) | RobotTask::MobileAnchor { controller, .. } => {
                RobotTask::MobileAnchor { controller, broadcast }
            }
            RobotTask::Own => RobotTask::Own,
        };
        Self { task, ..self }
    }
}
