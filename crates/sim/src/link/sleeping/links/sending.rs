//! Sending: attempts begin, frames go on air and end, and what becomes of a packet after an attempt.

use std::time::Duration;

use sextant_kernel::{SimTime, StationId};
use sextant_mac::sleep::frame::unit;
use sextant_mac::sleep::{Aimed, Ended, Event as Step, Form, Job, PhasesConfig, Recipient, Rest, Sent};

use super::Links;
use super::frames::NodeFrame;
use crate::air::{Aim, Emission, Transmission};
use crate::event::sleeping::Event;
use crate::link::fate::Fate;
use crate::link::frame_buffer::FrameEnd;
use crate::link::sleeping::stack::{KnownPhase, OnAir, Work};
use crate::observer::Observer;
use crate::purpose;
use crate::scene::Scene;
use crate::service::outcome::FrameOutcome;
use crate::service::report::{Destination, SendOutcome};

/// The wait before an attempt is up to this power of two of intervals, at most.
const GREATEST_EXPONENT: u32 = 3;

impl Links {
    /// A station goes on with the packet that is first in its queue, if nothing else keeps it. A packet that waited for what the
    /// station received waits for a random time besides: all that received it would begin at one instant.
    pub(super) fn go_on(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let Some(frame) = stack.waiting.front() else { return };
        if !stack.is_there || !matches!(stack.work, Work::None) {
            return;
        }
        if !stack.sleeper.is_free() {
            stack.is_held |= stack.sleeper.is_receiving();
            return;
        }
        let was_held = std::mem::take(&mut stack.is_held);
        let (to, mpdu_octets) = (frame.to, frame.mpdu_octets);
        let airtime = self.phy().airtime(mpdu_octets);
        match self.aim(station, to, airtime, scene.now) {
            Some((at, aimed)) => {
                let key = self.schedule_at(station, at, Event::AttemptDue, scene);
                self.stacks[station.index()].work = Work::Aiming { key, span: aimed.span };
            }
            None if was_held => self.back_off(station, 0, scene),
            None => {
                let span = match to {
                    // All those that are woken for a copy hear the next one.
                    Destination::All => self.settings.whole(airtime) + self.settings.period(airtime),
                    Destination::Station(to) if self.settings.form == Form::Csl && self.is_always_on(to) => {
                        Duration::ZERO
                    }
                    Destination::Station(_) => self.settings.whole(airtime),
                };
                self.attempt(station, span, scene);
            }
        }
    }

    /// When a station begins its next attempt to reach another one whose phase it knows, and how.
    fn aim(&self, station: StationId, to: Destination, airtime: Duration, now: SimTime) -> Option<(SimTime, Aimed)> {
        let Destination::Station(to) = to else { return None };
        let stack = &self.stacks[station.index()];
        let known = stack.phases.get(&to)?;
        let interval = self.settings.interval;
        // It will be tried within an interval from now.
        let aimed = self.settings.aimed(airtime, now.saturating_since(known.told) + interval)?;
        let before = aimed.lead + self.settings.access();
        let passed = (now + before).saturating_since(known.at).as_nanos().div_ceil(interval.as_nanos().max(1));
        let from = u32::try_from(passed.saturating_sub(1)).unwrap_or(u32::MAX);
        let at = |number: u32| (known.at + stack.checks.span(interval * number)).saturating_sub(before);
        let number = (from..from.saturating_add(3)).find(|&number| at(number) >= now)?;
        Some((at(number), aimed))
    }

    /// An attempt begins that was aimed at a wake-up of the receiver.
    pub(super) fn begin_aimed(&mut self, station: StationId, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        let Work::Aiming { span, .. } = std::mem::replace(&mut stack.work, Work::None) else { return };
        if stack.sleeper.is_free() {
            self.attempt(station, span, scene);
        }
        // One that is just receiving tries it an interval later.
        self.go_on(station, scene);
    }

    fn attempt(&mut self, station: StationId, span: Duration, scene: &mut Scene) {
        let airtime = self.stacks[station.index()].waiting.front().map(|frame| self.phy().airtime(frame.mpdu_octets));
        let stack = &mut self.stacks[station.index()];
        let (Some(frame), Some(airtime)) = (stack.waiting.front_mut(), airtime) else { return };
        frame.looks += 1;
        if let Some(track) = &mut frame.track {
            track.begin_assessment(scene.now);
        }
        let to = match frame.to {
            Destination::All => Recipient::All,
            Destination::Station(_) => Recipient::One,
        };
        stack.work = Work::Sending;
        self.command(station, scene, |sleeper, port| sleeper.send(Job { to, airtime, span }, port));
    }

