//! The packets of programs: what they say that they carry, so that it is counted and traced as that of other links.

use sextant_kernel::{SimTime, StationId};

use super::Links;
use crate::air::Transmission;
use crate::link::fate::Fate;
use crate::link::ieee802154::{DataPacket, EndedPacket, Origin, header};
use crate::link::programmed::packet::OpenPacket;
use crate::link::track::PacketTrack;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};
use crate::service::radio_error::RadioError;
use crate::service::report::{Destination, FrameId, SendOutcome};

impl Links {
    /// Takes a packet of a station: it counts as offered.
    pub(crate) fn open_packet(
        &mut self,
        station: StationId,
        to: Destination,
        payload_octets: usize,
        scene: &mut Scene,
    ) -> Result<FrameId, RadioError> {
        self.check_destination(station, to)?;
        let header = header(self.pan, station, to);
        let mpdu_octets = Self::mpdu_octets(&header, payload_octets)?;
        self.ledger.offer(station, mpdu_octets, scene);
        let stack = &mut self.stacks[station.index()];
        let id = FrameId(stack.packets);
        stack.packets = stack.packets.wrapping_add(1);
        stack.sequence = stack.sequence.wrapping_add(1);
        let mut track = stack.is_traced.then(Box::<PacketTrack>::default);
        if let Some(track) = track.as_mut().filter(|_| stack.open.is_empty()) {
            track.begin(scene.now);
        }
        stack.open.push(OpenPacket {
            id,
            to,
            sequence: stack.sequence,
            mpdu_octets,
            offered: scene.now,
            transmissions: 0,
            assessments: 0,
            outcome: FrameOutcome::WORST,
            delivered: Vec::new(),
            track,
        });
        Ok(id)
    }

    /// A look at the channel begins, for the oldest packet.
    pub(in crate::link::programmed) fn note_assessment(&mut self, station: StationId, now: SimTime) {
        if let Some(packet) = self.stacks[station.index()].open.first_mut() {
            packet.assessments += 1;
            if let Some(track) = &mut packet.track {
                track.begin_assessment(now);
            }
        }
    }

    /// It has found the channel `busy`.
    pub(super) fn end_assessment(&mut self, station: StationId, busy: bool) {
        let packet = self.stacks[station.index()].open.first_mut();
        if let Some(track) = packet.and_then(|packet| packet.track.as_mut()) {
            track.end_assessment(busy);
        }
    }

    /// A transmission of a packet ends.
    pub(super) fn end_transmission(
        &mut self,
        station: StationId,
        id: FrameId,
        transmission: &Transmission,
        fate: Fate,
        scene: &mut Scene,
    ) {
        let stack = &mut self.stacks[station.index()];
        let radios = &self.radios[stack.channel];
        let Some(packet) = stack.open.iter_mut().find(|packet| packet.id == id) else { return };
        packet.transmissions += 1;
        if fate.outcome == FrameOutcome::Received && packet.outcome != FrameOutcome::Received {
            self.ledger.note_reception(station, packet.offered, scene.now);
        }
        packet.outcome = packet.outcome.max(fate.outcome);
        if let Some(track) = &mut packet.track {
            track.end_transmission(transmission, fate, radios, scene);
        }
    }

    /// The acknowledgement of a transmission of a packet was received.
    pub(super) fn note_acknowledgement(&mut self, station: StationId, id: FrameId, now: SimTime) {
        let mut open = self.stacks[station.index()].open.iter_mut();
        if let Some(track) = open.find(|packet| packet.id == id).and_then(|packet| packet.track.as_mut()) {
            track.acknowledge(now);
        }
    }

    /// A frame that carries a packet of `from` was received at `station`: it counts as delivered once.
    pub(super) fn note_delivery(&mut self, from: StationId, id: FrameId, station: StationId) {
        let mut open = self.stacks[from.index()].open.iter_mut();
        let Some(packet) = open.find(|packet| packet.id == id) else { return };
        if !packet.delivered.contains(&station) {
            packet.delivered.push(station);
            self.ledger.deliveries[station.index()] += u64::from(packet.offered >= self.ledger.counted_from);
        }
    }

    /// A packet is done: `None` if there was no room for it.
    pub(crate) fn close_packet(
        &mut self,
        station: StationId,
        id: FrameId,
        outcome: Option<SendOutcome>,
        scene: &mut Scene,
    ) -> Result<(), RadioError> {
        let stack = &mut self.stacks[station.index()];
        let place = stack.open.iter().position(|packet| packet.id == id).ok_or(RadioError::NoSuchPacket(id))?;
        let packet = stack.open.remove(place);
        if place == 0
            && let Some(track) = stack.open.first_mut().and_then(|packet| packet.track.as_mut())
        {
            track.begin(scene.now);
        }
        let fate = match outcome {
            _ if packet.transmissions > 0 => PacketFate::Sent(packet.outcome),
            Some(SendOutcome::ChannelAccessFailure) => PacketFate::LostChannelAccess,
            _ => PacketFate::LostQueue,
        };
        let end = outcome.map_or(PacketEnd::QueueFull, PacketEnd::from);
        self.end_packet(station, packet, end, fate, scene);
        Ok(())
    }

    /// A packet of a station is none any more: it is counted and traced.
    pub(super) fn end_packet(
        &mut self,
        station: StationId,
        packet: OpenPacket,
        end: PacketEnd,
        fate: PacketFate,
        scene: &mut Scene,
    ) {
        let OpenPacket { id, to, sequence, mpdu_octets, offered, transmissions, assessments, mut track, .. } = packet;
        let packet = DataPacket { id, sequence: Some(sequence), to, mpdu_octets, offered };
        let ended = EndedPacket { packet, end, fate, transmissions, assessments, track: track.as_deref_mut() };
        let power = self.stacks[station.index()].power;
        ended.enter(Origin { network: self.radios[0].network, station, power }, &mut self.ledger, scene);
    }
}
