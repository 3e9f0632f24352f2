//! Sending: a frame goes on air in its slot, and ends.

use std::time::Duration;

use sextant_channel::Dbm;
use sextant_kernel::StationId;
use sextant_mac::tsch::{Asn, SlotKind, Turn};

use super::Links;
use crate::air::{Aim, Emission, Transmission};
use crate::event::link::LinkEvent;
use crate::event::tsch::Event;
use crate::link::fate::Fate;
use crate::link::tsch::stack::{FrameKind, Listening, Sending};
use crate::observer::Observer;
use crate::scene::Scene;
use crate::service::outcome::{Deafness, FrameOutcome};
use crate::service::report::{Destination, SendOutcome};

impl Links {
    /// The first symbol of the frame of a station goes out.
    pub(super) fn start_frame(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let planned = stack.planned.take().expect("a slot was planned");
        let chance = planned.chance;
        stack.used = Some(chance.asn);
        if stack.listening.is_some() || stack.answer.is_some() {
            // Only if a correction has moved the slot into the one before: it lets the slot go by.
            return self.replan(station, scene);
        }
        let place = self.settings.hopping.place(chance.asn, chance.cell.channel_offset);
        if stack.schedule.heard_at(chance.asn).is_some() {
            stack.usage.take_slot();
        }
        let octets = match chance.turn {
            Turn::Beacon => self.plan.beacon_octets(&self.settings, station),
            turn => stack.sender.frame(turn).mpdu_octets,
        };
        let to = match chance.turn {
            Turn::Station(to) => Some(to),
            Turn::All | Turn::Beacon => None,
        };
        let (airtime, turnaround) = (self.phy().airtime(octets), self.phy().turnaround());
        let stack = &mut self.stacks[station.index()];
        stack.usage.sent(turnaround, airtime);
        self.tune(station, place, Some(Deafness::Transmitting), scene);
        self.wake(station, chance.asn, place, scene);
        let power = self.stacks[station.index()].tx_power;
        let transmission = self.begin(station, to, place, airtime, power, scene);
        self.listeners.awake(place).frames += 1;
        self.stacks[station.index()].sending =
            Some(Sending { chance, place, transmission: Some(transmission), missed: None });
        self.radios[place].after(airtime, station, LinkEvent::Tsch(Event::FrameEnds), scene);
    }

    /// Something of a station goes on air on a channel.
    pub(super) fn begin(
        &mut self,
        station: StationId,
        to: Option<StationId>,
        place: usize,
        airtime: Duration,
        power: Dbm,
        scene: &mut Scene,
    ) -> Transmission {
        let radios = &self.radios[place];
        let to = to.map(|to| radios.receiver(to));
        let (now, position) = (scene.now, scene.place(station));
        let emission = Emission { power, aim: Aim::Omnidirectional };
        scene.airs[radios.air].begin(now, radios.interface(station), to, position, emission, airtime)
    }

    /// Wakes the stations that listen in a slot on a channel when a frame of `from` begins.
    fn wake(&mut self, from: StationId, asn: Asn, place: usize, scene: &mut Scene) {
        let Self { settings, stacks, listeners, radios, .. } = self;
        // Another frame that begins at the same instant in the same slot wakes nobody else.
        if listeners.awake(place).woken.replace((scene.now, asn)) == Some((scene.now, asn)) {
            return;
        }
        let delimiter = scene.now + settings.timeslot.preamble();
        let mut awake = std::mem::take(&mut listeners.awake(place).stations);
        for station in listeners.at(asn) {
            let stack = &mut stacks[station.index()];
            let sends = stack.used == Some(asn) || stack.planned.is_some_and(|planned| planned.chance.asn == asn);
            if station == from || sends || stack.listening.is_some() {
                continue;
            }
            let Some(heard) = stack.schedule.heard_at(asn) else { continue };
            if settings.hopping.place(asn, heard.channel_offset) != place {
                continue;
            }
            let opened = stack.clock.start_of(asn) + settings.timeslot.window_opens();
            let closes = opened + settings.timeslot.window();
            // It hears a frame whose delimiter begins while it is on.
            if delimiter < opened || closes <= delimiter {
                continue;
            }
            stack.listening = Some(Listening { asn, opened, closes, followed: None, answers: false });
            stack.usage.take_slot();
            radios[place].tune(station, None, &mut stack.deafness, scene);
            awake.push(station);
            scene.steps += 1;
        }
        listeners.awake(place).stations = awake;
    }

