//! Frames are offered, and what becomes of them is counted.

use sextant_kernel::StationId;

use super::Links;
use crate::link::ieee802154::{EndedPacket, Origin, header, offered_octets};
use crate::link::payloads::Content;
use crate::link::track::PacketTrack;
use crate::link::tsch::stack::{FrameKind, Membership, SlotFrame};
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};
use crate::service::report::{Destination, FrameId, Payload, SendError, SendOutcome, SendReport};
use crate::service::upcall::Upcall;

impl Links {
    /// Takes a frame to send.
    pub(super) fn take_frame(
        &mut self,
        station: StationId,
        to: Destination,
        payload: Payload<'_>,
        scene: &mut Scene,
    ) -> Result<FrameId, SendError> {
        if matches!(self.stacks[station.index()].membership, Membership::Out) {
            return Err(SendError::ReceivesOnly);
        }
        self.ledger.can_reach(station, to)?;
        let sizes = header(self.pan, station, to);
        let mpdu_octets = offered_octets(&sizes, payload)?;
        self.ledger.offer(station, mpdu_octets, scene);
        let content = self.payloads.keep(payload);
        let stack = &mut self.stacks[station.index()];
        let id = FrameId(stack.frames);
        stack.frames = stack.frames.wrapping_add(1);
        let mut track = stack.is_traced.then(Box::<PacketTrack>::default);
        if let Some(track) = &mut track {
            track.begin(scene.now);
            track.carry(payload);
        }
        let frame = SlotFrame {
            kind: FrameKind::Data,
            id,
            to,
            content,
            mpdu_octets,
            offered: scene.now,
            sequence: stack.next_sequence(),
            transmissions: 0,
            outcome: FrameOutcome::WORST,
            track,
        };
        let peer = match to {
            Destination::Station(to) => Some(to),
            Destination::All => None,
        };
        match stack.sender.offer(peer, frame) {
            Ok(()) => {
                self.replan(station, scene);
                Ok(id)
            }
            Err(frame) => {
                self.end_packet(station, frame, PacketEnd::QueueFull, PacketFate::LostQueue, scene);
                // The frame under way is one of those that wait.
                Err(SendError::QueueFull(usize::from(self.settings.queue_frames) - 1))
            }
        }
    }

    /// A packet of a station has left its link: it is counted and traced, and its application is told.
    pub(super) fn finish_frame(
        &mut self,
        station: StationId,
        frame: SlotFrame,
        outcome: SendOutcome,
        scene: &mut Scene,
    ) {
        if frame.kind != FrameKind::Data {
            return;
        }
        let report = SendReport {
            frame: frame.id,
            to: frame.to,
            outcome,
            attempts: frame.transmissions,
            transmissions: frame.transmissions,
            offered: frame.offered,
        };
        let fate = PacketFate::Sent(frame.outcome);
        self.end_packet(station, frame, outcome.into(), fate, scene);
        scene.upcalls.push(Upcall::Sent { station, report });
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
        let (packet, transmissions, track) = (frame.packet(), frame.transmissions, frame.track.as_deref_mut());
        let power = self.stacks[station.index()].tx_power;
        let ended = EndedPacket { packet, end, fate, transmissions, assessments: 0, track };
        ended.enter(Origin { network: self.radios[0].network, station, power }, &mut self.ledger, scene);
    }

    /// The payload of a frame with this content and size.
    pub(super) fn payload_of(
        &self,
        station: StationId,
        kind: FrameKind,
        to: Destination,
        (content, mpdu_octets): (Content, u8),
    ) -> &[u8] {
        match content {
            Content::Octets(slot) => self.payloads.octets(slot),
            Content::Filler if kind == FrameKind::Data => {
                let sizes = header(self.pan, station, to);
                sizes.filler(mpdu_octets).expect("sizes of traffic were checked at the start")
            }
            Content::Filler => &[],
        }
    }
}
