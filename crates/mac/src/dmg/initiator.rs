//! The initiator of a sector level sweep (IEEE 802.11ad-2012, 9.35.2.2): it sends one SSW frame from each of its
//! sectors, then listens in all directions for the answers. It also sends one beacon from each of them, which no one
//! answers.

use std::time::Duration;

use sextant_channel::Db;
use sextant_kernel::SimTime;

use super::address::MacAddress;
use super::alarm::Alarm;
use super::backoff::{Backoff, Carrier};
use super::frame::{BeamRefinement, MAX_BEACON_PAYLOAD_OCTETS, SectorFeedback, SweepBody, SweepFrame};
use super::port::{Event, Radio};
use super::sector::SectorLayout;
use super::settings::SweepSettings;
use super::timing::{
    AIR_PROPAGATION, MAX_SLS_RETRIES, MBIFS, SSW_ACK_TIMEOUT, SSW_FEEDBACK_AIRTIME, duration_field, sweep_end,
};
use crate::RadioState;
use answers::Answers;

mod answers;
mod gathering;
mod report;
#[cfg(test)]
mod tests;

pub use answers::Answer;
use gathering::FeedbackWindow;
pub use report::{Access, InitiatorOutcome, InitiatorReport, SweepPurpose};

/// A sweep under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Sweep {
    purpose: SweepPurpose,
    frames: u32,
    retries: u8,
    /// Reports of all sectors that were asked for, and those that came.
    asked: u32,
    reported: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    Contending(Sweep, Backoff),
    /// Sending the frame with this index.
    Sweeping(Sweep, u16),
    /// Silent before the frame with this index.
    Spacing(Sweep, u16),
    /// Listening for answers of all stations.
    Gathering(Sweep, FeedbackWindow),
    /// Sending feedback to this one of them.
    Informing(Sweep, FeedbackWindow, MacAddress),
    /// Listening for its report of all sectors.
    AwaitingReport(Sweep, FeedbackWindow, MacAddress),
    /// Listening for the answer of one station until its sweep must have ended.
    AwaitingAnswer(Sweep, SimTime),
    /// Sending it feedback.
    Choosing(Sweep),
    AwaitingAck(Sweep),
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Initiator {
    address: MacAddress,
    layout: SectorLayout,
    settings: SweepSettings,
    state: State,
    carrier: Carrier,
    alarm: Alarm,
    answers: Answers,
}

impl Initiator {
    /// An idle station with this address and these sectors.
    #[must_use]
    pub fn new(address: MacAddress, layout: SectorLayout, settings: SweepSettings) -> Self {
        Self {
            address,
            layout,
            settings,
            state: State::Idle,
            carrier: Carrier::default(),
            alarm: Alarm::default(),
            answers: Answers::default(),
        }
    }