    /// The frame of a station ends.
    pub(super) fn end_frame(&mut self, station: StationId, scene: &mut Scene, observer: &mut impl Observer) {
        let sending = self.stacks[station.index()].sending.as_mut().expect("only a frame on air ends");
        let transmission = sending.transmission.take().expect("only a frame on air ends");
        let (chance, place) = (sending.chance, sending.place);
        let air = self.radios[place].air;
        scene.airs[air].end(scene.now, &transmission, &mut self.arrivals);
        self.note_followers(scene.now);
        let to = match chance.turn {
            Turn::Station(to) => Destination::Station(to),
            Turn::All | Turn::Beacon => Destination::All,
        };
        let fate = match to {
            Destination::Station(to) => {
                Fate::of(&transmission, &self.arrivals, &scene.airs[air], |station| station == to)
            }
            Destination::All => {
                Fate::of(&transmission, &self.arrivals, &scene.airs[air], |station| self.hears[station.index()])
            }
        };
        let was_received = self.note_transmission(station, chance.turn, &transmission, fate, scene);
        let kind = self.stacks[station.index()].sender.frame(chance.turn).kind;
        self.write_sent(station, chance, observer);
        if observer.wants_frames() {
            self.tell_frame(place, &transmission, fate, scene, observer);
        }
        match kind {
            FrameKind::Beacon => self.receive_beacon(station, chance.asn, &transmission, scene),
            FrameKind::Data | FrameKind::KeepAlive | FrameKind::SixP(_) => {
                self.correct_clocks(station, chance.asn, &transmission, scene);
            }
        }
        if kind == FrameKind::Data {
            self.deliver(station, chance.turn, was_received, scene);
        }
        if let (FrameKind::SixP(_), Destination::Station(to)) = (kind, to)
            && !was_received
            && self.has_received(to)
        {
            let content = self.stacks[station.index()].sender.frame(chance.turn).content;
            self.receive_six_p(station, to, content, scene);
        }
        let is_answered = self.answer_frame(station, chance, place, &transmission, scene);
        self.close_slot(place, scene);
        match chance.turn {
            Turn::Station(_) => self.await_acknowledgement(station, place, is_answered, scene),
            turn => {
                let stack = &mut self.stacks[station.index()];
                stack.usage.slots.counts.add(SlotKind::Transmit, 1);
                stack.sending = None;
                let frame = stack.sender.sent(turn);
                self.tune(station, place, Some(Deafness::Asleep), scene);
                self.finish_frame(station, frame, SendOutcome::Sent, scene);
                self.replan(station, scene);
            }
        }
    }

    /// Notes a transmission of a frame; returns whether one before had been received already.
    fn note_transmission(
        &mut self,
        station: StationId,
        turn: Turn,
        transmission: &Transmission,
        fate: Fate,
        scene: &mut Scene,
    ) -> bool {
        let place = self.stacks[station.index()].sending.map_or(0, |sending| sending.place);
        let radios = &self.radios[place];
        let frame = self.stacks[station.index()].sender.frame(turn);
        let was_received = frame.outcome == FrameOutcome::Received;
        frame.transmissions += 1;
        if fate.outcome == FrameOutcome::Received && !was_received && frame.kind == FrameKind::Data {
            self.ledger.note_reception(station, frame.offered, scene.now);
        }
        frame.outcome = frame.outcome.max(fate.outcome);
        if let Some(track) = &mut frame.track {
            track.end_transmission(transmission, fate, radios, scene);
        }
        was_received
    }
}
