//! A station that sleeps and looks at the channel at each interval: what it does when it wakes up, and how it wakes others.
//!
//! At rest it sleeps, or listens if it is always on. From there it is called away by a check, in which it may receive a frame,
//! or by a frame to send. Then it goes back. Who has the clock says when a check is due; in a check in which nobody sends
//! nothing happens, so it need not take place at all.

mod hearing;

use std::time::Duration;

use sextant_kernel::SimTime;

use super::port::{Ended, Event, Job, Radio, Recipient, Sent};
use super::settings::{Check, Form, GUARD_SYMBOLS, SleepSettings};
use crate::energy::RadioState;

/// Where a station is as long as nothing calls it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rest {
    /// Asleep between its checks.
    Asleep,
    /// Its receiver is always on.
    Listening,
}

/// Why a station looks at the channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Why {
    /// It is its time to wake up.
    Check,
    /// It has a frame to send.
    Access,
}

/// One look of several, from zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Look {
    why: Why,
    number: u8,
}

/// What follows an acknowledgement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Then {
    Rest,
    AwaitData,
}

/// What a station does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Resting,
    /// Turning the receiver on for a look.
    TurningOn(Look),
    Looking(Look),
    /// Asleep until the next look.
    Pausing(Look),
    /// The receiver is on: somebody may send to it.
    Hearing,
    /// Asleep until shortly before the frame that was announced, which may come so much later.
    AwaitingRendezvous(Duration),
    /// Turning the receiver on for that frame.
    TurningToData(Duration),
    AwaitingData,
    /// Turning around to send something, or sending it.
    Starting(Sent, Then),
    OnAir(Sent, Then),
    /// Turning around to wait for an acknowledgement.
    TurningBack(Sent),
    AwaitingAcknowledgement(Sent),
    /// Turning the receiver on again, which is on at rest.
    Returning,
}

/// A frame under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Attempt {
    job: Job,
    /// When the first of what wakes the receiver began.
    first: Option<SimTime>,
}

/// A station that sleeps.
#[derive(Clone, Copy, Debug)]
pub struct Sleeper {
    settings: SleepSettings,
    rest: Rest,
    state: State,
    attempt: Option<Attempt>,
}

impl Sleeper {
    /// A station at rest.
    #[must_use]
    pub fn new(settings: SleepSettings, rest: Rest) -> Self {
        Self { settings, rest, state: State::Resting, attempt: None }
    }

    /// Where it is as long as nothing calls it.
    #[must_use]
    pub fn rest(&self) -> Rest {
        self.rest
    }

    /// Whether nothing has called it away: it can check the channel, or send.
    #[must_use]
    #[inline]
    pub fn is_free(&self) -> bool {
        self.state == State::Resting
    }

    /// Whether a signal keeps it, or a frame that was announced.
    #[must_use]
    #[inline]
    pub fn is_receiving(&self) -> bool {
        use State::{AwaitingData, AwaitingRendezvous, Hearing, TurningToData};
        matches!(self.state, Hearing | AwaitingRendezvous(_) | TurningToData(_) | AwaitingData)
    }

    /// Whether it sleeps between two checks.
    #[must_use]
    #[inline]
    pub fn is_asleep(&self) -> bool {
        self.state == State::Resting && self.rest == Rest::Asleep
    }

    fn turnaround(&self) -> Duration {
        self.settings.phy().turnaround()
    }

    fn look_length(&self) -> Duration {
        self.settings.phy().cca()
    }

    /// A check goes on that began `elapsed` ago, and in which nothing has happened so far.
    pub fn check(&mut self, elapsed: Duration, radio: &mut impl Radio) {
        let (turnaround, look) = (self.turnaround(), self.look_length());
        let first = Look { why: Why::Check, number: 0 };
        if elapsed < turnaround {
            return self.turn_on(first, turnaround - elapsed, radio);
        }
        let since_on = elapsed - turnaround;
        match self.settings.check() {
            Check::Window(window) => self.hear(window.saturating_sub(since_on), radio),
            Check::Looks(_) if since_on < look => self.look(first, look - since_on, radio),
            Check::Looks(distance) => {
                let second = Look { number: 1, ..first };
                if elapsed < distance {
                    self.pause(second, distance - elapsed, radio);
                } else if since_on < distance {
                    self.turn_on(second, distance - since_on, radio);
                } else {
                    self.look(second, (distance + look).saturating_sub(since_on), radio);
                }
            }
        }
    }

    /// It has a frame to send.
    pub fn send(&mut self, job: Job, radio: &mut impl Radio) {
        self.attempt = Some(Attempt { job, first: None });
        let look = Look { why: Why::Access, number: 0 };
        match self.rest {
            Rest::Asleep => self.turn_on(look, self.turnaround(), radio),
            Rest::Listening => self.look(look, self.look_length(), radio),
        }
    }

