//! The links of stations that die.

use sextant_kernel::StationId;
use sextant_mac::RadioState;

use super::Links;
use crate::link::ieee80211ad::stack::{RadioTask, Role};
use crate::link::links::EndingLinks;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::PacketEnd;

impl EndingLinks for Links {
    fn turn_off(&mut self, station: StationId, scene: &mut Scene) {
        let radio = &mut self.stacks[station.index()].radio;
        if radio.on_air.is_some() {
            return;
        }
        radio.state = RadioState::Sleep;
        self.transceiver(station, Role::Responder, scene).0.tune();
        self.leave(station, PacketEnd::Died, scene);
    }

    fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene) {
        let fate = end.fate_of_left(FrameOutcome::WORST);
        let stack = &mut self.stacks[station.index()];
        let (is_answering, answer, sweeps) = (stack.is_answering, stack.outcome, u64::from(stack.has_answered));
        let has_next = stack.next_sweep.is_some();
        match stack.task.take() {
            Some(RadioTask::Broadcast(broadcast)) => {
                let fate = end.fate_of_left(broadcast.outcome);
                self.end_payload(station, &broadcast, (end, fate), Some(broadcast.sequence()), scene);
            }
            Some(RadioTask::Sweep(_)) => self.end_own_sweep(station, end, fate, scene),
            None => {}
        }
        if has_next {
            self.end_own_sweep(station, end, fate, scene);
        }
        self.stacks[station.index()].next_sweep = None;
        for broadcast in std::mem::take(&mut self.stacks[station.index()].waiting) {
            self.end_payload(station, &broadcast, (end, fate), None, scene);
        }
        if is_answering {
            self.end_answer(station, end, end.fate_of_left(answer), sweeps, scene);
        }
    }
}