    /// What the protocol machine of a station waits for happens.
    pub(super) fn handle_station(
        &mut self,
        station: StationId,
        event: Step,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) {
        self.stacks[station.index()].timer = None;
        let ended_frame = if event == Step::FrameEnded { self.end_frame(station, scene, observer) } else { None };
        let now = scene.now;
        let ended = self.command(station, scene, |sleeper, port| sleeper.handle(event, now, port));
        if let Some((frame, transmission)) = ended_frame {
            self.receive(station, frame, &transmission, scene);
        }
        self.note_end(station, ended, scene);
    }

    /// Something of a station goes on air; returns how long it is there.
    pub(super) fn begin_frame(&mut self, station: StationId, sent: Sent, scene: &mut Scene) -> Duration {
        let to = self.recipient(station, sent);
        let airtime = self.phy().airtime(self.octets(station, sent));
        self.wake(station, scene.now + airtime, scene);
        let stack = &mut self.stacks[station.index()];
        let emission = Emission { power: stack.tx_power, aim: Aim::Omnidirectional };
        if let Some(track) = stack.waiting.front_mut().and_then(|frame| frame.track.as_mut())
            && sent != Sent::Acknowledgement
        {
            track.end_assessment(false);
        }
        let to = match to {
            Destination::Station(to) => Some(self.radios.receiver(to)),
            Destination::All => None,
        };
        let (interface, place) = (self.radios.interface(station), scene.place(station));
        let transmission = scene.airs[self.radios.air].begin(scene.now, interface, to, place, emission, airtime);
        stack.on_air = Some(OnAir { transmission, sent });
        match sent {
            Sent::Acknowledgement => stack.answer_start = scene.now,
            _ => stack.last_start = scene.now,
        }
        let wakes = match sent {
            Sent::Strobe | Sent::WakeUp { .. } => true,
            Sent::Data => self.settings.form == Form::RepeatedData,
            Sent::Acknowledgement => false,
        };
        stack.usage.strobes += u64::from(wakes);
        airtime
    }

    /// What a station has on air ends; returns what it was.
    fn end_frame(
        &mut self,
        station: StationId,
        scene: &mut Scene,
        observer: &mut impl Observer,
    ) -> Option<(NodeFrame, Transmission)> {
        let OnAir { transmission, sent } = self.stacks[station.index()].on_air.take()?;
        let air = self.radios.air;
        scene.airs[air].end(scene.now, &transmission, &mut self.arrivals);
        let to = self.recipient(station, sent);
        let fate = match to {
            Destination::Station(to) => {
                Fate::of(&transmission, &self.arrivals, &scene.airs[air], |station| station == to)
            }
            Destination::All => {
                Fate::of(&transmission, &self.arrivals, &scene.airs[air], |station| self.hears[station.index()])
            }
        };
        let frame = self.node_frame(station, sent, to);
        self.write_frame(station, &frame, observer);
        if observer.wants_frames() {
            let (network, channel) = (self.radios.network, Some(self.channel));
            let end = FrameEnd { network, channel, transmission: &transmission, fate, arrivals: &self.arrivals };
            self.frame.tell(end, scene, observer);
        }
        match sent {
            Sent::Data => self.note_transmission(station, &transmission, fate, scene),
            Sent::Strobe | Sent::WakeUp { .. } => self.note_announcement(station, frame.sequence, fate.outcome),
            Sent::Acknowledgement => {
                if let Destination::Station(to) = to
                    && fate.outcome != FrameOutcome::Received
                {
                    self.note_announcement(to, frame.sequence, fate.outcome);
                }
            }
        }
        Some((frame, transmission))
    }

    /// Notes what became of a frame that announced the packet under way, or of the answer to it.
    fn note_announcement(&mut self, station: StationId, sequence: u8, outcome: FrameOutcome) {
        // The packet itself was not received, whoever heard that it would come.
        let outcome = if outcome == FrameOutcome::Received { FrameOutcome::Weak } else { outcome };
        let under_way = self.stacks[station.index()].waiting.front_mut();
        if let Some(packet) = under_way.filter(|packet| packet.sequence == sequence) {
            packet.outcome = packet.outcome.max(outcome);
        }
    }

