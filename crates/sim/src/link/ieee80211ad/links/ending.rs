//! The end of a frame: who has received it, and what became of the answer that it belongs to.

use sextant_channel::Db;
use sextant_kernel::StationId;
use sextant_mac::dmg::{Enclosed, ResponderOutcome, ResponderReport, SweepBody, SweepFrame};

use super::Links;
use crate::air::{Arrival, Transmission};
use crate::link::fate::Fate;
use crate::link::frame_buffer::FrameEnd;
use crate::link::ieee80211ad::stack::{RadioTask, Role, Stack};
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::packet_trace::{PacketEnd, PacketFate};
use crate::service::sweep::Announcement;
use crate::service::upcall::Upcall;

impl Links {
    /// A frame ends: finds its outcome, and passes it to the machines that have received it.
    pub(super) fn end_frame(&mut self, station: StationId, scene: &mut Scene, observer: &mut impl Observer) {
        let (transmission, frame) =
            self.stacks[station.index()].radio.on_air.take().expect("only a frame on air ends");
        scene.airs[self.radios.air].end(scene.now, &transmission, &mut self.arrivals);
        match frame.body {
            SweepBody::Rss { .. } => {
                let outcome = self.outcome(&transmission, &frame, scene);
                let stack = &mut self.stacks[station.index()];
                stack.outcome = stack.outcome.max(outcome);
                stack.has_answered = true;
            }
            SweepBody::Beacon { .. } => {
                self.note_beacon(station, self.outcome(&transmission, &frame, scene), scene.now);
            }
            SweepBody::Iss { .. } | SweepBody::Feedback { .. } | SweepBody::Ack { .. } | SweepBody::Brp { .. } => {}
        }
        self.trace_frame(station, &transmission, &frame, scene);
        if observer.wants_frames() {
            self.tell_frame(&transmission, &frame, scene, observer);
        }
        if matches!(frame.body, SweepBody::Beacon { .. }) {
            self.keep_payload(station);
        }
        for i in 0..self.arrivals.len() {
            if self.arrivals[i].outcome == FrameOutcome::Received && self.ledger.has(self.arrivals[i].station) {
                self.receive(i, station, &frame, scene);
            }
        }
    }

    /// The station of arrival number `i` has received a frame of `sender`.
    fn receive(&mut self, i: usize, sender: StationId, frame: &SweepFrame, scene: &mut Scene) {
        let arrival = self.arrivals[i];
        let (now, station) = (scene.now, arrival.station);
        let is_for_another = frame.to.station().is_some_and(|to| to != station);
        // Whoever gathers keeps the power of each frame of a station that may answer.
        if is_for_another && !self.sweeps.contains_key(&station) {
            self.overhear(station, frame, scene);
            return;
        }
        let sinr = Db(10.0 * libm::log10(arrival.sinr));
        match frame.body {
            SweepBody::Rss { .. } => {
                if let Some(gathered) = self.sweeps.get_mut(&station) {
                    let power = gathered.powers.entry(sender).or_insert(arrival.power);
                    power.0 = power.0.max(arrival.power.0);
                }
            }
            SweepBody::Iss { sector, rx_antennas: 0, .. } if self.hears[station.index()] => {
                let sector = self.identity(sender, sector);
                let (network, rssi) = (self.radios.network, arrival.power.to_dbm());
                let announcement = Announcement { network, from: sender, sector, snr: sinr, rssi };
                scene.upcalls.push(Upcall::Announced { station, announcement });
            }
            SweepBody::Beacon { sector, sequence, .. } if self.hears[station.index()] => {
                self.deliver(i, sender, sector, sequence, sinr, scene);
            }
            SweepBody::Brp { .. } => self.keep_report(station, sender, frame),
            SweepBody::Iss { .. } | SweepBody::Feedback { .. } | SweepBody::Ack { .. } | SweepBody::Beacon { .. } => {
            }
        }
        if self.has_initiator(station) {
            let (mut radio, initiator, _) = self.transceiver(station, Role::Initiator, scene);
            if let Some(report) = initiator.receive(now, frame, sinr, &mut radio) {
                self.end_sweep(station, report, scene);
            }
        }
        if self.roll.is_node(station) {
            let (mut radio, _, responder) = self.transceiver(station, Role::Responder, scene);
            if let Some(report) = responder.receive(now, frame, sinr, &mut radio) {
                self.note_answer(station, report, scene);
            }
            self.give_way(station, scene);
        }
    }

