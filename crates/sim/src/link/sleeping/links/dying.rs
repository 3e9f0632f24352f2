//! The links of stations that die.

use sextant_kernel::StationId;
use sextant_mac::RadioState;

use super::Links;
use crate::link::links::EndingLinks;
use crate::link::sleeping::stack::Work;
use crate::scene::Scene;
use crate::service::outcome::Deafness;
use crate::service::packet_trace::PacketEnd;

impl EndingLinks for Links {
    fn turn_off(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &self.stacks[station.index()];
        if stack.on_air.is_some() || !stack.is_there {
            return;
        }
        self.count_idle(station, scene.now);
        self.leave(station, PacketEnd::Died, scene);
        let stack = &mut self.stacks[station.index()];
        let work = match std::mem::replace(&mut stack.work, Work::None) {
            Work::BackingOff(key) | Work::Aiming { key, .. } => Some(key),
            Work::None | Work::Sending => None,
        };
        let planned = stack.planned.take().map(|planned| planned.key);
        for key in [work, planned, stack.timer.take()].into_iter().flatten() {
            scene.queue.cancel(key);
        }
        stack.is_there = false;
        stack.sleeper.turn_off();
        stack.usage.enter(RadioState::Sleep, scene.now);
        self.radios.tune(station, Some(Deafness::Off), &mut stack.deafness, scene);
    }

    fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene) {
        for frame in std::mem::take(&mut self.stacks[station.index()].waiting) {
            let fate = end.fate_of_left(frame.outcome);
            self.end_packet(station, frame, end, fate, scene);
        }
    }
}
