//! One type for the applications of all stations of a scenario.

use super::journey::Journey;
use crate::application::{Application, Port};
use crate::station::StationKind;

/// The application of a station of a scenario. Nodes have applications of the type `N`, and robots and sinks may.
pub(crate) enum Standard<N> {
    /// Of a station that says itself what it does.
    Own(N),
    /// Of a robot that its controller drives: its way.
    Robot(Box<Journey>),
    /// Of a sink.
    Sink(Receiver),
    /// Of a robot that is simulated elsewhere.
    Absent,
}

/// A sink without an own application: it takes what it receives.
pub(crate) struct Receiver;

impl Application for Receiver {
    fn hears(&self) -> bool {
        true
    }
}

macro_rules! held {
    ($self:ident.$method:ident($($argument:expr),*)) => {
        match $self {
            Self::Own(own) => own.$method($($argument),*),
            Self::Robot(journey) => journey.$method($($argument),*),
            Self::Sink(sink) => sink.$method($($argument),*),
            Self::Absent => Default::default(),
        }
    };
}

impl<N: Application> Application for Standard<N> {
    fn started(&mut self, port: &mut Port<'_>) {
        if matches!((&*self, port.kind()), (Self::Own(_), StationKind::Robot(_))) {
            port.tell_start();
        }
        held!(self.started(port))
    }

    crate::pass_on!(held but started);
}
