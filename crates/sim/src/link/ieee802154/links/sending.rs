//! Sending: frames are offered, contend, end, and are counted.

use sextant_kernel::StationId;
use sextant_mac::csma::{self, Outcome};
use sextant_mac::frame::DataFrame;

use super::Links;
use crate::event::ieee802154::Event;
use crate::link::ieee802154::addressing::{header, offered_octets};
use crate::link::ieee802154::data_packet::{DataPacket, EndedPacket, Origin};
use crate::link::ieee802154::frame_queue::QueuedFrame;
use crate::link::ieee802154::transceiver::Transceiver;
use crate::link::payloads::Content;
use crate::link::track::PacketTrack;
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};
use crate::service::report::{Destination, FrameId, Payload, SendError, SendOutcome, SendReport};
use crate::service::upcall::Upcall;

/// How a frame ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ended {
    pub(super) end: PacketEnd,
    pub(super) fate: PacketFate,
    pub(super) transmissions: u32,
    pub(super) assessments: u32,
}

impl Links {
    /// Takes a frame to send.
    pub(super) fn take_frame(
        &mut self,
        station: StationId,
        to: Destination,
        payload: Payload<'_>,
        scene: &mut Scene,
    ) -> Result<FrameId, SendError> {
        if !self.ledger.has(station) || !self.macs[station.index()].is_transmitter() {
            return Err(SendError::ReceivesOnly);
        }
        self.ledger.can_reach(station, to)?;
        let header = self.data_frame(station, to);
        let mpdu_octets = offered_octets(&header, payload)?;
        let counts = self.ledger.offer(station, mpdu_octets, scene);
        let stack = &mut self.stacks[station.index()];
        let id = FrameId(stack.frames);
        stack.frames = stack.frames.wrapping_add(1);
        let is_busy = self.macs[station.index()].is_busy();
        if is_busy && stack.waiting.len() >= self.queue_frames {
            self.ledger.packets[station.index()].lost_queue += counts;
            let packet = DataPacket { id, sequence: None, to, mpdu_octets, offered: scene.now };
            self.trace_refused(station, packet, payload, scene);
            return Err(SendError::QueueFull(self.queue_frames));
        }
        let content = self.payloads.keep(payload);
        let frame = QueuedFrame { id, to, content, mpdu_octets, offered: scene.now };
        if is_busy {
            stack.waiting.push_back(frame);
        } else {
            self.start(station, frame, scene);
        }
        Ok(id)
    }

