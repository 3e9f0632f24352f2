//! What a station sends, and the count of it.

use sextant_kernel::StationId;
use sextant_sim::{Destination, FrameId, NetworkId, Payload, Port, sum_fields};

use super::message::Message;

/// What a station gave to its link.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MessageCounts {
    /// Questions of robots.
    pub requests: u64,
    /// Answers of nodes.
    pub answers: u64,
    /// Messages that tell the way to a sink.
    pub tree: u64,
    /// Messages to a sink about a first detection, each hop counted.
    pub detections: u64,
    /// Messages of sinks to all, each hop counted.
    pub alarms: u64,
    /// Messages among robots, each hop counted.
    pub claims: u64,
    /// Messages about pseudo-gradients.
    pub gradients: u64,
    /// Payload of all of them (octets).
    pub octets: u64,
    /// Messages that the link did not take, because its queue was full: they are not counted above.
    pub refused: u64,
}

sum_fields!(MessageCounts { requests, answers, tree, detections, alarms, claims, gradients, octets, refused });

impl MessageCounts {
    /// All messages.
    #[must_use]
    pub fn total(&self) -> u64 {
        let Self { requests, answers, tree, detections, alarms, claims, gradients, octets: _, refused: _ } = self;
        requests + answers + tree + detections + alarms + claims + gradients
    }
}

/// Sends messages of a station over its network.
#[derive(Clone, Debug)]
pub(super) struct Outbox {
    network: NetworkId,
    pub(super) counts: MessageCounts,
}

impl Outbox {
    pub(super) fn new(network: NetworkId) -> Self {
        Self { network, counts: MessageCounts::default() }
    }

    /// Sends a message to all that hear it.
    pub(super) fn broadcast(&mut self, message: &Message, port: &mut Port<'_>) {
        self.send(message, Destination::All, port);
    }

    /// Sends a message to one station, which acknowledges it. `None` if the link does not take it.
    pub(super) fn unicast(&mut self, message: &Message, to: StationId, port: &mut Port<'_>) -> Option<FrameId> {
        self.send(message, Destination::Station(to), port)
    }

    fn send(&mut self, message: &Message, to: Destination, port: &mut Port<'_>) -> Option<FrameId> {
        let octets = message.to_octets();
        let Ok(frame) = port.send(self.network, to, Payload::Octets(&octets)) else {
            self.counts.refused += 1;
            return None;
        };
        let counts = &mut self.counts;
        counts.octets += octets.len() as u64;
        *match message {
            Message::Request(_) => &mut counts.requests,
            Message::Answer(..) => &mut counts.answers,
            Message::Tree { .. } => &mut counts.tree,
            Message::Detection(_) => &mut counts.detections,
            Message::Alarm { .. } => &mut counts.alarms,
            Message::Claim { .. } => &mut counts.claims,
            Message::Gradient(_) => &mut counts.gradients,
        } += 1;
        Some(frame)
    }
}