    /// Whether a sweep is under way, so that [`Initiator::start`] must wait for its report.
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle)
    }

    /// The answers to the last sweep, one per station, in the order of their addresses.
    #[must_use]
    pub fn answers(&self) -> &[Answer] {
        self.answers.best()
    }

    /// Whether the report of all sectors of this station is awaited: it has just got feedback that asks for it.
    #[must_use]
    pub fn awaits_report_of(&self, station: MacAddress) -> bool {
        matches!(self.state, State::AwaitingReport(_, _, responder) if responder == station)
    }

    /// Whether a sweep waits for the channel: it has not begun, and [`Initiator::withdraw`] can take it back.
    #[must_use]
    pub(crate) const fn is_contending(&self) -> bool {
        matches!(self.state, State::Contending(..))
    }

    /// Starts a sweep.
    ///
    /// # Panics
    /// If one is under way, or the payload of a broadcast is larger than a frame carries.
    pub fn start(&mut self, now: SimTime, purpose: SweepPurpose, access: Access, radio: &mut impl Radio) {
        assert!(!self.is_busy(), "a sweep is under way");
        if let SweepPurpose::Broadcast { payload_octets, .. } = purpose {
            assert!(payload_octets <= MAX_BEACON_PAYLOAD_OCTETS, "a payload of {payload_octets} octets");
        }
        self.answers.clear();
        let sweep = Sweep { purpose, frames: 0, retries: 0, asked: 0, reported: 0 };
        match access {
            Access::AtOnce => self.send(sweep, 0, now, radio),
            Access::Contend => {
                let category = self.settings.access_category();
                let backoff = Backoff::new(category, now, radio.slots(category.cw_min()));
                self.state = State::Contending(sweep, backoff);
                self.pursue(now, radio);
            }
        }
    }

    /// Takes back a sweep that waits for the channel: nothing of it was sent. Nothing happens if there is none.
    pub fn withdraw(&mut self, radio: &mut impl Radio) {
        if self.is_contending() {
            self.alarm.clear(radio);
            self.state = State::Idle;
        }
    }

    /// Frames that this machine has not seen claim the medium until then.
    pub fn is_claimed_until(&mut self, now: SimTime, until: SimTime) {
        self.defer(now, until);
    }

    /// A frame was decoded whose last bit arrives now, with the SINR `sinr`. A deaf radio decodes none: frames that come
    /// while this station transmits are ignored.
    pub fn receive(
        &mut self,
        now: SimTime,
        frame: &SweepFrame,
        sinr: Db,
        radio: &mut impl Radio,
    ) -> Option<InitiatorReport> {
        if self.is_transmitting() {
            return None;
        }
        if frame.to != self.address {
            self.overhear(now, frame);
            return None;
        }
        match (self.state, frame.body) {
            (State::Gathering(_, window) | State::AwaitingReport(_, window, _), SweepBody::Rss { .. }) => {
                self.hear(now, frame, sinr, window, radio)
            }
            (State::AwaitingReport(sweep, window, responder), SweepBody::Brp { .. }) if responder == frame.from => {
                self.alarm.clear(radio);
                self.watch(Sweep { reported: sweep.reported + 1, ..sweep }, window, now, radio)
            }
            (State::AwaitingAnswer(sweep, _), SweepBody::Rss { cdown, sector, feedback })
                if names(sweep, frame.from) =>
            {
                self.answers.hear(Answer::new(frame.from, sector, feedback, sinr));
                let until = sweep_end(now, cdown, frame.duration_us, Duration::ZERO) + MBIFS;
                self.alarm.set(now, until, Event::WaitExpired, radio);
                self.state = State::AwaitingAnswer(sweep, until);
                None
            }
            (State::AwaitingAck(sweep), SweepBody::Ack { .. }) if names(sweep, frame.from) => {
                self.alarm.clear(radio);
                Some(self.end(sweep, InitiatorOutcome::Trained))
            }
            _ => None,
        }
    }

    /// A frame for another station was decoded whose last bit arrives now.
    pub fn overhear(&mut self, now: SimTime, frame: &SweepFrame) {
        if !self.is_transmitting() {
            self.defer(now, now + frame.duration());
        }
    }

    /// Handles an event; returns the report if the sweep is over.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, now: SimTime, event: Event, radio: &mut impl Radio) -> Option<InitiatorReport> {
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
                self.pursue(now, radio);
                None
            }
            (State::Contending(..), Event::TransmitReady) => {
                self.pursue(now, radio);
                None
            }
            (State::Spacing(sweep, index), Event::TransmitReady) => {
                self.send(sweep, index, now, radio);
                None
            }
            (State::Sweeping(sweep, index), Event::TransmissionEnded) if index + 1 < self.layout.total() => {
                radio.enter(RadioState::Idle);
                self.alarm.set(now, now + self.layout.gap_after(index), Event::TransmitReady, radio);
                self.state = State::Spacing(sweep, index + 1);
                None
            }
            (State::Sweeping(sweep, _), Event::TransmissionEnded) => {
                radio.listen();
                self.expect_answers(sweep, now, radio)
            }
            (State::Gathering(sweep, window), Event::TransmitReady | Event::WaitExpired) => {
                self.watch(sweep, window, now, radio)
            }
            (State::Informing(sweep, window, responder), Event::TransmissionEnded) => {
                radio.listen();
                self.carrier.is_taken_until(now);
                self.expect_report(sweep, window, responder, now, radio)
            }
            // The report is lost.
            (State::AwaitingReport(sweep, window, _), Event::WaitExpired) => self.watch(sweep, window, now, radio),
            (State::AwaitingAnswer(sweep, until), Event::WaitExpired) => self.choose(sweep, until, now, radio),
            (State::Choosing(sweep), Event::TransmissionEnded) => {
                radio.listen();
                self.alarm.set(now, now + SSW_ACK_TIMEOUT, Event::WaitExpired, radio);
                self.state = State::AwaitingAck(sweep);
                None
            }
            (State::AwaitingAck(sweep), Event::WaitExpired) if sweep.retries < MAX_SLS_RETRIES => {
                self.train(Sweep { retries: sweep.retries + 1, ..sweep }, radio);
                None
            }
            (State::AwaitingAck(sweep), Event::WaitExpired) => Some(self.end(sweep, InitiatorOutcome::NoAck)),
            (state, event) => panic!("{event:?} cannot happen in {state:?}"),
        }
    }

    /// Whether a frame of this machine is on the air, so that it hears none.
    const fn is_transmitting(&self) -> bool {
        matches!(self.state, State::Sweeping(..) | State::Informing(..) | State::Choosing(_))
    }

    /// Goes on with a backoff, if there is one.
    fn pursue(&mut self, now: SimTime, radio: &mut impl Radio) {
        let State::Contending(sweep, backoff) = self.state else { return };
        match backoff.end(self.carrier) {
            None => {}
            Some(end) if end <= now && !self.alarm.is_set() => self.send(sweep, 0, now, radio),
            Some(end) => self.alarm.set(now, end.max(now), Event::TransmitReady, radio),
        }
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
    fn send(&mut self, sweep: Sweep, index: u16, now: SimTime, radio: &mut impl Radio) {
        let (sector, total_sectors) = (self.layout.sector(index), self.layout.total());
        let cdown = total_sectors - 1 - index;
        let ssw = |rx_antennas| SweepBody::Iss { cdown, sector, total_sectors, rx_antennas };
        let (to, body) = match sweep.purpose {
            SweepPurpose::Gather => (MacAddress::BROADCAST, ssw(1)),
            SweepPurpose::Train { responder, .. } => (responder, ssw(1)),
            SweepPurpose::Announce => (MacAddress::BROADCAST, ssw(0)),
            SweepPurpose::Broadcast { sequence, payload_octets } => {
                let timestamp_us = now.as_nanos() / 1000;
                (MacAddress::BROADCAST, SweepBody::Beacon { timestamp_us, cdown, sector, sequence, payload_octets })
            }
        };
        let frame = SweepFrame { duration_us: 0, to, from: self.address, body };
        let duration_us = duration_field(self.layout.remaining_after(index, frame.airtime()));
        radio.transmit(SweepFrame { duration_us, ..frame }, sector);
        self.state = State::Sweeping(Sweep { frames: sweep.frames + 1, ..sweep }, index);
    }

    /// The last frame of the sweep was sent.
    fn expect_answers(&mut self, sweep: Sweep, now: SimTime, radio: &mut impl Radio) -> Option<InitiatorReport> {
        match sweep.purpose {
            SweepPurpose::Gather => {
                let opens = now + MBIFS;
                self.watch(sweep, FeedbackWindow { opens, closes: opens + self.settings.window() }, now, radio)
            }
            SweepPurpose::Train { layout, .. } => {
                let until = now + MBIFS + layout.sweep_duration() + AIR_PROPAGATION * 2;
                self.alarm.set(now, until, Event::WaitExpired, radio);
                self.state = State::AwaitingAnswer(sweep, until);
                None
            }
            SweepPurpose::Announce | SweepPurpose::Broadcast { .. } => Some(self.end(sweep, InitiatorOutcome::Over)),
        }
    }

    /// The named station has answered, or has not.
    fn choose(
        &mut self,
        sweep: Sweep,
        until: SimTime,
        now: SimTime,
        radio: &mut impl Radio,
    ) -> Option<InitiatorReport> {
        if now < until {
            self.alarm.set(now, until, Event::WaitExpired, radio);
        } else if !self.answers().is_empty() {
            self.train(sweep, radio);
        } else if sweep.retries < MAX_SLS_RETRIES {
            self.send(Sweep { retries: sweep.retries + 1, ..sweep }, 0, now, radio);
        } else {
            return Some(self.end(sweep, InitiatorOutcome::NoAnswer));
        }
        None
    }

    /// Sends feedback to the named station.
    fn train(&mut self, sweep: Sweep, radio: &mut impl Radio) {
        let [answer] = *self.answers() else { unreachable!("one station is named, and it answered") };
        let taken = duration_field(MBIFS + SSW_FEEDBACK_AIRTIME);
        self.inform(answer, taken, BeamRefinement::default(), radio);
        self.state = State::Choosing(sweep);
    }

    /// Starts the feedback to an answer, on the sector that it named.
    fn inform(&self, answer: Answer, duration_us: u16, refinement: BeamRefinement, radio: &mut impl Radio) {
        let feedback = SectorFeedback {
            select: answer.responder_sector,
            snr: super::snr_report::SnrReport::of(answer.snr),
            poll_required: false,
        };
        let body = SweepBody::Feedback { feedback, refinement };
        let frame = SweepFrame { duration_us, to: answer.responder, from: self.address, body };
        radio.transmit(frame, answer.select);
    }

    fn end(&mut self, sweep: Sweep, outcome: InitiatorOutcome) -> InitiatorReport {
        self.state = State::Idle;
        let Sweep { purpose, frames, asked, reported, .. } = sweep;
        InitiatorReport { purpose, outcome, frames, asked, reported }
    }
}

fn names(sweep: Sweep, station: MacAddress) -> bool {
    matches!(sweep.purpose, SweepPurpose::Train { responder, .. } if responder == station)
}