    /// Notes a transmission of the packet under way.
    fn note_transmission(&mut self, station: StationId, transmission: &Transmission, fate: Fate, scene: &mut Scene) {
        let Some(packet) = self.stacks[station.index()].waiting.front_mut() else { return };
        // Copies in one attempt are one transmission.
        let is_copy = packet.sent_in.replace(packet.attempts) == Some(packet.attempts);
        packet.transmissions += u32::from(!is_copy);
        if fate.outcome == FrameOutcome::Received && packet.outcome != FrameOutcome::Received {
            self.ledger.note_reception(station, packet.offered, scene.now);
        }
        packet.outcome = packet.outcome.max(fate.outcome);
        match &mut packet.track {
            Some(track) if is_copy => track.end_copy(transmission, fate, &self.radios, scene),
            Some(track) => track.end_transmission(transmission, fate, &self.radios, scene),
            None => {}
        }
    }

    /// An attempt of a station may have ended; it goes on.
    pub(super) fn note_end(&mut self, station: StationId, ended: Option<Ended>, scene: &mut Scene) {
        if let Some(ended) = ended {
            self.end_attempt(station, ended, scene);
        }
        self.go_on(station, scene);
    }

    fn end_attempt(&mut self, station: StationId, ended: Ended, scene: &mut Scene) {
        let (most_busy, most_retries) = (u32::from(self.settings.max_backoffs), u32::from(self.settings.max_retries));
        let stack = &mut self.stacks[station.index()];
        stack.work = Work::None;
        let Some(packet) = stack.waiting.front_mut() else { return };
        if ended == Ended::Busy {
            packet.busy += 1;
            if let Some(track) = &mut packet.track {
                track.end_assessment(true);
            }
        } else {
            packet.busy = 0;
            packet.attempts += 1;
        }
        let (busy, attempts, to) = (packet.busy, packet.attempts, packet.to);
        match ended {
            Ended::Sent => self.finish_frame(station, SendOutcome::Sent, scene),
            Ended::Acknowledged => {
                if let Some(track) = &mut packet.track {
                    track.acknowledge(scene.now);
                }
                self.finish_frame(station, SendOutcome::Acknowledged, scene);
            }
            Ended::Busy if busy > most_busy => {
                self.finish_frame(station, SendOutcome::ChannelAccessFailure, scene);
            }
            Ended::Busy => self.back_off(station, busy, scene),
            Ended::Unacknowledged => {
                if let Destination::Station(to) = to {
                    stack.phases.remove(&to);
                }
                if attempts > most_retries {
                    self.finish_frame(station, SendOutcome::NoAcknowledgement, scene);
                } else {
                    self.back_off(station, attempts, scene);
                }
            }
        }
    }

    /// A station waits before its next attempt: for any time up to some intervals.
    fn back_off(&mut self, station: StationId, number: u32, scene: &mut Scene) {
        let stack = &mut self.stacks[station.index()];
        stack.draws += 1;
        let place = [station.0.into(), self.radios.network.0.into(), stack.draws];
        let most = self.settings.interval * (1 << number.min(GREATEST_EXPONENT));
        let wait = most.mul_f64(scene.seed.uniform(purpose::SLEEP, place));
        let key = self.schedule(station, wait, Event::BackoffOver, scene);
        self.stacks[station.index()].work = Work::BackingOff(key);
    }

    /// Whether the receiver of a station is always on.
    pub(super) fn is_always_on(&self, station: StationId) -> bool {
        self.stacks[station.index()].sleeper.rest() == Rest::Listening
    }

    /// A sender knows from an acknowledgement that ends now when its receiver can be reached.
    pub(super) fn learn_phase(&mut self, station: StationId, from: StationId, scene: &Scene) {
        if self.settings.phases != PhasesConfig::Learned || self.is_always_on(from) {
            return;
        }
        let answerer = &self.stacks[from.index()];
        let at = match self.settings.form {
            Form::XMac => return,
            Form::RepeatedData => self.stacks[station.index()].last_start,
            // The receiver tells when it listens next.
            Form::Csl => answerer.answer_start + unit(self.phy()) * u32::from(self.csl_phase(answerer)),
        };
        self.stacks[station.index()].phases.insert(from, KnownPhase { at, told: scene.now });
    }
}
