//! Traces of sweeps, answers and broadcasts, if somebody wants them.

use sextant_kernel::{SimTime, StationId};
use sextant_mac::dmg::timing::SSW_OCTETS;
use sextant_mac::dmg::{ResponderOutcome, SweepBody, SweepFrame, beacon_octets};

use super::Links;
use crate::air::Transmission;
use crate::link::ieee80211ad::broadcast::Broadcast;
use crate::link::ieee80211ad::stack::RadioTask;
use crate::link::ieee80211ad::tracks::Tracks;
use crate::link::track::{PacketTrack, Traced, TransmissionEnd};
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate, PacketKind};
use crate::service::report::{Destination, FrameId};

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
            let outcome = self.outcome(transmission, frame, scene);
            let is_best = |found, station| found == outcome && self.is_for(frame, station);
            let arrival = self.arrivals.iter().find(|arrival| is_best(arrival.outcome, arrival.station)).copied();
            let receiver = arrival.map(|arrival| self.radios.receiver(arrival.station));
            let end = TransmissionEnd { outcome, arrival, receiver, air: self.radios.air };
            track.end_transmission(transmission, end, scene);
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

    /// Traces an answer of `station` that has ended, with the `best` outcome of its frames, if there were any.
    pub(super) fn trace_answer(
        &mut self,
        station: StationId,
        outcome: ResponderOutcome,
        best: Option<FrameOutcome>,
        scene: &mut Scene,
    ) {
        let end = match outcome {
            ResponderOutcome::Sent => PacketEnd::Sent,
            ResponderOutcome::Trained(_) => PacketEnd::Acknowledged,
            ResponderOutcome::WindowOver => PacketEnd::ChannelAccessFailure,
            ResponderOutcome::NoFeedback => PacketEnd::NoAcknowledgement,
        };
        let fate = best.map_or(PacketFate::LostChannelAccess, PacketFate::Sent);
        self.end_answer(station, end, fate, scene);
    }

    fn end_answer(&mut self, station: StationId, end: PacketEnd, fate: PacketFate, scene: &mut Scene) {
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

    /// Traces the sweep of `station`, which has ended.
    pub(super) fn trace_sweep(&mut self, station: StationId, scene: &mut Scene) {
        self.end_sweep_track(station, PacketEnd::Sent, PacketFate::Sent(FrameOutcome::Received), scene);
    }

    fn end_sweep_track(&mut self, station: StationId, end: PacketEnd, fate: PacketFate, scene: &mut Scene) {
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

    /// Traces a broadcast for which the queue of `station` had no room.
    pub(super) fn trace_refused(
        &mut self,
        station: StationId,
        FrameId(number): FrameId,
        payload_octets: u16,
        scene: &mut Scene,
    ) {
        if self.stacks[station.index()].tracks.is_none() {
            return;
        }
        let traced = Traced {
            kind: PacketKind::Broadcast,
            number,
            octets: beacon_octets(payload_octets),
            end: PacketEnd::QueueFull,
            fate: PacketFate::LostQueue,
            ..self.traced(station, scene.now)
        };
        self.tell(&mut PacketTrack::default(), &traced, scene);
    }

    /// Traces a broadcast of `station` that was sent from all its sectors.
    pub(super) fn trace_broadcast(&mut self, station: StationId, broadcast: &Broadcast, scene: &mut Scene) {
        let Some(mut tracks) = self.stacks[station.index()].tracks.take() else { return };
        let fate = PacketFate::Sent(broadcast.outcome);
        let traced = Traced { end: PacketEnd::Sent, fate, ..self.traced_broadcast(station, broadcast) };
        let sequence = Some(broadcast.sequence());
        self.tell(&mut tracks.task, &Traced { sequence, ..traced }, scene);
        self.stacks[station.index()].tracks = Some(tracks);
    }

    /// Traces what is under way or waits at the end of the simulation.
    pub(super) fn trace_all_pending(&mut self, scene: &mut Scene) {
        for i in 0..self.stacks.len() {
            if self.stacks[i].tracks.is_none() {
                continue;
            }
            let station = StationId::from_index(i);
            if let Some(RadioTask::Broadcast(broadcast)) = self.stacks[i].task {
                let sequence = Some(broadcast.sequence());
                let traced = Traced { sequence, ..self.traced_broadcast(station, &broadcast) };
                let mut track = self.stacks[i].tracks.as_mut().map(|tracks| std::mem::take(&mut tracks.task));
                self.tell(track.get_or_insert_default(), &traced, scene);
            }
            let is_sweeping = matches!(self.stacks[i].task, Some(RadioTask::Sweep(_)));
            if is_sweeping || self.stacks[i].next_sweep.is_some() {
                self.end_sweep_track(station, PacketEnd::Pending, PacketFate::Pending, scene);
            }
            for place in 0..self.stacks[i].waiting.len() {
                let traced = self.traced_broadcast(station, &self.stacks[i].waiting[place]);
                self.tell(&mut PacketTrack::default(), &traced, scene);
            }
            self.end_answer(station, PacketEnd::Pending, PacketFate::Pending, scene);
        }
    }

    fn traced_broadcast(&self, station: StationId, broadcast: &Broadcast) -> Traced {
        Traced {
            kind: PacketKind::Broadcast,
            number: broadcast.id.0,
            octets: beacon_octets(broadcast.payload_octets),
            ..self.traced(station, broadcast.offered)
        }
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
