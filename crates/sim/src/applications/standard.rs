//! One type for the applications of all stations of a scenario.

use super::journey::Journey;
use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::delivery::{Delivery, DriveEnd};
use crate::service::network_id::NetworkId;
use crate::service::radio_event::RadioEvent;
use crate::service::report::SendReport;
use crate::service::sensed::Sensed;
use crate::service::sweep::{Announcement, SweepAnswer};
use crate::station::StationKind;

/// The application of a station of a scenario. Nodes have applications of the type `N`, and robots and sinks may.
pub(crate) enum Standard<N> {
    /// Of a station that says itself what it does.
    Own(N),
    /// Of a robot that its controller drives: its way.
    Robot(Box<Journey>),
    /// Of a sink: it takes what it receives.
    Sink,
    /// Of a robot that is simulated elsewhere.
    Absent,
}

impl<N: Application> Application for Standard<N> {
    fn hears(&self) -> bool {
        match self {
            Self::Own(own) => own.hears(),
            Self::Robot(journey) => journey.hears(),
            Self::Sink => true,
            Self::Absent => false,
        }
    }

    fn senses(&self) -> bool {
        matches!(self, Self::Own(own) if own.senses())
    }

    fn has_task(&self) -> bool {
        match self {
            Self::Own(own) => own.has_task(),
            Self::Robot(journey) => journey.has_task(),
            Self::Sink | Self::Absent => false,
        }
    }

    fn may_rest(&self) -> bool {
        matches!(self, Self::Own(own) if own.may_rest())
    }

    fn woken(&mut self, port: &mut Port<'_>) {
        if let Self::Own(own) = self {
            own.woken(port);
        }
    }

    fn ended(&mut self, port: &mut Port<'_>) {
        if let Self::Own(own) = self {
            own.ended(port);
        }
    }

    fn started(&mut self, port: &mut Port<'_>) {
        match self {
            Self::Own(own) => {
                if matches!(port.kind(), StationKind::Robot(_)) {
                    port.tell_start();
                }
                own.started(port);
            }
            Self::Robot(journey) => journey.started(port),
            Self::Sink | Self::Absent => {}
        }
    }

    #[inline]
    fn timed(&mut self, timer: Timer, port: &mut Port<'_>) {
        match self {
            Self::Own(own) => own.timed(timer, port),
            Self::Robot(journey) => journey.timed(timer, port),
            Self::Sink | Self::Absent => {}
        }
    }

    fn delivered(&mut self, delivery: &Delivery<'_>, port: &mut Port<'_>) {
        match self {
            Self::Own(own) => own.delivered(delivery, port),
            Self::Robot(journey) => journey.delivered(delivery, port),
            Self::Sink | Self::Absent => {}
        }
    }

    #[inline]
    fn sent(&mut self, network: NetworkId, report: &SendReport, port: &mut Port<'_>) {
        match self {
            Self::Own(own) => own.sent(network, report, port),
            Self::Robot(journey) => journey.sent(network, report, port),
            Self::Sink | Self::Absent => {}
        }
    }

    fn radio(&mut self, network: NetworkId, event: &RadioEvent<'_>, port: &mut Port<'_>) {
        match self {
            Self::Own(own) => own.radio(network, event, port),
            Self::Robot(journey) => journey.radio(network, event, port),
            Self::Sink | Self::Absent => {}
        }
    }

    fn sensed(&mut self, sensed: &Sensed, port: &mut Port<'_>) {
        if let Self::Own(own) = self {
            own.sensed(sensed, port);
        }
    }

    fn drive_ended(&mut self, end: DriveEnd, port: &mut Port<'_>) {
        match self {
            Self::Own(own) => own.drive_ended(end, port),
            Self::Robot(journey) => journey.drive_ended(end, port),
            Self::Sink | Self::Absent => {}
        }
    }

    fn swept(&mut self, network: NetworkId, answers: &[SweepAnswer], port: &mut Port<'_>) {
        match self {
            Self::Own(own) => own.swept(network, answers, port),
            Self::Robot(journey) => journey.swept(network, answers, port),
            Self::Sink | Self::Absent => {}
        }
    }

    fn announced(&mut self, announcement: &Announcement, port: &mut Port<'_>) {
        if let Self::Own(own) = self {
            own.announced(announcement, port);
        }
    }

    fn listened(&mut self, network: NetworkId, port: &mut Port<'_>) {
        match self {
            Self::Own(own) => own.listened(network, port),
            Self::Robot(journey) => journey.listened(network, port),
            Self::Sink | Self::Absent => {}
        }
    }
}
