//! The packets of programs: what they say that they carry, so that it is counted and traced as that of other links.

use sextant_kernel::{SimTime, StationId};

use super::Links;
use crate::air::Transmission;
use crate::link::fate::Fate;
use crate::link::programmed::packet::OpenPacket;
use crate::link::track::{DataPacket, Origin, PacketTrack, Traced, TransmissionEnd};
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
        let header = self.header(station, to);
        let mpdu_octets = Self::mpdu_octets(&header, payload_octets)?;
        let counts = u64::from(scene.now >= self.ledger.counted_from);
        self.ledger.packets[station.index()].offered += counts;
        self.ledger.octets[station.index()] += counts * u64::from(mpdu_octets);
        scene.offered += 1;
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
        let Fate { outcome, arrival } = fate;
        if outcome == FrameOutcome::Received
            && packet.outcome != FrameOutcome::Received
            && packet.offered >= self.ledger.counted_from
            && let Some(delays) = self.ledger.delays.get_mut(station.index())
        {
            delays.add(scene.now - packet.offered);
        }
        packet.outcome = packet.outcome.max(outcome);
        if let Some(track) = &mut packet.track {
            let receiver = arrival.map(|arrival| radios.receiver(arrival.station));
            track.end_transmission(
                transmission,
                TransmissionEnd { outcome, arrival, receiver, air: radios.air },
                scene,
            );
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
        self.count(station, &packet, outcome, fate);
        let end = match outcome {
            Some(SendOutcome::Sent) => PacketEnd::Sent,
            Some(SendOutcome::Acknowledged) => PacketEnd::Acknowledged,
            Some(SendOutcome::NoAcknowledgement) => PacketEnd::NoAcknowledgement,
            Some(SendOutcome::ChannelAccessFailure) => PacketEnd::ChannelAccessFailure,
            None => PacketEnd::QueueFull,
        };
        self.trace(station, packet, end, fate, scene);
        Ok(())
    }

    fn count(&mut self, station: StationId, packet: &OpenPacket, outcome: Option<SendOutcome>, fate: PacketFate) {
        if packet.offered < self.ledger.counted_from {
            return;
        }
        let overhead = self.header(station, packet.to).overhead_octets();
        let packets = &mut self.ledger.packets[station.index()];
        packets.transmissions += packet.transmissions;
        packets.assessments += packet.assessments;
        packets.unacknowledged += u64::from(outcome == Some(SendOutcome::NoAcknowledgement));
        packets.channel_access_failures += u64::from(outcome == Some(SendOutcome::ChannelAccessFailure));
        match fate {
            PacketFate::Sent(outcome) => {
                packets.count_sent(outcome);
                if outcome == FrameOutcome::Received {
                    packets.octets_received += u64::from(packet.mpdu_octets - overhead);
                }
            }
            PacketFate::LostChannelAccess => packets.lost_channel_access += 1,
            PacketFate::LostQueue => packets.lost_queue += 1,
            PacketFate::Depleted => packets.depleted += 1,
            PacketFate::Pending => packets.pending += 1,
        }
    }

    /// Counts the packets that are open at the end: one that was received counts so.
    pub(super) fn count_open(&mut self, station: StationId) {
        for packet in std::mem::take(&mut self.stacks[station.index()].open) {
            self.count(station, &packet, None, packet.fate_at_end());
        }
    }

    /// The packets of a station whose battery is empty are lost.
    pub(super) fn abandon(&mut self, station: StationId, scene: &mut Scene) {
        for packet in std::mem::take(&mut self.stacks[station.index()].open) {
            let fate = match packet.fate_at_end() {
                PacketFate::Pending => PacketFate::Depleted,
                fate => fate,
            };
            self.count(station, &packet, None, fate);
            self.trace(station, packet, PacketEnd::Depleted, fate, scene);
        }
    }

    /// Traces the packets that are open at the end.
    pub(super) fn trace_open(&mut self, station: StationId, scene: &mut Scene) {
        for place in 0..self.stacks[station.index()].open.len() {
            let packet = &mut self.stacks[station.index()].open[place];
            let (fate, track) = (packet.fate_at_end(), packet.track.take());
            let traced = self.traced(station, &self.stacks[station.index()].open[place], PacketEnd::Pending, fate);
            self.tell(station, track, &traced, scene);
        }
    }

    fn trace(&self, station: StationId, mut packet: OpenPacket, end: PacketEnd, fate: PacketFate, scene: &mut Scene) {
        let track = packet.track.take();
        let traced = self.traced(station, &packet, end, fate);
        self.tell(station, track, &traced, scene);
    }

    fn traced(&self, station: StationId, packet: &OpenPacket, end: PacketEnd, fate: PacketFate) -> Traced {
        let &OpenPacket { id, to, sequence, mpdu_octets, offered, .. } = packet;
        let origin = Origin { network: self.radios[0].network, station, counted_from: self.ledger.counted_from };
        origin.traced(DataPacket { id, sequence, to, mpdu_octets, offered }, end, fate)
    }

    fn tell(&self, station: StationId, track: Option<Box<PacketTrack>>, traced: &Traced, scene: &mut Scene) {
        if let Some(mut track) = track {
            let power = self.stacks[station.index()].power;
            scene.traced.push(track.end(traced, &self.ledger.radio_states, power, scene.now));
        }
    }
}
