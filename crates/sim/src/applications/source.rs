//! A node that sends traffic and looks at nothing that it hears.

use crate::application::{Application, Port};
use crate::event::Timer;
use crate::service::network_id::NetworkId;
use crate::service::report::{Destination, Payload};

use super::traffic::Traffic;

/// The timer of the next frame.
const DUE: Timer = Timer(0);

/// A source of traffic in one network.
#[derive(Clone, Debug)]
pub(crate) struct Source {
    network: NetworkId,
    traffic: Traffic,
    to: Destination,
    /// Frames offered so far.
    count: u64,
    /// Frames to offer.
    limit: u64,
}

impl Source {
    pub(crate) fn new(network: NetworkId, traffic: Traffic, to: Destination) -> Self {
        Self { network, traffic, to, count: 0, limit: u64::MAX }
    }

    pub(crate) fn with_limit(self, limit: u64) -> Self {
        Self { limit, ..self }
    }

    /// Schedules the next frame, if there is one.
    fn schedule(&self, port: &mut Port<'_>) {
        if self.count >= self.limit {
            return;
        }
        let Some(node) = port.node(port.station()) else { return };
        if let Some(due) = self.traffic.due(port.seed(), node, self.count) {
            port.after(due.saturating_since(port.now()), DUE);
        }
    }
}

impl Application for Source {
    fn started(&mut self, port: &mut Port<'_>) {
        self.schedule(port);
    }

    fn timed(&mut self, _timer: Timer, port: &mut Port<'_>) {
        self.count += 1;
        // A frame that finds the queue full is lost, and the link counts it.
        let _ = port.send(self.network, self.to, Payload::Filler(self.traffic.mpdu_octets()));
        self.schedule(port);
    }
}
