//! The ends of sweeps, answers and broadcasts: they are counted, and traced if somebody wants that.

use sextant_kernel::{SimTime, StationId};
use sextant_mac::dmg::timing::SSW_OCTETS;
use sextant_mac::dmg::{SweepBody, SweepFrame, beacon_octets};

use super::Links;
use crate::air::Transmission;
use crate::link::ieee80211ad::broadcast::Broadcast;
use crate::link::ieee80211ad::tracks::Tracks;
use crate::link::ledger::CountedPacket;
use crate::link::track::{PacketTrack, Traced};
use crate::scene::Scene;
use crate::service::packet_trace::{PacketEnd, PacketFate, PacketKind};
use crate::service::report::Destination;

impl Links {
    /// Tracks a frame of `station` that ends now, if it belongs to a sweep, an answer or a broadcast.
    pub(super) fn trace_frame(
        &mut self,
        station: StationId,
        transmission: &Transmission,
        frame: &SweepFrame,
        scene: &mut Scene,
    ) {
        let Some(mut tracks) = self.stacks[station.index()].tracks.take() else { return };
        let track = match frame.body {
            SweepBody::Rss { .. } => Some(&mut tracks.answer),
            SweepBody::Iss { .. } | SweepBody::Beacon { .. } => Some(&mut tracks.task),
            SweepBody::Feedback { .. } | SweepBody::Ack { .. } | SweepBody::Brp { .. } => None,
        };
        if let Some(track) = track {
            track.end_transmission(transmission, self.fate(transmission, frame, scene), &self.radios, scene);
        }
        self.stacks[station.index()].tracks = Some(tracks);
    }

    /// Tracks an answer of `station` that is offered now.
    pub(super) fn trace_heard(&mut self, station: StationId, initiator: Option<StationId>, scene: &Scene) {
        if let Some(tracks) = &mut self.stacks[station.index()].tracks {
            tracks.answer_offered = Some((scene.now, initiator));
            tracks.answer.begin(scene.now);
        }
    }

    /// An answer of `station` is none any more, after so many sweeps: it is counted and traced.
    pub(super) fn end_answer(
        &mut self,
        station: StationId,
        end: PacketEnd,
        fate: PacketFate,
        sweeps: u64,
        scene: &mut Scene,
    ) {
        self.stacks[station.index()].is_answering = false;
        self.count(station, end, fate, sweeps, scene);
        let Some(mut tracks) = self.stacks[station.index()].tracks.take() else { return };
        if let Some((offered, initiator)) = tracks.answer_offered.take() {
            let to = initiator.map_or(Destination::All, Destination::Station);
            let traced = Traced {
                kind: PacketKind::Answer,
                number: tracks.answers,
                to,
                end,
                fate,
                ..self.traced(station, offered)
            };
            tracks.answers += 1;
            self.tell(&mut tracks.answer, &traced, scene);
        }
        self.stacks[station.index()].tracks = Some(tracks);
    }

    /// The sweep of `station` is none any more: it is counted and traced.
    pub(super) fn end_own_sweep(&mut self, station: StationId, end: PacketEnd, fate: PacketFate, scene: &mut Scene) {
        self.count(station, end, fate, u64::from(end == PacketEnd::Sent), scene);
        let Some(mut tracks) = self.stacks[station.index()].tracks.take() else { return };
        let Tracks { task, sweep_offered, sweeps, .. } = &mut *tracks;
        let traced =
            Traced { kind: PacketKind::Sweep, number: *sweeps, end, fate, ..self.traced(station, *sweep_offered) };
        *sweeps += 1;
        // A sweep that waits for the end of a broadcast has no track yet.
        match self.stacks[station.index()].next_sweep {
            Some(_) => self.tell(&mut PacketTrack::default(), &traced, scene),
            None => self.tell(task, &traced, scene),
        }
        self.stacks[station.index()].tracks = Some(tracks);
    }

    /// A broadcast of `station` is none any more: it is counted and traced. One that waited has no `sequence` on air yet.
    pub(super) fn end_payload(
        &mut self,
        station: StationId,
        broadcast: &Broadcast,
        (end, fate): (PacketEnd, PacketFate),
        sequence: Option<u8>,
        scene: &mut Scene,
    ) {
        let &Broadcast { content, payload_octets, offered, frames, .. } = broadcast;
        self.payloads.release(content);
        let (payload_octets, transmissions) = (payload_octets.into(), u64::from(frames > 0));
        let counted = CountedPacket { offered, payload_octets, end, fate, transmissions, assessments: 0 };
        self.ledger.count(station, &counted);
        let Some(mut tracks) = self.stacks[station.index()].tracks.take() else { return };
        let traced = Traced {
            kind: PacketKind::Broadcast,
            number: broadcast.id.0,
            octets: beacon_octets(broadcast.payload_octets),
            sequence,
            end,
            fate,
            ..self.traced(station, offered)
        };
        match sequence {
            Some(_) => self.tell(&mut tracks.task, &traced, scene),
            None => self.tell(&mut PacketTrack::default(), &traced, scene),
        }
        self.stacks[station.index()].tracks = Some(tracks);
    }

    /// Counts a sweep or an answer, which carry nothing.
    fn count(&mut self, station: StationId, end: PacketEnd, fate: PacketFate, transmissions: u64, scene: &Scene) {
        let (offered, payload_octets) = (scene.now, 0);
        let counted = CountedPacket { offered, payload_octets, end, fate, transmissions, assessments: 0 };
        self.ledger.count(station, &counted);
    }

    /// What is known of a packet when it is offered.
    fn traced(&self, source: StationId, offered: SimTime) -> Traced {
        Traced {
            network: self.radios.network,
            source,
            kind: PacketKind::Sweep,
            number: 0,
            sequence: None,
            to: Destination::All,
            octets: SSW_OCTETS,
            offered,
            counts: true,
            end: PacketEnd::Pending,
            fate: PacketFate::Pending,
        }
    }

    fn tell(&self, track: &mut PacketTrack, traced: &Traced, scene: &mut Scene) {
        scene.traced.push(track.end(traced, &self.ledger.radio_states, self.radios.power(), scene.now));
    }
}
