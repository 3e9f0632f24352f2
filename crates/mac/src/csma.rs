//! Unslotted CSMA-CA of IEEE 802.15.4 (2006, 7.5.1.4): the transmit side of a station's MAC.
//!
//! Goes in: a frame to send, then what happened to timers and radio. Comes out: commands to the
//! [`Radio`], at the end a [`Report`]. The machine owns no clock: at most one timer is pending
//! at any time, and [`Radio::after`] sets it.
//!
//! A station does not listen during its backoff and does not freeze its counter. Between the end
//! of an idle CCA and its first bit it is deaf for one turnaround: another station whose CCA ends
//! no later than that first bit transmits too, and the frames collide.

use std::time::Duration;

use crate::{Class, Phy, RadioState};

mod settings;
#[cfg(test)]
mod tests;

pub use settings::{CsmaConfig, CsmaSettings};

/// A frame to send, as far as channel access cares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutgoingFrame {
    /// Size of the MPDU [octets], FCS included: 5 to 127.
    pub mpdu_octets: u8,
    /// Whether the frame asks for an acknowledgement. A broadcast must not.
    pub ack_request: bool,
    /// Sequence number of the frame: its acknowledgement carries the same.
    pub sequence: u8,
}

/// What happened.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The backoff is over: the CCA starts now.
    BackoffExpired,
    /// The CCA that [`Radio::start_cca`] started is over.
    CcaEnded {
        /// Whether the channel was busy.
        busy: bool,
    },
    /// The turnaround to transmitting is over: the first bit goes out now.
    TransmitReady,
    /// The last bit of the own frame is out.
    TransmissionEnded,
    /// The turnaround to receiving is over: from now on an acknowledgement can be heard.
    ReceiveReady,
    /// The last bit of an acknowledgement was received, whoever it was meant for.
    AckReceived {
        /// Its sequence number.
        sequence: u8,
    },
    /// No acknowledgement came in time.
    AckWaitExpired,
    /// The silence owed after a frame is over.
    InterframeSpaceEnded,
}

impl Event {
    /// Where the event stands among those of the same instant.
    #[must_use]
    pub const fn class(self) -> Class {
        match self {
            Self::TransmissionEnded | Self::AckReceived { .. } | Self::ReceiveReady => Class::EndOfSignal,
            Self::CcaEnded { .. } => Class::EndOfCca,
            Self::TransmitReady => Class::StartOfSignal,
            Self::BackoffExpired => Class::StartOfCca,
            Self::AckWaitExpired | Self::InterframeSpaceEnded => Class::Timer,
        }
    }
}

/// All that the machine knows of the world.
pub trait Radio {
    /// A number drawn uniformly from `0..=max_inclusive`: backoff periods to wait.
    fn backoff_periods(&mut self, max_inclusive: u32) -> u32;

    /// Sets the timer: `event` is due `span` from now, by [`Event::class`] among its instant.
    /// `span` may be zero. Never called while the timer is pending.
    fn after(&mut self, span: Duration, event: Event);

    /// Takes the pending timer back.
    fn cancel_timer(&mut self);

    /// The radio changes its state now; called whenever the state changes, and before
    /// [`Radio::start_cca`] and [`Radio::start_transmission`]. In [`RadioState::Turnaround`] and
    /// [`RadioState::Transmit`] it is deaf.
    fn enter(&mut self, state: RadioState);

    /// Starts to sense the channel; [`Event::CcaEnded`] is due [`Phy::cca`] from now. A station
    /// that is sending an acknowledgement, or is about to, reads busy.
    fn start_cca(&mut self);

    /// Puts the first bit on the air; [`Event::TransmissionEnded`] is due [`Phy::airtime`] from now.
    fn start_transmission(&mut self, frame: OutgoingFrame);
}

/// How a frame ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It went out and asked for no acknowledgement.
    Sent,
    /// It went out and was acknowledged.
    Acknowledged,
    /// It went out as often as allowed and was never acknowledged.
    NoAck,
    /// The channel was busy too often; with acknowledgements, perhaps after earlier transmissions.
    ChannelAccessFailure,
}

/// The end of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Report {
    /// The frame.
    pub frame: OutgoingFrame,
    /// How it ended.
    pub outcome: Outcome,
    /// Clear channel assessments made for it.
    pub ccas: u32,
    /// Times that it was transmitted.
    pub transmissions: u32,
}

/// A frame under way, whether slotted or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Attempt {
    pub(crate) frame: OutgoingFrame,
    /// Busy CCAs of this access to the channel: NB of the standard.
    pub(crate) busy: u8,
    /// Backoff exponent: BE of the standard.
    pub(crate) exponent: u8,
    pub(crate) ccas: u32,
    pub(crate) transmissions: u32,
}

impl Attempt {
    pub(crate) const fn new(frame: OutgoingFrame) -> Self {
        Self { frame, busy: 0, exponent: 0, ccas: 0, transmissions: 0 }
    }

    pub(crate) const fn with_cca(self) -> Self {
        Self { ccas: self.ccas + 1, ..self }
    }

    pub(crate) const fn with_transmission(self) -> Self {
        Self { transmissions: self.transmissions + 1, ..self }
    }

