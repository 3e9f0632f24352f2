//! One type for the applications that every scenario needs.

use super::source::Source;
use super::survey::Survey;
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::report::SendReport;

/// One of the applications that every scenario needs.
pub(crate) enum Standard {
    /// Of a node: it sends traffic.
    Source(Source),
    /// Of a robot: its survey.
    Survey(Box<Survey>),
    /// Of a sink: it takes what it receives.
    Sink,
}

impl Application for Standard {
    fn hears(&self) -> bool {
        !matches!(self, Self::Source(_))
    }

    /// Nodes sense, so that what their sensors say can be observed.
    fn senses(&self) -> bool {
        matches!(self, Self::Source(_))
    }

    fn has_task(&self) -> bool {
        matches!(self, Self::Survey(_))
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Source(source) => source.started(port),
            Self::Survey(survey) => survey.started(port),
            Self::Sink => {}
        }
    }

    #[inline]
    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match self {
            Self::Source(source) => source.timed(timer, port),
            Self::Survey(survey) => survey.timed(timer, port),
            Self::Sink => {}
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        if let Self::Survey(survey) = self {
            survey.delivered(delivery, port);
        }
    }

    #[inline]
    fn sent(&mut self, network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        if let Self::Source(source) = self {
            source.sent(network, report, port);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        if let Self::Survey(survey) = self {
            survey.drive_ended(end, port);
        }
    }

    fn listened(&mut self, network: NetworkId, port: &mut Port<'_>) {
        if let Self::Survey(survey) = self {
            survey.listened(network, port);
        }
    }
}
