//! Frames that have left their link, or stay there: they are counted and traced.

use sextant_kernel::StationId;

use super::Links;
use crate::link::ieee802154::header;
use crate::link::ledger::CountedPacket;
use crate::link::track::Origin;
use crate::link::tsch::stack::{FrameKind, SlotFrame};
use crate::scene::Scene;
use crate::service::packet_trace::{PacketEnd, PacketFate};

impl Links {
    /// The packets that a station still has when it dies, or at the end.
    pub(super) fn leave(&mut self, station: StationId, end: PacketEnd, scene: &mut Scene) {
        for frame in self.stacks[station.index()].sender.take_all() {
            let fate = end.fate_of_left(frame.outcome);
            self.end_packet(station, frame, end, fate, scene);
        }
    }

    /// A frame of a station is none any more: if it is a packet, it is counted and traced.
    pub(super) fn end_packet(
        &mut self,
        station: StationId,
        mut frame: SlotFrame,
        end: PacketEnd,
        fate: PacketFate,
        scene: &mut Scene,
    ) {
        self.payloads.release(frame.content);
        if frame.kind != FrameKind::Data {
            return;
        }
        let payload_octets = u64::from(frame.mpdu_octets - header(self.pan, station, frame.to).overhead_octets());
        let (offered, transmissions) = (frame.offered, frame.transmissions.into());
        let counted = CountedPacket { offered, payload_octets, end, fate, transmissions, assessments: 0 };
        self.ledger.count(station, &counted);
        let Some(mut track) = frame.track.take() else { return };
        let origin = Origin { network: self.radios[0].network, station, counted_from: self.ledger.counted_from };
        let (traced, power) = (origin.traced(frame.packet(), end, fate), self.stacks[station.index()].tx_power);
        scene.traced.push(track.end(&traced, &self.ledger.radio_states, power, scene.now));
    }
}
