//! Broadcasts: payloads are offered, wait, are sent from each sector of their station, and are delivered.

use sextant_channel::Db;
use sextant_kernel::{SimTime, StationId};
use sextant_mac::dmg::{MAX_BEACON_PAYLOAD_OCTETS, TxSector, beacon_octets, beacon_payload_octets};

use super::Links;
use crate::link::ieee80211ad::broadcast::Broadcast;
use crate::link::ieee80211ad::stack::RadioTask;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};
use crate::service::report::{Destination, FrameId, Payload, SendError, SendOutcome, SendReport};
use crate::service::upcall::Upcall;

/// Broadcasts of a station that wait beside the one under way.
const QUEUE_FRAMES: usize = 64;

impl Links {
    /// Takes a payload to send to all.
    pub(super) fn take_frame(
        &mut self,
        station: StationId,
        to: Destination,
        payload: Payload<'_>,
        scene: &mut Scene,
    ) -> Result<FrameId, SendError> {
        if !self.ledger.has(station) {
            return Err(SendError::ReceivesOnly);
        }
        if let Destination::Station(to) = to {
            return Err(SendError::BroadcastsOnly(to));
        }
        let payload_octets = payload_octets(payload)?;
        scene.offered += 1;
        self.ledger.packets[station.index()].offered += 1;
        let stack = &mut self.stacks[station.index()];
        let id = FrameId(stack.broadcasts);
        stack.broadcasts = stack.broadcasts.wrapping_add(1);
        let (content, offered, outcome) = (self.payloads.keep(payload), scene.now, FrameOutcome::WORST);
        let broadcast = Broadcast { id, content, payload_octets, offered, frames: 0, outcome };
        if stack.waiting.len() >= QUEUE_FRAMES {
            self.end_payload(station, &broadcast, (PacketEnd::QueueFull, PacketFate::LostQueue), None, scene);
            return Err(SendError::QueueFull(QUEUE_FRAMES));
        }
        stack.waiting.push_back(broadcast);
        self.has_broadcasts = true;
        self.proceed(station, scene);
        self.tell_carrier(scene);
        Ok(id)
    }

    /// A broadcast was sent from all sectors: counts it, and tells the application.
    pub(super) fn end_broadcast(&mut self, station: StationId, broadcast: Broadcast, scene: &mut Scene) {
        let Broadcast { id, offered, frames, outcome, .. } = broadcast;
        let fate = PacketFate::Sent(outcome);
        self.end_payload(station, &broadcast, (PacketEnd::Sent, fate), Some(broadcast.sequence()), scene);
        self.stacks[station.index()].reached.clear();
        let (to, outcome) = (Destination::All, SendOutcome::Sent);
        let report = SendReport { frame: id, to, outcome, attempts: frames, transmissions: frames, offered };
        scene.upcalls.push(Upcall::Sent { station, report });
    }

    /// A frame of the broadcast of `station` has ended with this outcome.
    pub(super) fn note_beacon(&mut self, station: StationId, outcome: FrameOutcome, now: SimTime) {
        let Some(RadioTask::Broadcast(broadcast)) = &mut self.stacks[station.index()].task else {
            unreachable!("beacons belong to broadcasts")
        };
        broadcast.frames += 1;
        if outcome == FrameOutcome::Received && broadcast.outcome != outcome {
            self.ledger.note_reception(station, broadcast.offered, now);
        }
        broadcast.outcome = broadcast.outcome.max(outcome);
    }

    /// Keeps the payload of the broadcast of `station`, whose frame ends now, for those that have received it.
    pub(super) fn keep_payload(&mut self, station: StationId) {
        if let Some(RadioTask::Broadcast(broadcast)) = &self.stacks[station.index()].task {
            self.frame.keep_payload(broadcast.payload(&self.payloads));
        }
    }

    /// Delivers the frame that `sender` has sent from `sector`, and of which arrival number `i` is, to its station.
    pub(super) fn deliver(
        &mut self,
        i: usize,
        sender: StationId,
        sector: TxSector,
        sequence: u8,
        snr: Db,
        scene: &mut Scene,
    ) {
        let arrival = self.arrivals[i];
        let station = arrival.station;
        let sector = self.identity(sender, sector);
        let reached = &mut self.stacks[sender.index()].reached;
        if let Err(at) = reached.binary_search(&station) {
            reached.insert(at, station);
            self.ledger.deliveries[station.index()] += 1;
        }
        let (power, snr) = (arrival.power, Some(snr));
        scene.upcalls.push(Upcall::Delivered { station, from: sender, sequence, power, sector, snr });
    }
}

/// The size of a payload, if a beacon can carry it (octets).
fn payload_octets(payload: Payload<'_>) -> Result<u16, SendError> {
    match payload {
        Payload::Filler(octets) => beacon_payload_octets(octets.into())
            .ok_or(SendError::Undersized { found: octets.into(), allowed: beacon_octets(0).into() }),
        Payload::Octets(octets) => match u16::try_from(octets.len()) {
            Ok(found) if found <= MAX_BEACON_PAYLOAD_OCTETS => Ok(found),
            _ => Err(SendError::Oversized { found: octets.len(), allowed: MAX_BEACON_PAYLOAD_OCTETS.into() }),
        },
    }
}
