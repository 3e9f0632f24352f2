//! Unslotted CSMA-CA of IEEE 802.15.4 (2006, 7.5.1.4): the transmit side of a station's MAC.
//!
//! Goes in: a frame to send, then the events of timer and radio. Comes out: commands to the
//! [`Radio`], at the end a [`Report`]. The machine has no clock: at most one timer is pending
//! at any time, and [`Radio::after`] sets it.
//!
//! A station does not listen during its backoff and does not freeze its counter. Between the end
//! of an idle CCA and its first bit it is deaf for one turnaround: another station whose CCA ends
//! no later than that first bit transmits too, and the frames collide.

use std::time::Duration;

use crate::{Phy, RadioState};

pub mod analysis;
mod contention;
mod port;
pub(crate) mod sending;
mod settings;
#[cfg(test)]
mod tests;

pub use contention::Contention;
pub(crate) use port::Attempt;
pub use port::{Event, Outcome, OutgoingFrame, Radio, Report};
pub use settings::{CsmaConfig, CsmaSettings};

use sending::{Sending, SendingStep};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// Its receiver may still be on, from the assessment before.
    BackingOff(Attempt, Receiver),
    /// On the way from idle to receiving, before an assessment.
    WakingUp(Attempt),
    Sensing(Attempt),
    /// The channel is won.
    Sending(Attempt, Sending),
    /// Silent after a frame; then the waiting attempt, if any, contends.
    Spacing(Option<Attempt>),
}

/// The receiver of a station during its backoff.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Receiver {
    AtRest,
    StillOn,
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Csma {
    settings: CsmaSettings,
    phy: Phy,
    state: State,
}

impl Csma {
    /// An idle machine.
    #[must_use]
    pub const fn new(settings: CsmaSettings, phy: Phy) -> Self {
        Self { settings, phy, state: State::Idle }
    }

