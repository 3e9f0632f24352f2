//! The responder of a sector level sweep (IEEE 802.11ad-2012, 9.35.2.3): it listens in all directions, keeps the sector
//! of the initiator that it heard best, and sweeps its own sectors with that choice.

use sextant_channel::Db;
use sextant_kernel::SimTime;

use super::address::MacAddress;
use super::alarm::Alarm;
use super::backoff::{Backoff, Carrier};
use super::frame::{SectorFeedback, SectorMeasurement, SweepBody, SweepFrame};
use super::port::{Event, Radio};
use super::sector::SectorLayout;
use super::settings::{AnswerSettings, Contention, SweepSettings};
use super::snr_report::SnrReport;
use super::timing::{MBIFS, SBIFS, SSW_AIRTIME, duration_field, sweep_end};
use crate::RadioState;

mod answering;
mod feedback;
mod measuring;
mod report;
#[cfg(test)]
mod tests;

use answering::Answering;
pub use report::{HeardSweep, ResponderOutcome, ResponderReport};

/// Failed attempts in an A-BFT that a responder tolerates before it backs off (dot11RSSRetryLimit).
const RSS_RETRY_LIMIT: u8 = 8;
/// A responder that backs off lets fewer than this number of A-BFTs pass (dot11RSSBackoff).
const RSS_BACKOFF: u32 = 8;

#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Listening,
    /// A sweep is under way; the timer is its end.
    Hearing(HeardSweep),
    /// Contending for the channel.
    Contending(Answering, Backoff),
    /// Waiting for a given start.
    Waiting(Answering),
    /// Sending the frame with this index.
    Sweeping(Answering, u16),
    /// Silent before the frame with this index.
    Spacing(Answering, u16),
    AwaitingFeedback(Answering),
    /// Waiting for the end of a slot that needs no more feedback.
    BetweenSlots(Answering),
    /// Silent before the acknowledgement of a choice.
    TurningToAck(Answering, SectorFeedback),
    Acknowledging(Answering, SectorFeedback),
    /// Silent before the report of all sectors.
    TurningToReport(Answering, SectorFeedback),
    Reporting(Answering, SectorFeedback),
}

/// The state machine. While it answers a sweep, it ignores sweeps of other initiators; a new sweep of the same
/// initiator ends the answer.
#[derive(Clone, Debug)]
pub struct Responder {
    address: MacAddress,
    layout: SectorLayout,
    settings: SweepSettings,
    state: State,
    carrier: Carrier,
    alarm: Alarm,
    /// Sweep for this station alone whose choice was acknowledged last: the acknowledgement may have been lost.
    acknowledged: Option<HeardSweep>,
    /// Answers in a row without feedback, in A-BFTs.
    failed: u8,
    /// A-BFTs to let pass.
    skip: u32,
    /// The initiator whose last A-BFT ended before this station had swept all its sectors, and the frame to go on with.
    unfinished: Option<(MacAddress, u16)>,
    /// The sectors of the last sweep that were heard, if they may be asked for.
    measurements: Vec<SectorMeasurement>,
}

impl Responder {
    /// A responder at `address` that answers in this way.
    #[must_use]
    pub fn new(address: MacAddress, answers: AnswerSettings) -> Self {
        Self {
            address,
            layout: answers.layout(),
            settings: answers.sweep(),
            state: State::Listening,
            carrier: Carrier::default(),
            alarm: Alarm::default(),
            acknowledged: None,
            failed: 0,
            skip: 0,
            unfinished: None,
            measurements: Vec::new(),
        }
    }

