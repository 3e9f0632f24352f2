//! The links of stations that die.

use sextant_kernel::StationId;
use sextant_mac::RadioState;

use super::Links;
use super::sending::Ended;
use crate::link::links::EndingLinks;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::PacketEnd;

impl EndingLinks for Links {
    fn turn_off(&mut self, station: StationId, scene: &mut Scene) {
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

    fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene) {
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
}
