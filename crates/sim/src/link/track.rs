//! The track of a packet under way, from which its trace is made.

use std::time::Duration;

use sextant_channel::{Db, Dbm};
use sextant_kernel::{SimTime, StationId};
use sextant_mac::{MessageEnergy, RadioStates};

use super::fate::Fate;
use super::radios::Radios;
use crate::air::Transmission;
use crate::scene::Scene;
use crate::service::network_id::NetworkId;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{
    AssessmentTrace, PacketEnd, PacketFate, PacketKind, PacketTrace, TransmissionTrace,
};
use crate::service::report::{Destination, Payload};

/// The track of the packet that a station has under way. It exists only if packets are traced.
#[derive(Debug, Default)]
pub(super) struct PacketTrack {
    begun: Option<SimTime>,
    /// Start of the backoff under way.
    backoff: Option<SimTime>,
    assessments: Vec<AssessmentTrace>,
    transmissions: Vec<TransmissionTrace>,
    delivered: Option<SimTime>,
    /// What it carries, as far as it says something.
    payload: Vec<u8>,
}

/// What a trace says of a packet besides its track.
#[derive(Clone, Copy, Debug)]
pub(super) struct Traced {
    pub(super) network: NetworkId,
    pub(super) source: StationId,
    pub(super) kind: PacketKind,
    pub(super) number: u32,
    pub(super) sequence: Option<u8>,
    pub(super) to: Destination,
    pub(super) octets: u16,
    pub(super) offered: SimTime,
    pub(super) counts: bool,
    pub(super) end: PacketEnd,
    pub(super) fate: PacketFate,
}

impl PacketTrack {
    /// The packet is first in its queue now.
    pub(super) fn begin(&mut self, now: SimTime) {
        self.begun = Some(now);
    }

    /// The packet carries this.
    pub(super) fn carry(&mut self, payload: Payload<'_>) {
        match payload {
            Payload::Octets(octets) => self.payload = octets.to_vec(),
            Payload::Filler(_) => self.payload.clear(),
        }
    }

    /// A backoff begins now.
    pub(super) fn begin_backoff(&mut self, now: SimTime) {
        self.backoff.get_or_insert(now);
    }

    /// An assessment of the channel begins now.
    pub(super) fn begin_assessment(&mut self, now: SimTime) {
        let backoff = self.backoff.take().unwrap_or(now);
        self.assessments.push(AssessmentTrace { backoff, start: now, busy: false });
    }

    /// The assessment under way has found the channel `busy`.
    pub(super) fn end_assessment(&mut self, busy: bool) {
        if let Some(assessment) = self.assessments.last_mut() {
            assessment.busy = busy;
        }
    }

    /// The only frame of an attempt, or its first copy, ends now, in the band of `radios`.
    pub(super) fn end_transmission<R>(
        &mut self,
        transmission: &Transmission,
        fate: Fate,
        radios: &Radios<R>,
        scene: &mut Scene,
    ) {
        let attempt = self.transmissions.last().map_or(0, |last| last.attempt + 1);
        self.end_frame(attempt, transmission, fate, radios, scene);
    }

    /// A further copy in the attempt under way ends now.
    pub(super) fn end_copy<R>(
        &mut self,
        transmission: &Transmission,
        fate: Fate,
        radios: &Radios<R>,
        scene: &mut Scene,
    ) {
        let attempt = self.transmissions.last().map_or(0, |last| last.attempt);
        self.end_frame(attempt, transmission, fate, radios, scene);
    }

    fn end_frame<R>(
        &mut self,
        attempt: u32,
        transmission: &Transmission,
        fate: Fate,
        radios: &Radios<R>,
        scene: &mut Scene,
    ) {
        let Fate { outcome, arrival } = fate;
        let collided_with = match (outcome, arrival.map(|arrival| arrival.station)) {
            (FrameOutcome::Collided, Some(station)) => {
                let (receiver, place) = (radios.receiver(station), scene.place(station));
                scene.airs[radios.air].strongest_interferer(transmission, receiver, station, place)
            }
            _ => None,
        };
        if outcome == FrameOutcome::Received {
            self.delivered.get_or_insert(scene.now);
        }
        self.transmissions.push(TransmissionTrace {
            attempt,
            start: transmission.start(),
            airtime: scene.now - transmission.start(),
            outcome,
            receiver: arrival.map(|arrival| arrival.station),
            power: arrival.map(|arrival| arrival.power.to_dbm()),
            sinr: arrival.map(|arrival| Db(10.0 * libm::log10(arrival.sinr))),
            collided_with,
            acknowledged: None,
        });
    }

    /// The acknowledgement of the last transmission ends now, and was received.
    pub(super) fn acknowledge(&mut self, now: SimTime) {
        if let Some(transmission) = self.transmissions.last_mut() {
            transmission.acknowledged = Some(now);
        }
    }

    /// The trace of the packet, whose link has ended its work now. The track is that of the next packet then.
    pub(super) fn end(&mut self, traced: &Traced, states: &RadioStates, power: Dbm, now: SimTime) -> PacketTrace {
        let Self { begun, backoff: _, assessments, transmissions, delivered, payload } = std::mem::take(self);
        let airtime: Duration = transmissions.iter().map(|transmission| transmission.airtime).sum();
        let &Traced { network, source, kind, number, sequence, to, octets, offered, counts, end, fate } = traced;
        let tx_energy_j = MessageEnergy::of_airtime(states, power, airtime).tx_j;
        PacketTrace {
            network,
            source,
            kind,
            number,
            sequence,
            to,
            octets,
            offered,
            counts,
            begun,
            assessments,
            transmissions,
            delivered,
            tx_energy_j,
            end,
            ended: now,
            fate,
            payload,
        }
    }
}
