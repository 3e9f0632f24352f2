//! The links of stations that die.

use sextant_kernel::StationId;
use sextant_mac::{RadioState, csma, responder};

use super::Links;
use super::sending::Ended;
use crate::event::ieee802154::Event;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::PacketEnd;

impl Links {
    /// A station dies: its radio is off from now on, or from the end of the frame on air.
    pub(super) fn turn_off(&mut self, station: StationId, scene: &mut Scene) {
        self.catch_up_now(station, scene);
        let stack = &mut self.stacks[station.index()];
        if stack.transmission.is_some() || stack.acknowledgement.is_some() {
            return;
        }
        stack.is_dead = true;
        (stack.due, stack.plan) = (None, None);
        stack.wanted = RadioState::Sleep;
        stack.overriding = None;
        stack.awaits_ack = false;
        stack.listening = false;
        stack.leaving = false;
        self.transceiver(station, scene).tune();
        self.leave(station, PacketEnd::Died, scene);
    }

    /// The packets that a station still has when it dies, or at the end.
    pub(super) fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let (outcome, transmissions, sequence) = (stack.outcome, stack.transmissions, stack.sequence);
        let under_way = stack.frame.take().map(|frame| (frame, Some(sequence), outcome, transmissions));
        let waiting = std::mem::take(&mut stack.waiting);
        let waiting = waiting.into_iter().map(|frame| (frame, None, FrameOutcome::WORST, 0));
        for (frame, sequence, outcome, transmissions) in under_way.into_iter().chain(waiting) {
            let fate = end.fate_of_left(outcome);
            self.end_packet(station, &frame, Ended { end, fate, transmissions, assessments: 0 }, sequence, scene);
        }
    }

    /// Whether an event is the end of the frame that a station has on air.
    pub(super) fn is_end_of_frame(&self, station: StationId, event: Event) -> bool {
        let stack = &self.stacks[station.index()];
        match event {
            Event::Csma(csma::Event::TransmissionEnded) => stack.transmission.is_some(),
            Event::Responder(responder::Event::TransmissionEnded) => stack.acknowledgement.is_some(),
            _ => false,
        }
    }
}