    fn turn_on(&mut self, look: Look, span: Duration, radio: &mut impl Radio) {
        self.state = State::TurningOn(look);
        radio.enter(RadioState::Turnaround);
        radio.after(span, Event::ReceiverOn);
    }

    fn look(&mut self, look: Look, span: Duration, radio: &mut impl Radio) {
        self.state = State::Looking(look);
        radio.enter(RadioState::Receive);
        radio.after(span, Event::LookOver);
    }

    fn pause(&mut self, look: Look, span: Duration, radio: &mut impl Radio) {
        self.state = State::Pausing(look);
        if self.rest == Rest::Asleep {
            radio.enter(RadioState::Sleep);
        }
        radio.after(span, Event::SleepOver);
    }

    fn hear(&mut self, span: Duration, radio: &mut impl Radio) {
        self.state = State::Hearing;
        radio.enter(RadioState::Receive);
        radio.after(span, Event::WaitOver);
    }

    /// Goes to rest with the receiver on.
    fn go_to_rest(&mut self, radio: &mut impl Radio) {
        self.state = State::Resting;
        radio.stop();
        radio.enter(match self.rest {
            Rest::Asleep => RadioState::Sleep,
            Rest::Listening => RadioState::Receive,
        });
    }

    /// Goes to rest after it has sent something.
    fn return_to_rest(&mut self, radio: &mut impl Radio) {
        match self.rest {
            Rest::Asleep => self.go_to_rest(radio),
            Rest::Listening => {
                self.state = State::Returning;
                radio.enter(RadioState::Turnaround);
                radio.after(self.turnaround(), Event::ReceiverOn);
            }
        }
    }

    /// Turns around to send something.
    fn start(&mut self, sent: Sent, then: Then, radio: &mut impl Radio) {
        self.state = State::Starting(sent, then);
        radio.enter(RadioState::Turnaround);
        radio.after(self.turnaround(), Event::FrameStarts);
    }

    /// The frame under way has ended.
    fn end(&mut self, ended: Ended) -> Option<Ended> {
        self.attempt = None;
        Some(ended)
    }

    /// Handles an event.
    ///
    /// # Panics
    /// If it did not wait for it.
    pub fn handle(&mut self, event: Event, now: SimTime, radio: &mut impl Radio) -> Option<Ended> {
        match (self.state, event) {
            (State::TurningOn(look), Event::ReceiverOn) => match (look.why, self.settings.check()) {
                (Why::Check, Check::Window(window)) => self.hear(window, radio),
                _ => self.look(look, self.look_length(), radio),
            },
            (State::Looking(look), Event::LookOver) => return self.end_look(look, radio),
            (State::Pausing(look), Event::SleepOver) => match self.rest {
                Rest::Asleep => self.turn_on(look, self.turnaround(), radio),
                Rest::Listening => self.look(look, self.look_length(), radio),
            },
            (State::Hearing | State::AwaitingData, Event::WaitOver) => match radio.followed_for() {
                Some(span) => radio.after(span, Event::WaitOver),
                None => self.go_to_rest(radio),
            },
            (State::AwaitingRendezvous(later), Event::SleepOver) => self.turn_to_data(later, radio),
            (State::TurningToData(later), Event::ReceiverOn) => self.await_data(later + self.data_wait(), radio),
            (State::Starting(sent, then), Event::FrameStarts) => {
                let airtime = radio.begin(sent);
                radio.enter(RadioState::Transmit);
                radio.after(airtime, Event::FrameEnded);
                self.state = State::OnAir(sent, then);
                if let Some(attempt) = self.attempt.as_mut().filter(|_| sent != Sent::Acknowledgement) {
                    attempt.first.get_or_insert(now);
                }
            }
            (State::OnAir(sent, then), Event::FrameEnded) => return self.end_frame(sent, then, now, radio),
            (State::TurningBack(sent), Event::ReceiverOn) => {
                self.state = State::AwaitingAcknowledgement(sent);
                radio.enter(RadioState::Receive);
                radio.after(self.acknowledgement_wait(sent), Event::WaitOver);
            }
            (State::AwaitingAcknowledgement(sent), Event::WaitOver) => return self.miss(sent, now, radio),
            (State::Returning, Event::ReceiverOn) => self.go_to_rest(radio),
            (state, event) => unreachable!("{event:?} while {state:?}"),
        }
        None
    }

    fn end_look(&mut self, look: Look, radio: &mut impl Radio) -> Option<Ended> {
        let Look { why, number } = look;
        match (why, radio.is_busy()) {
            (Why::Check, true) => self.hear(self.settings.patience(), radio),
            (Why::Access, true) => {
                self.go_to_rest(radio);
                return self.end(Ended::Busy);
            }
            (_, false) if number + 1 < self.settings.looks() => {
                let asleep = match self.rest {
                    Rest::Asleep => self.turnaround(),
                    Rest::Listening => Duration::ZERO,
                };
                let span = self.settings.distance().saturating_sub(self.look_length() + asleep);
                self.pause(Look { why, number: number + 1 }, span, radio);
            }
            (Why::Check, false) => self.go_to_rest(radio),
            (Why::Access, false) => {
                let first = self.wake_up(SimTime::ZERO);
                self.start(first, Then::Rest, radio);
            }
        }
        None
    }

