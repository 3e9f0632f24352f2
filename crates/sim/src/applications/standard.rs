//! One type for the applications of all stations of a scenario.

use super::journey::Journey;
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::report::SendReport;
use crate::service::sensed::Sensed;
use crate::service::sweep::{Announcement, SweepAnswer};

/// The application of a station of a scenario, whose nodes have applications of the type `N`.
pub(crate) enum Standard<N> {
    /// Of a node.
    Node(N),
    /// Of a robot: its way.
    Robot(Box<Journey>),
    /// Of a sink: it takes what it receives.
    Sink,
}

impl<N: Application> Application for Standard<N> {
    fn hears(&self) -> bool {
        match self {
            Self::Node(node) => node.hears(),
            Self::Robot(journey) => journey.hears(),
            Self::Sink => true,
        }
    }

    fn senses(&self) -> bool {
        matches!(self, Self::Node(node) if node.senses())
    }

    fn has_task(&self) -> bool {
        match self {
            Self::Node(node) => node.has_task(),
            Self::Robot(journey) => journey.has_task(),
            Self::Sink => false,
        }
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Node(node) => node.started(port),
            Self::Robot(journey) => journey.started(port),
            Self::Sink => {}
        }
    }

    #[inline]
    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match self {
            Self::Node(node) => node.timed(timer, port),
            Self::Robot(journey) => journey.timed(timer, port),
            Self::Sink => {}
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        match self {
            Self::Node(node) => node.delivered(delivery, port),
            Self::Robot(journey) => journey.delivered(delivery, port),
            Self::Sink => {}
        }
    }

    #[inline]
    fn sent(&mut self, network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        match self {
            Self::Node(node) => node.sent(network, report, port),
            Self::Robot(journey) => journey.sent(network, report, port),
            Self::Sink => {}
        }
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        if let Self::Node(node) = self {
            node.sensed(sensed, port);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if let Self::Robot(journey) = self {
            journey.drive_ended(end, port);
        }
    }

    fn swept(&mut self, network: NetworkId, answers: &[SweepAnswer], port: &mut Port<'_>) {
        match self {
            Self::Node(node) => node.swept(network, answers, port),
            Self::Robot(journey) => journey.swept(network, answers, port),
            Self::Sink => {}
        }
    }

    fn announced(&mut self, announcement: &Announcement, port: &mut Port<'_>) {
        if let Self::Node(node) = self {
            node.announced(announcement, port);
        }
    }

    fn listened(&mut self, network: NetworkId, port: &mut Port<'_>) {
        match self {
            Self::Node(node) => node.listened(network, port),
            Self::Robot(journey) => journey.listened(network, port),
            Self::Sink => {}
        }
    }
}