    /// The frame contends for the channel.
    fn start(&mut self, station: StationId, frame: QueuedFrame, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        stack.sequence = stack.sequence.wrapping_add(1);
        (stack.outcome, stack.transmissions) = (FrameOutcome::WORST, 0);
        stack.clock.forget_rounding();
        stack.frame = Some(frame);
        if let Some(track) = &mut stack.track {
            track.begin(scene.now);
        }
        let outgoing = csma::OutgoingFrame {
            mpdu_octets: frame.mpdu_octets,
            ack_request: frame.to != Destination::All,
            sequence: stack.sequence,
        };
        self.catch_up_now(station, scene);
        let now = scene.now;
        let stack = &mut self.stacks[station.index()];
        let mut radio = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack: false };
        self.macs[station.index()].start(now, outgoing, &mut radio);
        self.look_ahead(station, scene);
    }

    /// Handles an event of channel access.
    pub(super) fn handle_csma(
        &mut self,
        station: StationId,
        event: csma::Event,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        if !matches!(event, csma::Event::CcaEnded { .. }) {
            self.take_steps(station, Event::Csma(event), scene);
        }
        if event == csma::Event::TransmissionEnded {
            self.end_frame(station, scene, observer);
        }
        let now = scene.now;
        let stack = &mut self.stacks[station.index()];
        let awaits_ack = event == csma::Event::ReceiveReady;
        let mut radio = Transceiver { radios: &self.radios, stack, scene, station, awaits_ack };
        let report = self.macs[station.index()].handle(now, event, &mut radio);
        self.look_ahead(station, scene);
        if let Some(report) = report {
            self.end_access(station, report, scene);
        }
    }

    /// A frame of `station` has left its MAC: counts it, tells the application, and starts the next one.
    pub(super) fn end_access(&mut self, station: StationId, report: csma::Report, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let frame = stack.frame.take().expect("a report is of the frame under way");
        let next = stack.waiting.pop_front();
        let outcome = match report.outcome {
            Outcome::Sent => SendOutcome::Sent,
            Outcome::Acknowledged => SendOutcome::Acknowledged,
            Outcome::NoAck => SendOutcome::NoAcknowledgement,
            Outcome::ChannelAccessFailure => SendOutcome::ChannelAccessFailure,
        };
        if outcome == SendOutcome::Acknowledged
            && let Some(track) = &mut stack.track
        {
            track.acknowledge(scene.now);
        }
        let fate = match report.transmissions {
            0 => PacketFate::LostChannelAccess,
            _ => PacketFate::Sent(stack.outcome),
        };
        let (transmissions, assessments) = (report.transmissions, report.ccas);
        let (ended, sequence) = (Ended { end: outcome.into(), fate, transmissions, assessments }, stack.sequence);
        self.end_packet(station, &frame, ended, Some(sequence), scene);
        let (attempts, offered) = (transmissions, frame.offered);
        let report = SendReport { frame: frame.id, to: frame.to, outcome, attempts, transmissions, offered };
        scene.upcalls.push(Upcall::Sent { station, report });
        if let Some(next) = next {
            self.start(station, next, scene);
        }
    }

    /// A frame of `station` is none any more: it is counted and traced.
    pub(super) fn end_packet(
        &mut self,
        station: StationId,
        frame: &QueuedFrame,
        ended: Ended,
        sequence: Option<u8>,
        scene: &mut Scene,
    ) {
        let Ended { end, fate, transmissions, assessments } = ended;
        let (packet, origin) = (frame.packet(sequence), self.origin(station));
        let mut track = self.stacks[station.index()].track.as_deref_mut();
        if let (Some(track), Content::Octets(slot)) = (&mut track, frame.content) {
            track.carry(Payload::Octets(self.payloads.octets(slot)));
        }
        let ended = EndedPacket { packet, end, fate, transmissions, assessments, track };
        ended.enter(origin, &mut self.ledger, scene);
        self.payloads.release(frame.content);
    }

    /// Traces a frame for which the queue of `station` had no room.
    fn trace_refused(&self, station: StationId, packet: DataPacket, payload: Payload<'_>, scene: &mut Scene) {
        if self.stacks[station.index()].track.is_some() {
            let mut track = PacketTrack::default();
            track.carry(payload);
            let ended = (PacketEnd::QueueFull, PacketFate::LostQueue);
            self.origin(station).trace(packet, ended, &mut track, &self.ledger, scene);
        }
    }

    fn origin(&self, station: StationId) -> Origin {
        Origin { network: self.radios.network, station, power: self.stacks[station.index()].tx_power }
    }

    /// The header of the data frames of `station` to others of its PAN.
    pub(super) fn data_frame(&self, station: StationId, to: Destination) -> DataFrame {
        header(self.pan, station, to)
    }

    /// Writes the data frame of `station` that is under way, or only its payload if nobody looks at more.
    pub(super) fn write_frame(&mut self, station: StationId, is_whole: bool) {
        let stack = &self.stacks[station.index()];
        let frame = stack.frame.expect("a frame is under way");
        let header = self.data_frame(station, frame.to);
        let payload = match frame.content {
            Content::Filler => header.filler(frame.mpdu_octets).expect("sizes of traffic were checked at the start"),
            Content::Octets(slot) => self.payloads.octets(slot),
        };
        if is_whole {
            header.write(stack.sequence, payload, &mut self.frame.octets);
            let end = self.frame.octets.len() - 2;
            self.frame.payload = end - payload.len()..end;
        } else {
            self.frame.keep_payload(payload);
        }
    }
}