    pub(crate) const fn report(self, outcome: Outcome) -> Report {
        Report { frame: self.frame, outcome, ccas: self.ccas, transmissions: self.transmissions }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Idle,
    BackingOff(Attempt),
    Sensing(Attempt),
    TurningToTransmit(Attempt),
    Transmitting(Attempt),
    TurningToReceive(Attempt),
    AwaitingAck(Attempt),
    /// Silent after a frame; then the attempt that waits, if any, contends.
    Spacing(Option<Attempt>),
}

/// The machine.
#[derive(Clone, Debug)]
pub struct Csma {
    settings: CsmaSettings,
    phy: Phy,
    state: State,
}

impl Csma {
    /// A machine at rest.
    #[must_use]
    pub const fn new(settings: CsmaSettings, phy: Phy) -> Self {
        Self { settings, phy, state: State::Idle }
    }

    /// Whether a frame is under way, so that [`Csma::start`] must wait for its [`Report`].
    #[must_use]
    pub const fn is_busy(&self) -> bool {
        !matches!(self.state, State::Idle | State::Spacing(None))
    }

    /// The state in which the radio rests between commands, also before the first one.
    #[must_use]
    pub const fn resting_state(&self) -> RadioState {
        self.settings.resting_state()
    }

    /// Takes a frame to send; within the silence owed after the last one it waits for its end.
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

    /// Takes note of what happened; the report if that ended the frame. An acknowledgement that
    /// is not waited for changes nothing.
    ///
    /// # Panics
    /// If the event cannot happen now: it was never asked for.
    pub fn handle(&mut self, event: Event, radio: &mut impl Radio) -> Option<Report> {
        let (state, report) = match (self.state, event) {
            (State::BackingOff(attempt), Event::BackoffExpired) => {
                radio.enter(RadioState::Receive);
                radio.start_cca();
                (State::Sensing(attempt.with_cca()), None)
            }
            (State::Sensing(attempt), Event::CcaEnded { busy: false }) => {
                radio.enter(RadioState::Turnaround);
                radio.after(self.phy.turnaround(), Event::TransmitReady);
                (State::TurningToTransmit(attempt), None)
            }
            (State::Sensing(attempt), Event::CcaEnded { busy: true }) => self.defer(attempt, radio),
            (State::TurningToTransmit(attempt), Event::TransmitReady) => {
                radio.enter(RadioState::Transmit);
                radio.start_transmission(attempt.frame);
                (State::Transmitting(attempt.with_transmission()), None)
            }
            (State::Transmitting(attempt), Event::TransmissionEnded) if attempt.frame.ack_request => {
                radio.enter(RadioState::Turnaround);
                radio.after(self.phy.turnaround(), Event::ReceiveReady);
                (State::TurningToReceive(attempt), None)
            }
            (State::Transmitting(attempt), Event::TransmissionEnded) => {
                let state = self.space(attempt.frame, Duration::ZERO, None, radio);
                (state, Some(attempt.report(Outcome::Sent)))
            }
            (State::TurningToReceive(attempt), Event::ReceiveReady) => {
                radio.enter(RadioState::Receive);
                let left = self.phy.ack_wait() - self.phy.turnaround();
                radio.after(left, Event::AckWaitExpired);
                (State::AwaitingAck(attempt), None)
            }
            (State::AwaitingAck(attempt), Event::AckReceived { sequence }) if sequence == attempt.frame.sequence => {
                radio.cancel_timer();
                let state = self.space(attempt.frame, Duration::ZERO, None, radio);
                (state, Some(attempt.report(Outcome::Acknowledged)))
            }
            (State::AwaitingAck(attempt), Event::AckWaitExpired) => self.retry(attempt, radio),
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
        self.back_off(Attempt { busy: 0, exponent: self.settings.min_be(), ..attempt }, radio)
    }

    fn back_off(&self, attempt: Attempt, radio: &mut impl Radio) -> State {
        radio.enter(self.resting_state());
        let periods = radio.backoff_periods((1 << attempt.exponent) - 1);
        radio.after(self.phy.backoff_period() * periods, Event::BackoffExpired);
        State::BackingOff(attempt)
    }

    /// The channel was busy: backs off for longer, or gives up.
    fn defer(&self, attempt: Attempt, radio: &mut impl Radio) -> (State, Option<Report>) {
        let busy = attempt.busy + 1;
        if busy > self.settings.max_backoffs() {
            radio.enter(self.resting_state());
            return (State::Idle, Some(attempt.report(Outcome::ChannelAccessFailure)));
        }
        let exponent = (attempt.exponent + 1).min(self.settings.max_be());
        (self.back_off(Attempt { busy, exponent, ..attempt }, radio), None)
    }

    /// No acknowledgement came: contends anew with the same sequence number, or gives up.
    fn retry(&self, attempt: Attempt, radio: &mut impl Radio) -> (State, Option<Report>) {
        let waited = self.phy.ack_wait();
        if attempt.transmissions > u32::from(self.settings.max_retries()) {
            let state = self.space(attempt.frame, waited, None, radio);
            return (state, Some(attempt.report(Outcome::NoAck)));
        }
        (self.space(attempt.frame, waited, Some(attempt), radio), None)
    }

    /// Keeps silent for what is left of the interframe spacing after `waited`; then `next` contends.
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
