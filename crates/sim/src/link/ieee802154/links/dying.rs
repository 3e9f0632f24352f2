//! The links of stations that die.

use sextant_kernel::StationId;
use sextant_mac::{RadioState, csma, responder};

use super::Links;
use crate::event::ieee802154::Event;
use crate::link::ieee802154::frame_queue::QueuedFrame;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::PacketFate;

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
        if self.ledger.is_depleted(station) {
            self.abandon(station, scene);
        }
    }

    /// The packets of a station whose battery is empty are lost.
    fn abandon(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let (outcome, sequence) = (stack.outcome, stack.sequence);
        let mut track = stack.track.take();
        let under_way = stack.frame.take();
        let waiting = std::mem::take(&mut stack.waiting);
        for frame in under_way.into_iter().chain(waiting) {
            let is_under_way = under_way.is_some_and(|under_way| under_way.id == frame.id);
            // A frame that was received counts so, though its acknowledgement was not awaited.
            let fate = match outcome {
                FrameOutcome::Received if is_under_way => PacketFate::Sent(outcome),
                _ => PacketFate::Depleted,
            };
            self.count_abandoned(station, &frame, fate);
            if let Some(track) = &mut track {
                let sequence = is_under_way.then_some(sequence);
                self.trace_abandoned(track, station, &frame, fate, sequence, scene);
            }
            self.payloads.release(frame.content);
        }
        self.stacks[station.index()].track = track;
    }

    fn count_abandoned(&mut self, station: StationId, frame: &QueuedFrame, fate: PacketFate) {
        if frame.offered < self.ledger.counted_from {
            return;
        }
        let octets = u64::from(frame.mpdu_octets - self.data_frame(station, frame.to).overhead_octets());
        let packets = &mut self.ledger.packets[station.index()];
        if let PacketFate::Sent(outcome) = fate {
            packets.transmissions += 1;
            packets.octets_received += octets;
            packets.count_sent(outcome);
        } else {
            packets.depleted += 1;
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