    /// A station that sweeps has received a report of its sectors: keeps it if the station has asked for it.
    fn keep_report(&mut self, station: StationId, sender: StationId, frame: &SweepFrame) {
        if let Some(gathered) = self.sweeps.get_mut(&station)
            && self.stacks[station.index()].initiator.awaits_report_of(frame.from)
        {
            let measurements = self.stacks[sender.index()].responder.measurements();
            gathered.reports.insert(sender, measurements.to_vec());
        }
    }

    /// A station has received a frame for another one: the medium is claimed.
    fn overhear(&mut self, station: StationId, frame: &SweepFrame, scene: &mut Scene) {
        let has_initiator = self.has_initiator(station);
        let Stack { initiator, responder, .. } = &mut self.stacks[station.index()];
        if has_initiator {
            initiator.overhear(scene.now, frame);
        }
        if self.roll.is_node(station) {
            responder.overhear(scene.now, frame);
            self.give_way(station, scene);
        }
    }

    /// Counts an answer that begins or has ended.
    pub(super) fn note_answer(&mut self, station: StationId, report: ResponderReport, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        match report {
            ResponderReport::Heard(heard) => {
                (stack.is_answering, stack.outcome, stack.has_answered) = (true, FrameOutcome::WORST, false);
                self.ledger.packets[station.index()].offered += 1;
                scene.offered += 1;
                self.trace_heard(station, heard.initiator.station(), scene);
            }
            ResponderReport::Answered { outcome, sweeps, .. } => {
                let end = match outcome {
                    ResponderOutcome::Sent => PacketEnd::Sent,
                    ResponderOutcome::Trained(_) => PacketEnd::Acknowledged,
                    ResponderOutcome::WindowOver => PacketEnd::ChannelAccessFailure,
                    ResponderOutcome::NoFeedback => PacketEnd::NoAcknowledgement,
                };
                let fate = if sweeps > 0 { PacketFate::Sent(stack.outcome) } else { PacketFate::LostChannelAccess };
                self.end_answer(station, end, fate, sweeps.into(), scene);
            }
        }
    }

    /// Whether a frame is for a station: a beacon is for those whose applications hear.
    pub(super) fn is_for(&self, frame: &SweepFrame, station: StationId) -> bool {
        match frame.body {
            SweepBody::Beacon { .. } => self.hears[station.index()],
            _ => frame.to.station().is_none_or(|to| to == station),
        }
    }

    /// The outcome of a frame at the station that it is for, or the best one if it is for several.
    pub(super) fn outcome(&self, transmission: &Transmission, frame: &SweepFrame, scene: &Scene) -> FrameOutcome {
        let arrivals = self.arrivals.iter().filter(|arrival| self.is_for(frame, arrival.station));
        let missed = || scene.airs[self.radios.air].missed(transmission);
        arrivals.map(|arrival| arrival.outcome).max().unwrap_or_else(missed)
    }

    /// What became of a frame at the station that it is for, or at the first of those where it did best.
    pub(super) fn fate(&self, transmission: &Transmission, frame: &SweepFrame, scene: &Scene) -> Fate {
        let outcome = self.outcome(transmission, frame, scene);
        let is_best = |arrival: &&Arrival| arrival.outcome == outcome && self.is_for(frame, arrival.station);
        Fate { outcome, arrival: self.arrivals.iter().find(is_best).copied() }
    }

    /// Tells the observer of a frame that ends now.
    fn tell_frame(
        &mut self,
        transmission: &Transmission,
        frame: &SweepFrame,
        scene: &Scene,
        observer: &mut impl Observer,
    ) {
        let source = &self.stacks[transmission.source().index()];
        let enclosed = match (frame.body, &source.task) {
            (SweepBody::Beacon { .. }, Some(RadioTask::Broadcast(broadcast))) => {
                Enclosed::Payload(broadcast.payload(&self.payloads))
            }
            (SweepBody::Brp { .. }, _) => Enclosed::Measurements(source.responder.measurements()),
            _ => Enclosed::Nothing,
        };
        frame.write(enclosed, &mut self.frame.octets);
        let (network, fate) = (self.radios.network, self.fate(transmission, frame, scene));
        let end = FrameEnd { network, channel: None, transmission, fate, arrivals: &self.arrivals };
        self.frame.tell(end, scene, observer);
    }
}