    /// Whether a sweep is heard or answered.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Listening)
    }

    /// Until when the frames and signals that this station has heard claim the medium; before now if it is free.
    #[must_use]
    pub const fn claimed_until(&self) -> SimTime {
        self.carrier.free_from()
    }

    /// Gives up what is under way, without a report. A frame on the air must have ended.
    ///
    /// # Panics
    /// If a frame of this station is on the air.
    pub fn stop(&mut self, radio: &mut impl Radio) {
        assert!(!self.is_transmitting(), "a frame is on the air");
        self.alarm.clear(radio);
        if matches!(self.state, State::Spacing(..)) {
            radio.listen();
        }
        self.state = State::Listening;
    }

    /// A frame was decoded whose last bit arrives now, with the SINR `sinr`. A deaf radio decodes none: frames that come
    /// while this station transmits are ignored.
    pub fn receive(
        &mut self,
        now: SimTime,
        frame: &SweepFrame,
        sinr: Db,
        radio: &mut impl Radio,
    ) -> Option<ResponderReport> {
        if self.is_transmitting() {
            return None;
        }
        let is_unicast = frame.to == self.address;
        match frame.body {
            SweepBody::Iss { cdown, sector, total_sectors, rx_antennas: 1.. }
                if (is_unicast || frame.to == MacAddress::BROADCAST) && self.takes(frame.from) =>
            {
                let end = sweep_end(now, cdown, frame.duration_us, std::time::Duration::ZERO);
                let initiator = frame.from;
                let heard = HeardSweep { initiator, sector, snr: sinr, frames: 1, total_sectors, end, is_unicast };
                self.hear(now, heard, radio);
            }
            SweepBody::Feedback { feedback, refinement } if is_unicast => {
                return self.take(now, frame.from, feedback, refinement, radio);
            }
            _ if is_unicast => {}
            _ => self.overhear(now, frame),
        }
        None
    }

    /// A frame for another station was decoded whose last bit arrives now.
    pub fn overhear(&mut self, now: SimTime, frame: &SweepFrame) {
        if !self.is_transmitting() {
            self.defer(now, now + frame.duration());
        }
    }

    /// Handles an event; returns a report if a sweep or an answer is over.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, now: SimTime, event: Event, radio: &mut impl Radio) -> Option<ResponderReport> {
        self.alarm.note(event);
        match (self.state, event) {
            (_, Event::CarrierBusy) => {
                if let State::Contending(_, backoff) = &mut self.state {
                    backoff.freeze(now, self.carrier);
                }
                self.carrier.becomes_busy();
                None
            }
            (_, Event::CarrierIdle) => {
                self.carrier.becomes_idle(now);
                self.pursue(now, radio)
            }
            (State::Hearing(heard), Event::WaitExpired) => Some(self.answer(heard, now, radio)),
            (State::Contending(..), Event::TransmitReady) => self.pursue(now, radio),
            (State::Waiting(answering), Event::TransmitReady) => {
                let sweeps = if answering.first == 0 { answering.sweeps + 1 } else { answering.sweeps.max(1) };
                self.send(Answering { sweeps, ..answering }, answering.first, radio);
                None
            }
            (State::Spacing(answering, index), Event::TransmitReady) => {
                self.send(answering, index, radio);
                None
            }
            (State::Sweeping(answering, index), Event::TransmissionEnded)
                if index + 1 < self.end_of_turn(answering) =>
            {
                radio.enter(RadioState::Idle);
                self.alarm.set(now, now + self.layout.gap_after(index), Event::TransmitReady, radio);
                self.state = State::Spacing(answering, index + 1);
                None
            }
            (State::Sweeping(answering, _), Event::TransmissionEnded) => {
                radio.listen();
                self.await_feedback(answering, now, radio)
            }
            (State::AwaitingFeedback(answering), Event::WaitExpired) => self.miss(answering, now, radio),
            (State::AwaitingFeedback(answering) | State::BetweenSlots(answering), Event::TransmitReady) => {
                self.next_slot(answering, radio)
            }
            (State::TurningToAck(answering, feedback), Event::TransmitReady) => {
                self.acknowledge(answering, feedback, radio);
                None
            }
            (State::Acknowledging(answering, feedback), Event::TransmissionEnded) => {
                radio.listen();
                let is_new = self.acknowledged.replace(answering.heard) != Some(answering.heard);
                let report = self.end(answering, ResponderOutcome::Trained(feedback));
                is_new.then_some(report)
            }
            (State::TurningToReport(answering, feedback), Event::TransmitReady) => {
                self.report(answering, feedback, radio);
                None
            }
            (State::Reporting(answering, feedback), Event::TransmissionEnded) => {
                radio.listen();
                Some(self.end(answering, ResponderOutcome::Trained(feedback)))
            }
            (state, event) => panic!("{event:?} cannot happen in {state:?}"),
        }
    }

    /// Whether a frame of this machine is on the air, so that it hears none.
    const fn is_transmitting(&self) -> bool {
        matches!(self.state, State::Sweeping(..) | State::Acknowledging(..) | State::Reporting(..))
    }

    /// Whether a sweep of this initiator is heard now: nothing is under way, or its own last sweep.
    fn takes(&self, initiator: MacAddress) -> bool {
        match self.state {
            State::Listening => true,
            State::Hearing(heard) => heard.initiator == initiator,
            State::Contending(answering, _)
            | State::Waiting(answering)
            | State::AwaitingFeedback(answering)
            | State::BetweenSlots(answering) => answering.heard.initiator == initiator,
            State::Sweeping(..)
            | State::Spacing(..)
            | State::TurningToAck(..)
            | State::Acknowledging(..)
            | State::TurningToReport(..)
            | State::Reporting(..) => false,
        }
    }

    /// A frame of a sweep that is for this station.
    fn hear(&mut self, now: SimTime, frame: HeardSweep, radio: &mut impl Radio) {
        let heard = match self.state {
            State::Hearing(heard) if heard.end == frame.end && heard.is_unicast == frame.is_unicast => {
                self.measure(frame);
                let best = if frame.snr > heard.snr { frame } else { heard };
                HeardSweep { frames: heard.frames + 1, ..best }
            }
            _ => {
                self.alarm.clear(radio);
                self.alarm.set(now, frame.end, Event::WaitExpired, radio);
                self.measurements.clear();
                self.measure(frame);
                frame
            }
        };
        self.state = State::Hearing(heard);
    }

    /// The sweep is over.
    fn answer(&mut self, heard: HeardSweep, now: SimTime, radio: &mut impl Radio) -> ResponderReport {
        let start = heard.end + MBIFS;
        let cw = self.settings.access_category().cw_min();
        let answering = Answering { heard, cw, sweeps: 0, start, first: 0, choice: None };
        match self.settings.contention() {
            _ if heard.is_unicast => self.wait(answering, now, radio),
            Contention::Csma | Contention::CsmaFeedback { .. } => self.contend(answering, start, now, radio),
            Contention::Abft(_) if self.skip > 0 => {
                self.skip -= 1;
                self.state = State::Listening;
            }
            Contention::Abft(abft) => {
                let slot = radio.slots(u32::from(abft.slots()) - 1);
                let start = start + abft.slot_duration() * slot;
                let unfinished = self.unfinished.take().filter(|(initiator, _)| *initiator == heard.initiator);
                let first = unfinished.map_or(0, |(_, first)| first);
                self.wait(Answering { start, first, ..answering }, now, radio);
            }
        }
        ResponderReport::Heard(heard)
    }

    fn wait(&mut self, answering: Answering, now: SimTime, radio: &mut impl Radio) {
        self.alarm.set(now, answering.start, Event::TransmitReady, radio);
        self.state = State::Waiting(answering);
    }

    /// Starts a backoff that counts from `ready_from` at the earliest.
    fn contend(&mut self, answering: Answering, ready_from: SimTime, now: SimTime, radio: &mut impl Radio) {
        let slots = radio.slots(answering.cw);
        let backoff = Backoff::new(self.settings.access_category(), ready_from, slots);
        self.state = State::Contending(answering, backoff);
        let end = backoff.end(self.carrier);
        if let Some(end) = end {
            self.alarm.set(now, end, Event::TransmitReady, radio);
        }
    }

    /// Goes on with a backoff, if there is one: transmits at its end; gives up if the sweep would end after the window.
    fn pursue(&mut self, now: SimTime, radio: &mut impl Radio) -> Option<ResponderReport> {
        let State::Contending(answering, backoff) = self.state else { return None };
        let end = backoff.end(self.carrier)?;
        let window_end = answering.heard.end + MBIFS + self.settings.window();
        if end + self.layout.sweep_duration() > window_end {
            self.alarm.clear(radio);
            return Some(self.end(answering, ResponderOutcome::WindowOver));
        }
        if end <= now && !self.alarm.is_set() {
            self.send(Answering { sweeps: answering.sweeps + 1, ..answering }, 0, radio);
        } else {
            self.alarm.set(now, end.max(now), Event::TransmitReady, radio);
        }
        None
    }

    /// The medium is taken until then.
    fn defer(&mut self, now: SimTime, until: SimTime) {
        if until > self.carrier.free_from() {
            if let State::Contending(_, backoff) = &mut self.state {
                backoff.suspend(now, self.carrier);
            }
            self.carrier.is_taken_until(until);
        }
    }

    /// Starts the frame `index` of the sweep.
    fn send(&mut self, answering: Answering, index: u16, radio: &mut impl Radio) {
        let HeardSweep { initiator, is_unicast, total_sectors, .. } = answering.heard;
        let sector = self.layout.sector(index);
        let later_turns = self.layout.total() - self.end_of_turn(answering);
        let mut taken =
            self.layout.remaining_after(index, SSW_AIRTIME) - (SSW_AIRTIME + SBIFS) * u32::from(later_turns);
        if !is_unicast {
            taken += self.settings.taken_after_answer(total_sectors);
        }
        let cdown = self.layout.total() - 1 - index;
        let body = SweepBody::Rss { cdown, sector, feedback: choice(answering.heard) };
        let duration_us = duration_field(taken);
        radio.transmit(SweepFrame { duration_us, to: initiator, from: self.address, body }, sector);
        self.state = State::Sweeping(answering, index);
    }

    fn end(&mut self, answering: Answering, outcome: ResponderOutcome) -> ResponderReport {
        self.state = State::Listening;
        ResponderReport::Answered { heard: answering.heard, outcome, sweeps: answering.sweeps }
    }
}

/// The choice of a sector of the initiator.
fn choice(heard: HeardSweep) -> SectorFeedback {
    SectorFeedback { select: heard.sector, snr: SnrReport::of(heard.snr), poll_required: false }
}
