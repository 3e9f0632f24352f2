//! Frames are offered, and what becomes of them is counted.

use sextant_kernel::StationId;

use super::Links;
use crate::link::ieee802154::{EndedPacket, Origin, header, offered_octets};
use crate::link::sleeping::stack::OpenFrame;
use crate::link::track::PacketTrack;
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
        if !self.stacks[station.index()].is_there {
            return Err(SendError::ReceivesOnly);
        }
        self.ledger.can_reach(station, to)?;
        let mpdu_octets = offered_octets(&header(self.pan, station, to), payload)?;
        let allowed = self.settings.least_mpdu_octets();
        if mpdu_octets < allowed {
            return Err(SendError::Undersized { found: mpdu_octets.into(), allowed: allowed.into() });
        }
        self.ledger.offer(station, mpdu_octets, scene);
        let content = self.payloads.keep(payload);
        let most = usize::from(self.settings.queue_frames);
        let stack = &mut self.stacks[station.index()];
        let id = FrameId(stack.frames);
        stack.frames = stack.frames.wrapping_add(1);
        let mut track = stack.is_traced.then(Box::<PacketTrack>::default);
        if let Some(track) = &mut track {
            track.begin(scene.now);
            track.carry(payload);
        }
        let frame = OpenFrame {
            id,
            to,
            content,
            mpdu_octets,
            offered: scene.now,
            sequence: stack.next_sequence(),
            attempts: 0,
            sent_in: None,
            transmissions: 0,
            busy: 0,
            looks: 0,
            outcome: FrameOutcome::WORST,
            delivered: Vec::new(),
            track,
        };
        if stack.waiting.len() >= most {
            self.end_packet(station, frame, PacketEnd::QueueFull, PacketFate::LostQueue, scene);
            return Err(SendError::QueueFull(most - 1));
        }
        stack.waiting.push_back(frame);
        self.go_on(station, scene);
        Ok(id)
    }

    /// The packet under way has left the link of a station: it is counted and traced, and its application is told.
    pub(super) fn finish_frame(&mut self, station: StationId, outcome: SendOutcome, scene: &mut Scene) {
        let frame = self.stacks[station.index()].waiting.pop_front().expect("a packet was under way");
        let OpenFrame { id, to, offered, attempts, transmissions, .. } = frame;
        let fate = if attempts == 0 { PacketFate::LostChannelAccess } else { PacketFate::Sent(frame.outcome) };
        self.end_packet(station, frame, outcome.into(), fate, scene);
        let report = SendReport { frame: id, to, outcome, attempts, transmissions, offered };
        scene.upcalls.push(Upcall::Sent { station, report });
    }
    /// A packet of a station is none any more: it is counted and traced.
    pub(super) fn end_packet(
        &mut self,
        station: StationId,
        mut frame: OpenFrame,
        end: PacketEnd,
        fate: PacketFate,
        scene: &mut Scene,
    ) {
        self.payloads.release(frame.content);
        if frame.attempts > 0 && frame.transmissions == 0 {
            self.stacks[station.index()].usage.unanswered += 1;
        }
        let (packet, track) = (frame.packet(), frame.track.as_deref_mut());
        let (transmissions, assessments) = (frame.transmissions, frame.looks);
        let power = self.stacks[station.index()].tx_power;
        let ended = EndedPacket { packet, end, fate, transmissions, assessments, track };
        ended.enter(Origin { network: self.radios.network, station, power }, &mut self.ledger, scene);
    }
}
