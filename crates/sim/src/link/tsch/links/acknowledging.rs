//! Enhanced acknowledgements, and what becomes of a frame with or without one.

use sextant_kernel::StationId;
use sextant_mac::frame::{Address, Endpoint};
use sextant_mac::tsch::frame::EnhancedAck;
use sextant_mac::tsch::{Chance, Ended, Ending, SlotKind, Turn};

use super::Links;
use crate::air::Transmission;
use crate::event::link::LinkEvent;
use crate::event::tsch::Event;
use crate::link::fate::Fate;
use crate::link::tsch::stack::{Answer, FrameKind};
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::report::SendOutcome;

impl Links {
    /// The frame of a station that ends now is acknowledged, if the station that it is for has received it and is in the network.
    pub(super) fn answer_frame(
        &mut self,
        from: StationId,
        chance: Chance,
        place: usize,
        transmission: &Transmission,
        scene: &mut Scene,
    ) -> bool {
        let Turn::Station(to) = chance.turn else { return false };
        let stack = &self.stacks[to.index()];
        if !self.has_received(to) || stack.listening.is_none() || stack.answer.is_some() {
            return false;
        }
        let correction_us = EnhancedAck::fitting(self.early_us(to, chance.asn, transmission));
        let sequence = self.stacks[from.index()].sender.frame(chance.turn).sequence;
        let starts = self.settings.timeslot.ack_begins();
        let starts = Some(self.schedule(to, starts, Event::AckStarts, scene));
        let stack = &mut self.stacks[to.index()];
        stack.answer = Some(Answer { to: from, place, sequence, correction_us, starts, transmission: None });
        if let Some(listening) = &mut stack.listening {
            listening.answers = true;
        }
        true
    }

    /// A station waits for the acknowledgement of its frame, which ends now.
    pub(super) fn await_acknowledgement(
        &mut self,
        station: StationId,
        place: usize,
        is_answered: bool,
        scene: &mut Scene,
    ) {
        // Nothing else is on air for it before its receiver is on.
        self.tune(station, place, None, scene);
        if !is_answered {
            let span = self.settings.timeslot.ack_window_opens() + self.settings.timeslot.ack_window();
            let missed = self.schedule(station, span, Event::AckMissed, scene);
            if let Some(sending) = &mut self.stacks[station.index()].sending {
                sending.missed = Some(missed);
            }
        }
    }

    /// An acknowledgement of an enhanced kind.
    fn acknowledgement(&self, answer: &Answer) -> EnhancedAck {
        let &Answer { to, sequence, correction_us, .. } = answer;
        let to = Some(Endpoint { pan: self.pan, address: Address::of(to) });
        EnhancedAck { sequence, to, correction_us, is_refusal: false }
    }

    /// The first symbol of the acknowledgement of a station goes out.
    pub(super) fn start_acknowledgement(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &self.stacks[station.index()];
        let mut answer = stack.answer.expect("it acknowledges a frame");
        let (place, power) = (answer.place, stack.tx_power);
        let airtime = self.phy().airtime(self.acknowledgement(&answer).octets());
        let turnaround = self.phy().turnaround();
        self.tune(station, place, Some(Deafness::Transmitting), scene);
        answer.transmission = Some(self.begin(station, Some(answer.to), place, airtime, power, scene));
        answer.starts = None;
        let stack = &mut self.stacks[station.index()];
        stack.answer = Some(answer);
        stack.usage.sent(turnaround, airtime);
        self.radios[place].after(airtime, station, LinkEvent::Tsch(Event::AckEnds), scene);
    }

    /// The acknowledgement of a station ends.
    pub(super) fn end_acknowledgement(
        &mut self,
        station: StationId,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        let answer = self.stacks[station.index()].answer.take().expect("only an acknowledgement on air ends");
        let transmission = answer.transmission.expect("only an acknowledgement on air ends");
        let (place, to) = (answer.place, answer.to);
        let air = self.radios[place].air;
        scene.airs[air].end(scene.now, &transmission, &mut self.arrivals);
        if observer.wants_frames() {
            self.acknowledgement(&answer).write(&mut self.frame.octets);
            self.frame.payload = 0..0;
            let fate = Fate::of(&transmission, &self.arrivals, &scene.airs[air], |station| station == to);
            self.tell_frame(place, &transmission, fate, scene, observer);
        }
        self.tune(station, place, Some(Deafness::Asleep), scene);
        let is_received =
            self.arrivals.iter().any(|arrival| arrival.station == to && arrival.outcome == FrameOutcome::Received);
        // Its sender may have died.
        if self.stacks[to.index()].sending.is_none() {
            return;
        }
        if is_received {
            self.correct_by_acknowledgement(to, station, answer.correction_us, scene);
            // The receiver is on from the start of its window to the end of the acknowledgement.
            let waited = scene.now.saturating_since(transmission.start()) + self.settings.timeslot.ack_begins();
            let waited = waited.saturating_sub(self.settings.timeslot.ack_window_opens());
            self.stacks[to.index()].usage.received(waited);
            self.end_exchange(to, SendOutcome::Acknowledged, scene);
        } else {
            self.miss_acknowledgement(to, scene);
        }
    }

    /// No acknowledgement of the frame of a station came.
    pub(super) fn miss_acknowledgement(&mut self, station: StationId, scene: &mut Scene) {
        let window = self.settings.timeslot.ack_window();
        self.stacks[station.index()].usage.received(window);
        self.end_exchange(station, SendOutcome::NoAcknowledgement, scene);
    }

    /// A station knows whether its frame was acknowledged.
    fn end_exchange(&mut self, station: StationId, outcome: SendOutcome, scene: &mut Scene) {
        let network = self.radios[0].network;
        let stack = &mut self.stacks[station.index()];
        let sending = stack.sending.take().expect("a frame was sent");
        let Turn::Station(to) = sending.chance.turn else { unreachable!("only frames to one are acknowledged") };
        let is_acknowledged = outcome == SendOutcome::Acknowledged;
        if is_acknowledged && let Some(track) = &mut stack.sender.frame(sending.chance.turn).track {
            track.acknowledge(scene.now);
        }
        let kind = match is_acknowledged {
            true => SlotKind::TransmitAcknowledged,
            false => SlotKind::TransmitUnacknowledged,
        };
        stack.usage.slots.counts.add(kind, 1);
        let ended = if is_acknowledged { Ended::Acknowledged } else { Ended::GivenUp };
        self.note_use(station, &sending.chance.cell, ended);
        let stack = &mut self.stacks[station.index()];
        let ending = if is_acknowledged {
            stack.sender.acknowledged(to, sending.chance.cell)
        } else {
            let (number, schedule) = (stack.backoffs, &stack.schedule);
            let draw = |most| scene.backoff(network, station, number, most);
            stack.backoffs += 1;
            stack.sender.failed(to, sending.chance, schedule, draw)
        };
        self.tune(station, sending.place, Some(Deafness::Asleep), scene);
        match ending {
            Ending::Acknowledged(frame) | Ending::GivenUp(frame) => {
                self.note_kept_alive(station, frame.kind);
                match frame.kind {
                    FrameKind::SixP(role) => self.finish_six_p(station, &frame, role, ended, scene),
                    FrameKind::Data | FrameKind::KeepAlive | FrameKind::Beacon => {
                        self.finish_frame(station, frame, outcome, scene);
                    }
                }
            }
            Ending::Again => {}
        }
        self.replan(station, scene);
    }
}
