//! The links of stations that die.

use sextant_kernel::StationId;

use super::Links;
use crate::event::tsch::Event;
use crate::link::links::EndingLinks;
use crate::link::tsch::stack::Membership;
use crate::scene::Scene;
use crate::service::outcome::Deafness;
use crate::service::packet_trace::PacketEnd;

impl EndingLinks for Links {
    fn turn_off(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &self.stacks[station.index()];
        if stack.is_on_air() || matches!(stack.membership, Membership::Out) {
            return;
        }
        self.count_idle(station, scene.now);
        self.leave(station, PacketEnd::Died, scene);
        let stack = &mut self.stacks[station.index()];
        stack.usage.count_scan(scene.now);
        let change = match stack.membership {
            Membership::Scanning { change, .. } => Some(change),
            Membership::Joined | Membership::Out => None,
        };
        let missed = stack.sending.take().and_then(|sending| sending.missed);
        let answer = stack.answer.take();
        let starts = answer.and_then(|answer| answer.starts);
        let planned = stack.planned.take().map(|planned| planned.key);
        let agreement = stack.agreement.take().map(|(_, key)| key);
        for key in [change, missed, starts, planned, agreement, stack.check.take()].into_iter().flatten() {
            scene.queue.cancel(key);
        }
        stack.membership = Membership::Out;
        stack.listening = None;
        stack.history.change(&[], scene.now);
        self.listeners.remove(station, &stack.schedule);
        stack.deafness = Some(Deafness::Off);
        for radios in &self.radios {
            scene.tune(radios.air, radios.interface(station), Some(Deafness::Off));
        }
        if let Some(answer) = answer {
            // Its acknowledgement never comes.
            let span = self.settings.timeslot.ack_window();
            let missed = self.schedule(answer.to, span, Event::AckMissed, scene);
            if let Some(sending) = &mut self.stacks[answer.to.index()].sending {
                sending.missed = Some(missed);
            }
        }
    }
    fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene) {
        for frame in self.stacks[station.index()].sender.take_all() {
            let fate = end.fate_of_left(frame.outcome);
            self.end_packet(station, frame, end, fate, scene);
        }
    }
}