    /// What wakes the receiver if it begins at `start`.
    fn wake_up(&self, start: SimTime) -> Sent {
        match (self.settings.form, self.attempt) {
            (Form::XMac, _) => Sent::Strobe,
            // A receiver that is always on is not woken.
            (Form::Csl, Some(Attempt { job, first: None })) if job.span.is_zero() => Sent::Data,
            (Form::Csl, Some(Attempt { job, first })) => {
                // Enough of them that the last one begins when the span is over.
                let airtime = self.settings.strobe_airtime(job.airtime);
                let gone = first.map_or(Duration::ZERO, |first| start.saturating_since(first));
                let number = |span: Duration| span.as_nanos().div_ceil(airtime.as_nanos().max(1));
                let (all, sent) = (number(job.span), number(gone));
                let left = u32::try_from(all.saturating_sub(sent)).unwrap_or(u32::MAX);
                Sent::WakeUp { rendezvous: airtime * left }
            }
            _ => Sent::Data,
        }
    }

    fn end_frame(&mut self, sent: Sent, then: Then, now: SimTime, radio: &mut impl Radio) -> Option<Ended> {
        let recipient = self.attempt.map_or(Recipient::One, |attempt| attempt.job.to);
        match (sent, then, recipient) {
            (Sent::Acknowledgement, Then::Rest, _) => self.return_to_rest(radio),
            (Sent::Acknowledgement, Then::AwaitData, _) => self.turn_to_data(Duration::ZERO, radio),
            (Sent::WakeUp { rendezvous }, ..) => {
                // The transmitter stays on.
                let next = if rendezvous.is_zero() { Sent::Data } else { self.wake_up(now) };
                self.state = State::Starting(next, Then::Rest);
                radio.after(Duration::ZERO, Event::FrameStarts);
            }
            (Sent::Data, _, Recipient::All) if self.settings.form != Form::RepeatedData => {
                self.return_to_rest(radio);
                return self.end(Ended::Sent);
            }
            _ => {
                self.state = State::TurningBack(sent);
                radio.enter(RadioState::Turnaround);
                radio.after(self.turnaround(), Event::ReceiverOn);
            }
        }
        None
    }

    /// How long the receiver waits for an acknowledgement.
    fn acknowledgement_wait(&self, sent: Sent) -> Duration {
        match (sent, self.settings.form) {
            (Sent::Data, Form::XMac | Form::Csl) => self.settings.phy().ack_wait().saturating_sub(self.turnaround()),
            _ => self.settings.gap().saturating_sub(self.turnaround() * 2),
        }
    }

    /// No acknowledgement of what it sent came so far.
    fn miss(&mut self, sent: Sent, now: SimTime, radio: &mut impl Radio) -> Option<Ended> {
        let form = self.settings.form;
        if sent == Sent::Data && form != Form::RepeatedData {
            self.go_to_rest(radio);
            return self.end(Ended::Unacknowledged);
        }
        // An acknowledgement whose first symbol has come is heard to its end; that of a strobe would be over.
        if sent == Sent::Data
            && let Some(span) = radio.followed_for()
        {
            radio.after(span, Event::WaitOver);
            return None;
        }
        let Some(Attempt { job, first: Some(first) }) = self.attempt else { unreachable!("it has sent something") };
        let next = now + self.turnaround();
        if next.saturating_since(first) <= job.span {
            self.start(sent, Then::Rest, radio);
            return None;
        }
        match (job.to, form) {
            // Those that have heard a strobe wait for the frame.
            (Recipient::All, Form::XMac) => {
                self.start(Sent::Data, Then::Rest, radio);
                None
            }
            (Recipient::All, _) => {
                self.go_to_rest(radio);
                self.end(Ended::Sent)
            }
            (Recipient::One, _) => {
                self.go_to_rest(radio);
                self.end(Ended::Unacknowledged)
            }
        }
    }

    /// How long it waits for the start of a frame that is due.
    fn data_wait(&self) -> Duration {
        self.settings.phy().symbols(2 * GUARD_SYMBOLS)
    }

    fn turn_to_data(&mut self, later: Duration, radio: &mut impl Radio) {
        self.state = State::TurningToData(later);
        radio.enter(RadioState::Turnaround);
        radio.after(self.turnaround(), Event::ReceiverOn);
    }

    fn await_data(&mut self, span: Duration, radio: &mut impl Radio) {
        self.state = State::AwaitingData;
        radio.enter(RadioState::Receive);
        radio.after(span, Event::WaitOver);
    }

    /// It does nothing any more; its timer is to be cancelled.
    pub fn turn_off(&mut self) {
        (self.rest, self.state, self.attempt) = (Rest::Asleep, State::Resting, None);
    }
}
