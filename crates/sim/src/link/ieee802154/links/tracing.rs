//! Traces of packets, if somebody wants them.

use sextant_kernel::{SimTime, StationId};

use super::Links;
use crate::link::ieee802154::frame_queue::QueuedFrame;
use crate::link::payloads::Content;
use crate::link::track::{PacketTrack, Traced};
use crate::scene::Scene;
use crate::service::packet_trace::{PacketEnd, PacketFate, PacketKind, PacketTrace};
use crate::service::report::{Destination, FrameId, Payload};

/// A frame for which there was no room.
#[derive(Clone, Copy, Debug)]
pub(super) struct RefusedFrame<'a> {
    pub(super) id: FrameId,
    pub(super) to: Destination,
    pub(super) mpdu_octets: u8,
    pub(super) payload: Payload<'a>,
}

impl Links {
    /// Traces a frame for which the queue of `station` had no room.
    pub(super) fn trace_refused(&mut self, station: StationId, refused: RefusedFrame<'_>, scene: &mut Scene) {
        let RefusedFrame { id, to, mpdu_octets, payload } = refused;
        if self.stacks[station.index()].track.is_none() {
            return;
        }
        let (end, fate) = (PacketEnd::QueueFull, PacketFate::LostQueue);
        let traced = self.traced(station, id, to, mpdu_octets, scene.now).with_end(end, fate);
        let payload = match payload {
            Payload::Octets(octets) => octets,
            Payload::Filler(_) => &[],
        };
        self.tell(&mut PacketTrack::default(), station, &traced, payload, scene);
    }

    /// Traces a frame of `station` that is none any more.
    pub(super) fn trace_ended(
        &mut self,
        station: StationId,
        frame: &QueuedFrame,
        (end, fate): (PacketEnd, PacketFate),
        sequence: Option<u8>,
        scene: &mut Scene,
    ) {
        let Some(mut track) = self.stacks[station.index()].track.take() else { return };
        let traced = self.traced_frame(station, frame).with_end(end, fate);
        self.tell(&mut track, station, &Traced { sequence, ..traced }, self.payload_of(frame), scene);
        self.stacks[station.index()].track = Some(track);
    }

    fn traced_frame(&self, station: StationId, frame: &QueuedFrame) -> Traced {
        let &QueuedFrame { id, to, mpdu_octets, offered, .. } = frame;
        self.traced(station, id, to, mpdu_octets, offered)
    }

    /// What is known of a frame when it is offered.
    fn traced(
        &self,
        source: StationId,
        FrameId(number): FrameId,
        to: Destination,
        mpdu_octets: u8,
        offered: SimTime,
    ) -> Traced {
        Traced {
            network: self.radios.network,
            source,
            kind: PacketKind::Data,
            number,
            sequence: None,
            to,
            octets: mpdu_octets.into(),
            offered,
            counts: offered >= self.ledger.counted_from,
            end: PacketEnd::Pending,
            fate: PacketFate::Pending,
        }
    }

    /// The payload of a frame; empty if it says nothing.
    fn payload_of(&self, frame: &QueuedFrame) -> &[u8] {
        match frame.content {
            Content::Filler => &[],
            Content::Octets(slot) => self.payloads.octets(slot),
        }
    }

    fn tell(&self, track: &mut PacketTrack, station: StationId, traced: &Traced, payload: &[u8], scene: &mut Scene) {
        let power = self.stacks[station.index()].tx_power;
        let trace = track.end(traced, &self.ledger.radio_states, power, scene.now);
        scene.traced.push(PacketTrace { payload: payload.to_vec(), ..trace });
    }
}

impl Traced {
    fn with_end(self, end: PacketEnd, fate: PacketFate) -> Self {
        Self { end, fate, ..self }
    }
}
