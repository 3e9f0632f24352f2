//! The radios of stations that die.

use sextant_kernel::StationId;

use super::Links;
use crate::link::links::EndingLinks;
use crate::scene::Scene;
use crate::service::packet_trace::PacketEnd;

impl EndingLinks for Links {
    fn turn_off(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        if stack.on_air.is_some() || stack.is_dead {
            return;
        }
        stack.is_dead = true;
        stack.cancel_all(scene);
        stack.radio.turn_off();
        if let Some(outgoing) = stack.outgoing.take() {
            self.payloads.free(outgoing.payload);
        }
        self.settle(station, scene);
        self.leave(station, PacketEnd::Died, scene);
    }

    fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene) {
        for packet in std::mem::take(&mut self.stacks[station.index()].open) {
            let fate = end.fate_of_left(packet.outcome);
            self.end_packet(station, packet, end, fate, scene);
        }
    }
}
