//! Slotted CSMA-CA of IEEE 802.15.4 (2006, 7.5.1.4) and transmission in guaranteed slots (7.5.7.3): the transmit side
//! of a device in a beacon-enabled PAN.
//!
//! Goes in: a frame to send, the window in which the device may send, then the events of timer and radio. Comes
//! out: commands to the same [`Radio`] that unslotted CSMA-CA has, at the end a [`Report`]. Backoffs, CCAs and frames
//! start on boundaries, whole backoff periods after the start of the beacon. Two CCAs on successive boundaries must
//! find the channel idle: acknowledgements start on boundaries too, so the gap before one never contains both CCAs. A
//! frame that does not fit into a window waits for the next one.

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::csma::sending::{Sending, SendingStep};
use crate::csma::{Attempt, CsmaSettings, Event, Outcome, OutgoingFrame, Radio, Report};
use crate::superframe::Contention;
use crate::{Phy, RadioState};

#[cfg(test)]
mod tests;

/// Idle CCAs before a frame (CW0 of the standard).
const CONTENTION_WINDOW: u8 = 2;
/// Largest first backoff exponent with battery life extension.
const SAVING_MIN_BE: u8 = 2;

/// When a device may send.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AccessWindow {
    /// In a contention access period.
    Contention(Contention),
    /// In a guaranteed slot, without carrier sense.
    Guaranteed {
        /// When the slot ends.
        end: SimTime,
    },
}

impl AccessWindow {
    const fn end(&self) -> SimTime {
        match self {
            Self::Contention(contention) => contention.end(),
            Self::Guaranteed { end } => *end,
        }
    }
}

/// How a frame continues when the next window opens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Resume {
    /// It starts a channel access.
    Access,
    /// It draws a new backoff: the last one is over, but the CCAs and the frame did not fit.
    Draw,
    /// It waits for the remaining backoff periods.
    Count(u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    /// No window is open, or the rest of it is too short.
    Deferred(Attempt, Resume),
    /// Waiting for the boundary at which a CCA starts; this many CCAs must find the channel idle.
    BackingOff(Attempt, u8),
    Sensing(Attempt, u8),
    /// The channel is won, or the slot is guaranteed.
    Sending(Attempt, Sending),
    /// Silent after a frame; then the waiting attempt, if any, starts a channel access.
    Spacing(Option<Attempt>),
}

/// The state machine.
#[derive(Clone, Debug)]
pub struct SlottedCsma {
    settings: CsmaSettings,
    phy: Phy,
    window: Option<AccessWindow>,
    state: State,
}

impl SlottedCsma {
    /// An idle machine without a window.
    #[must_use]
    pub const fn new(settings: CsmaSettings, phy: Phy) -> Self {
        Self { settings, phy, window: None, state: State::Idle }
    }

