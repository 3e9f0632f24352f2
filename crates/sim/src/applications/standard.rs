//! One type for the applications that every scenario needs.

use super::source::Source;
use super::survey::Survey;
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::report::SendReport;
use crate::service::sweep::SweepAnswer;

/// One of the applications that every scenario needs.
pub(crate) enum Standard {
    /// Of a node: it sends traffic in a network.
    Source(Source),
    /// Of a node: it sends traffic in several networks, or in none.
    Sources(Box<[Source]>),
    /// Of a robot: its survey.
    Survey(Box<Survey>),
    /// Of a sink: it takes what it receives.
    Sink,
}

impl Application for Standard {
    fn hears(&self) -> bool {
        !matches!(self, Self::Source(_) | Self::Sources(_))
    }

    /// Nodes sense, so that what their sensors say can be observed.
    fn senses(&self) -> bool {
        matches!(self, Self::Source(_) | Self::Sources(_))
    }

    fn has_task(&self) -> bool {
        matches!(self, Self::Survey(_))
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Source(source) => source.started(port),
            Self::Sources(sources) => sources.iter_mut().for_each(|source| source.started(port)),
            Self::Survey(survey) => survey.started(port),
            Self::Sink => {}
        }
    }

    #[inline]
    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match self {
            Self::Source(source) => source.timed(timer, port),
            Self::Sources(sources) => {
                let due = |source: &&mut Source| Timer(source.network().0.into()) == timer;
                sources.iter_mut().filter(due).for_each(|source| source.timed(timer, port));
            }
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
        match self {
            Self::Source(source) => source.sent(network, report, port),
            Self::Sources(sources) => {
                let of_network = |source: &&mut Source| source.network() == network;
                sources.iter_mut().filter(of_network).for_each(|source| source.sent(network, report, port));
            }
            Self::Survey(_) | Self::Sink => {}
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

    fn swept(&mut self, network: NetworkId, answers: &[SweepAnswer], port: &mut Port<'_>) {
        if let Self::Survey(survey) = self {
            survey.swept(network, answers, port);
        }
    }
}
