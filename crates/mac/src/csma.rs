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
    BackingOff(Receiver),
    /// On the way from idle to receiving, before an assessment.
    WakingUp,
    Sensing,
    /// The channel is won.
    Sending(Sending),
    /// Silent after a frame.
    Spacing(Next),
}

/// The receiver of a station during its backoff.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Receiver {
    AtRest,
    StillOn,
}

/// What follows the silence after a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    Nothing,
    /// The attempt contends.
    Contention,
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct Csma {
    settings: CsmaSettings,
    phy: Phy,
    state: State,
    /// The frame under way, or the last one. It is beside the state, because moving it with each state cost saturated networks
    /// time.
    attempt: Attempt,
}

impl Csma {
    /// An idle machine.
    #[must_use]
    pub const fn new(settings: CsmaSettings, phy: Phy) -> Self {
        let none = OutgoingFrame { mpdu_octets: 0, ack_request: false, sequence: 0 };
        Self { settings, phy, state: State::Idle, attempt: Attempt::new(none) }
    }

    /// Whether a frame is under way, so that [`Csma::start`] must wait for its [`Report`].
    #[must_use]
    #[inline]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle | State::Spacing(Next::Nothing))
    }

    /// Whether a frame was sent whose acknowledgement has not come yet.
    #[must_use]
    #[inline]
    pub const fn awaits_acknowledgement(&self) -> bool {
        matches!(self.state, State::Sending(Sending::AwaitingAck))
    }

    /// Whether the assessment under way ends the frame if it finds the channel busy.
    #[must_use]
    #[inline]
    pub const fn gives_up_if_busy(&self) -> bool {
        matches!(self.state, State::Sensing) && self.attempt.busy >= self.settings.max_backoffs()
    }

    /// The state of the radio between commands for a frame.
    #[must_use]
    #[inline]
    pub const fn resting_state(&self) -> RadioState {
        self.settings.resting_state()
    }

    /// Takes a frame to send. During the interframe spacing after the last frame, the new one waits.
    ///
    /// # Panics
    /// If a frame is under way.
    #[inline]
    pub fn start(&mut self, frame: OutgoingFrame, radio: &mut impl Radio) {
        assert!(!self.is_busy(), "a frame is under way");
        self.attempt = Attempt::new(frame);
        match self.state {
            State::Spacing(_) => self.state = State::Spacing(Next::Contention),
            _ => self.contend(radio),
        }
    }

    /// Handles an event; returns the report if the event ended the frame. An acknowledgement that
    /// the machine does not wait for changes nothing.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, event: Event, radio: &mut impl Radio) -> Option<Report> {
        match (self.state, event) {
            (State::BackingOff(Receiver::AtRest), Event::BackoffExpired) if self.settings.has_idle_turnarounds() => {
                radio.enter(RadioState::Turnaround);
                radio.after(self.phy.turnaround(), Event::SenseReady);
                self.state = State::WakingUp;
                None
            }
            (State::BackingOff(_), Event::BackoffExpired) | (State::WakingUp, Event::SenseReady) => {
                radio.enter(RadioState::Receive);
                radio.start_cca();
                self.attempt.ccas += 1;
                self.state = State::Sensing;
                None
            }
            (State::Sensing, Event::CcaEnded { busy: false }) => {
                self.state = State::Sending(Sending::begin(self.phy, radio));
                None
            }
            (State::Sensing, Event::CcaEnded { busy: true }) => self.defer(radio),
            (State::Sending(sending), event) => match sending.handle(&mut self.attempt, event, self.phy, radio) {
                SendingStep::On(sending) => {
                    self.state = State::Sending(sending);
                    None
                }
                SendingStep::Ended(outcome) => {
                    self.space(Duration::ZERO, Next::Nothing, radio);
                    Some(self.attempt.report(outcome))
                }
                SendingStep::Unanswered { waited } => self.retry(waited, radio),
            },
            (State::Spacing(Next::Nothing), Event::InterframeSpaceEnded) => {
                if self.settings.state_without_frame() != self.resting_state() {
                    radio.enter(self.settings.state_without_frame());
                }
                self.state = State::Idle;
                None
            }
            (State::Spacing(Next::Contention), Event::InterframeSpaceEnded) => {
                self.contend(radio);
                None
            }
            (_, Event::AckReceived { .. }) => None,
            (state, event) => panic!("{event:?} cannot happen in {state:?}"),
        }
    }

    /// Starts an access to the channel from its beginning.
    fn contend(&mut self, radio: &mut impl Radio) {
        radio.enter(self.resting_state());
        self.attempt.busy = 0;
        self.attempt.exponent = self.settings.min_be();
        let periods = radio.backoff_periods((1 << self.attempt.exponent) - 1);
        self.wait(periods, Receiver::AtRest, radio);
    }

    fn wait(&mut self, periods: u32, receiver: Receiver, radio: &mut impl Radio) {
        radio.after(self.phy.backoff_period() * periods, Event::BackoffExpired);
        self.state = State::BackingOff(receiver);
    }

    /// The channel was busy: starts a longer backoff, or gives up.
    fn defer(&mut self, radio: &mut impl Radio) -> Option<Report> {
        self.attempt.busy += 1;
        if self.attempt.busy > self.settings.max_backoffs() {
            radio.enter(self.settings.state_without_frame());
            self.state = State::Idle;
            return Some(self.attempt.report(Outcome::ChannelAccessFailure));
        }
        self.attempt.exponent = (self.attempt.exponent + 1).min(self.settings.max_be());
        let turns = self.settings.has_idle_turnarounds();
        if !turns {
            radio.enter(self.resting_state());
        }
        let periods = radio.backoff_periods((1 << self.attempt.exponent) - 1);
        // A radio that would have to turn around both ways stays on for a backoff of nothing.
        let receiver = if periods == 0 { Receiver::StillOn } else { Receiver::AtRest };
        if turns && periods > 0 {
            radio.enter(self.resting_state());
        }
        self.wait(periods, receiver, radio);
        None
    }

    /// The frame was not acknowledged, and the station has been silent for `waited` after it: contends again with the same
    /// sequence number, or gives up. The next frame keeps the spacing to this one (IEEE 802.15.4-2006, 7.5.1.3): with ASK at
    /// 868 MHz the wait for an acknowledgement has 38 symbols, and the spacing after a long frame 40.
    fn retry(&mut self, waited: Duration, radio: &mut impl Radio) -> Option<Report> {
        if self.attempt.transmissions > u32::from(self.settings.max_retries()) {
            self.space(waited, Next::Nothing, radio);
            return Some(self.attempt.report(Outcome::NoAck));
        }
        self.space(waited, Next::Contention, radio);
        None
    }

    /// Keeps silent for the rest of the interframe spacing, of which `waited` has passed; then comes `next`.
    fn space(&mut self, waited: Duration, next: Next, radio: &mut impl Radio) {
        let left = self.phy.interframe_spacing(self.attempt.frame.mpdu_octets).saturating_sub(waited);
        if !left.is_zero() {
            radio.enter(self.resting_state());
            radio.after(left, Event::InterframeSpaceEnded);
            self.state = State::Spacing(next);
            return;
        }
        match next {
            Next::Contention => self.contend(radio),
            Next::Nothing => {
                radio.enter(self.settings.state_without_frame());
                self.state = State::Idle;
            }
        }
    }
}