    /// Whether a frame is under way, so that [`SlottedCsma::start`] must wait for its [`Report`].
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle | State::Spacing(None))
    }

    /// Whether the radio is in use: it senses, transmits, or waits for an acknowledgement.
    #[must_use]
    pub const fn is_on_air(&self) -> bool {
        !matches!(
            self.state,
            State::Idle | State::Spacing(_) | State::Deferred(..) | State::BackingOff(_, CONTENTION_WINDOW)
        )
    }

    /// The state of the radio between commands in the active part of a superframe.
    #[must_use]
    pub const fn resting_state(&self) -> RadioState {
        self.settings.resting_state()
    }

    /// Takes a frame to send. It waits outside windows and during the interframe spacing after the last frame.
    ///
    /// # Panics
    /// If a frame is under way.
    pub fn start(&mut self, now: SimTime, frame: OutgoingFrame, radio: &mut impl Radio) {
        assert!(!self.is_busy(), "a frame is under way");
        let attempt = Attempt::new(frame);
        self.state = match self.state {
            State::Spacing(_) => State::Spacing(Some(attempt)),
            _ => self.access(now, attempt, radio),
        };
    }

    /// A window opens now; a waiting frame continues. A guaranteed slot must be opened one turnaround before it
    /// starts, so that the first bit is sent at its start.
    pub fn open(&mut self, now: SimTime, window: AccessWindow, radio: &mut impl Radio) {
        self.window = Some(window);
        let State::Deferred(attempt, resume) = self.state else { return };
        self.state = match (window, resume) {
            (AccessWindow::Contention(contention), Resume::Draw) => self.back_off(now, contention, attempt, radio),
            (AccessWindow::Contention(contention), Resume::Count(periods)) => {
                self.count(now, contention, attempt, periods, radio)
            }
            _ => self.access(now, attempt, radio),
        };
    }

    /// Handles an event; returns the report if the event ended the frame. An acknowledgement that the machine does
    /// not wait for changes nothing.
    ///
    /// # Panics
    /// If the event is impossible in the current state: the machine did not ask for it.
    pub fn handle(&mut self, now: SimTime, event: Event, radio: &mut impl Radio) -> Option<Report> {
        let (state, report) = match (self.state, event) {
            (State::BackingOff(attempt, left), Event::BackoffExpired) => {
                radio.enter(RadioState::Receive);
                radio.start_cca();
                (State::Sensing(attempt.with_cca(), left), None)
            }
            (State::Sensing(attempt, 1), Event::CcaEnded { busy: false }) => {
                // A CCA and a turnaround are one backoff period: the first bit is sent on a boundary.
                (State::Sending(attempt, Sending::begin(self.phy, radio)), None)
            }
            (State::Sensing(attempt, left), Event::CcaEnded { busy: false }) => {
                radio.after(self.phy.backoff_period() - self.phy.cca(), Event::BackoffExpired);
                (State::BackingOff(attempt, left - 1), None)
            }
            (State::Sensing(attempt, _), Event::CcaEnded { busy: true }) => self.defer(now, attempt, radio),
            (State::Sending(mut attempt, sending), event) => {
                match sending.handle(&mut attempt, event, self.phy, radio) {
                    SendingStep::On(sending) => (State::Sending(attempt, sending), None),
                    SendingStep::Ended(outcome) => (self.space(attempt.frame, radio), Some(attempt.report(outcome))),
                    SendingStep::Unanswered { waited } => self.retry(now, attempt, waited, radio),
                }
            }
            (State::Spacing(None), Event::InterframeSpaceEnded) => (State::Idle, None),
            (State::Spacing(Some(attempt)), Event::InterframeSpaceEnded) => (self.access(now, attempt, radio), None),
            (state, Event::AckReceived { .. }) => (state, None),
            (state, event) => panic!("{event:?} cannot happen in {state:?}"),
        };
        self.state = state;
        report
    }

    /// Starts an access to the channel from its beginning.
    fn access(&self, now: SimTime, attempt: Attempt, radio: &mut impl Radio) -> State {
        match self.window {
            Some(window) if window.end() <= now => State::Deferred(attempt, Resume::Access),
            None => State::Deferred(attempt, Resume::Access),
            Some(AccessWindow::Guaranteed { end }) => self.seize(now, end, attempt, radio),
            Some(AccessWindow::Contention(contention)) => {
                let min_be = self.settings.min_be();
                let exponent = if contention.is_battery_saving() { min_be.min(SAVING_MIN_BE) } else { min_be };
                self.back_off(now, contention, Attempt { busy: 0, exponent, ..attempt }, radio)
            }
        }
    }

    /// Transmits in a guaranteed slot if frame, acknowledgement and spacing end within it.
    fn seize(&self, now: SimTime, slot_end: SimTime, attempt: Attempt, radio: &mut impl Radio) -> State {
        let OutgoingFrame { mpdu_octets, ack_request, .. } = attempt.frame;
        let end = now + self.phy.turnaround() + guaranteed_span(self.phy, mpdu_octets, ack_request);
        if end > slot_end {
            return State::Deferred(attempt, Resume::Access);
        }
        State::Sending(attempt, Sending::begin(self.phy, radio))
    }

    fn back_off(&self, now: SimTime, contention: Contention, attempt: Attempt, radio: &mut impl Radio) -> State {
        let periods = radio.backoff_periods((1 << attempt.exponent) - 1);
        self.count(now, contention, attempt, periods, radio)
    }

    /// Waits for this many backoff periods from the next boundary on, as far as they are in this window; then, if the
    /// CCAs and the frame fit too, for the boundary at which the first CCA starts.
    fn count(
        &self,
        now: SimTime,
        contention: Contention,
        attempt: Attempt,
        periods: u32,
        radio: &mut impl Radio,
    ) -> State {
        let boundary = contention.boundary(now);
        let countable = contention.countable(boundary);
        if periods > countable {
            return State::Deferred(attempt, Resume::Count(periods - countable));
        }
        let cca = boundary + self.phy.backoff_period() * periods;
        if !contention.fits(cca, attempt.frame.mpdu_octets, attempt.frame.ack_request) {
            return State::Deferred(attempt, Resume::Draw);
        }
        radio.after(cca - now, Event::BackoffExpired);
        State::BackingOff(attempt, CONTENTION_WINDOW)
    }

    /// The channel was busy: starts a longer backoff, or gives up.
    fn defer(&self, now: SimTime, attempt: Attempt, radio: &mut impl Radio) -> (State, Option<Report>) {
        radio.enter(self.resting_state());
        let busy = attempt.busy + 1;
        if busy > self.settings.max_backoffs() {
            return (State::Idle, Some(attempt.report(Outcome::ChannelAccessFailure)));
        }
        let exponent = (attempt.exponent + 1).min(self.settings.max_be());
        let attempt = Attempt { busy, exponent, ..attempt };
        match self.window {
            Some(AccessWindow::Contention(contention)) => (self.back_off(now, contention, attempt, radio), None),
            _ => unreachable!("the channel is sensed in contention only"),
        }
    }

    /// No acknowledgement came: starts again with the same sequence number, or gives up.
    fn retry(
        &self,
        now: SimTime,
        attempt: Attempt,
        waited: Duration,
        radio: &mut impl Radio,
    ) -> (State, Option<Report>) {
        radio.enter(self.resting_state());
        let is_last = attempt.transmissions > u32::from(self.settings.max_retries());
        let left = self.phy.interframe_spacing(attempt.frame.mpdu_octets).saturating_sub(waited);
        let next = (!is_last).then_some(attempt);
        let state = match next {
            _ if !left.is_zero() => self.keep_silent(left, next, radio),
            Some(attempt) => self.access(now, attempt, radio),
            None => State::Idle,
        };
        (state, is_last.then(|| attempt.report(Outcome::NoAck)))
    }

    /// After the end of the frame: keeps silent for the interframe spacing.
    fn space(&self, frame: OutgoingFrame, radio: &mut impl Radio) -> State {
        radio.enter(self.resting_state());
        self.keep_silent(self.phy.interframe_spacing(frame.mpdu_octets), None, radio)
    }

    fn keep_silent(&self, span: Duration, next: Option<Attempt>, radio: &mut impl Radio) -> State {
        radio.after(span, Event::InterframeSpaceEnded);
        State::Spacing(next)
    }
}

/// Time that a frame needs in a guaranteed slot: the frame, its acknowledgement if requested, and the spacing.
#[must_use]
pub(crate) fn guaranteed_span(phy: Phy, mpdu_octets: u8, ack_request: bool) -> Duration {
    let ack = if ack_request { phy.turnaround() + phy.ack_airtime() } else { Duration::ZERO };
    phy.airtime(mpdu_octets) + ack + phy.interframe_spacing(mpdu_octets)
}