    /// Whether a frame is under way, so that [`Csma::start`] must wait for its [`Report`].
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle | State::Spacing(None))
    }

    /// Whether the assessment under way ends the frame if it finds the channel busy.
    #[must_use]
    #[inline]
    pub const fn gives_up_if_busy(&self) -> bool {
        matches!(self.state, State::Sensing(attempt) if attempt.busy >= self.settings.max_backoffs())
    }

    /// The state of the radio between commands, also before the first one.
    #[must_use]
    pub const fn resting_state(&self) -> RadioState {
        self.settings.resting_state()
    }

    /// Takes a frame to send. During the interframe spacing after the last frame, the new one waits.
    ///
    /// # Panics
    /// If a frame is under way.
    pub fn start(&mut self, frame: OutgoingFrame, radio: &mut impl Radio) {
        assert!(!self.is_busy(), "a frame is under way");
        let attempt = Attempt::new(frame);
        self.state = match self.state {
            State::Spacing(_) => State::Spacing(Some(attempt)),
            _ => self.contend(attempt, radio),
        };
    }

    /// Handles an event; returns the report if the event ended the frame. An acknowledgement that
    /// the machine does not wait for changes nothing.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, event: Event, radio: &mut impl Radio) -> Option<Report> {
        let (state, report) = match (self.state, event) {
            (State::BackingOff(attempt, Receiver::AtRest), Event::BackoffExpired)
                if self.settings.has_idle_turnarounds() =>
            {
                radio.enter(RadioState::Turnaround);
                radio.after(self.phy.turnaround(), Event::SenseReady);
                (State::WakingUp(attempt), None)
            }
            (State::BackingOff(attempt, _), Event::BackoffExpired)
            | (State::WakingUp(attempt), Event::SenseReady) => {
                radio.enter(RadioState::Receive);
                radio.start_cca();
                (State::Sensing(attempt.with_cca()), None)
            }
            (State::Sensing(attempt), Event::CcaEnded { busy: false }) => {
                (State::Sending(attempt, Sending::begin(self.phy, radio)), None)
            }
            (State::Sensing(attempt), Event::CcaEnded { busy: true }) => self.defer(attempt, radio),
            (State::Sending(attempt, sending), event) => match sending.handle(attempt, event, self.phy, radio) {
                SendingStep::On(attempt, sending) => (State::Sending(attempt, sending), None),
                SendingStep::Ended(attempt, outcome) => {
                    (self.space(attempt.frame, Duration::ZERO, None, radio), Some(attempt.report(outcome)))
                }
                SendingStep::Unanswered { attempt, waited } => self.retry(attempt, waited, radio),
            },
            (State::Spacing(None), Event::InterframeSpaceEnded) => (State::Idle, None),
            (State::Spacing(Some(attempt)), Event::InterframeSpaceEnded) => (self.contend(attempt, radio), None),
            (state, Event::AckReceived { .. }) => (state, None),
            (state, event) => panic!("{event:?} cannot happen in {state:?}"),
        };
        self.state = state;
        report
    }

    /// Starts an access to the channel from its beginning.
    fn contend(&self, attempt: Attempt, radio: &mut impl Radio) -> State {
        radio.enter(self.resting_state());
        let attempt = Attempt { busy: 0, exponent: self.settings.min_be(), ..attempt };
        let periods = radio.backoff_periods((1 << attempt.exponent) - 1);
        self.wait(attempt, periods, Receiver::AtRest, radio)
    }

    fn wait(&self, attempt: Attempt, periods: u32, receiver: Receiver, radio: &mut impl Radio) -> State {
        radio.after(self.phy.backoff_period() * periods, Event::BackoffExpired);
        State::BackingOff(attempt, receiver)
    }

    /// The channel was busy: starts a longer backoff, or gives up.
    fn defer(&self, attempt: Attempt, radio: &mut impl Radio) -> (State, Option<Report>) {
        let busy = attempt.busy + 1;
        if busy > self.settings.max_backoffs() {
            radio.enter(self.resting_state());
            return (State::Idle, Some(attempt.report(Outcome::ChannelAccessFailure)));
        }
        let exponent = (attempt.exponent + 1).min(self.settings.max_be());
        let attempt = Attempt { busy, exponent, ..attempt };
        let turns = self.settings.has_idle_turnarounds();
        if !turns {
            radio.enter(self.resting_state());
        }
        let periods = radio.backoff_periods((1 << exponent) - 1);
        // A radio that would have to turn around both ways stays on for a backoff of nothing.
        let receiver = if periods == 0 { Receiver::StillOn } else { Receiver::AtRest };
        if turns && periods > 0 {
            radio.enter(self.resting_state());
        }
        (self.wait(attempt, periods, receiver, radio), None)
    }

    /// The frame was not acknowledged, and the station has been silent for `waited` after it: contends again with the same
    /// sequence number, or gives up. The next frame keeps the spacing to this one (IEEE 802.15.4-2006, 7.5.1.3): with ASK at
    /// 868 MHz the wait for an acknowledgement has 38 symbols, and the spacing after a long frame 40.
    fn retry(&self, attempt: Attempt, waited: Duration, radio: &mut impl Radio) -> (State, Option<Report>) {
        if attempt.transmissions > u32::from(self.settings.max_retries()) {
            let state = self.space(attempt.frame, waited, None, radio);
            return (state, Some(attempt.report(Outcome::NoAck)));
        }
        (self.space(attempt.frame, waited, Some(attempt), radio), None)
    }

    /// Keeps silent for the rest of the interframe spacing, of which `waited` has passed; then `next` contends.
    fn space(&self, frame: OutgoingFrame, waited: Duration, next: Option<Attempt>, radio: &mut impl Radio) -> State {
        let left = self.phy.interframe_spacing(frame.mpdu_octets).saturating_sub(waited);
        if !left.is_zero() {
            radio.enter(self.resting_state());
            radio.after(left, Event::InterframeSpaceEnded);
            return State::Spacing(next);
        }
        match next {
            Some(attempt) => self.contend(attempt, radio),
            None => {
                radio.enter(self.resting_state());
                State::Idle
            }
        }
    }
}
