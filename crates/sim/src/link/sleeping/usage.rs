//! How the radio of a station was used.

use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_mac::sleep::CheckSpans;
use sextant_mac::{EnergyMeter, RadioState};

use crate::link::radio_spans::RadioSpans;
use crate::service::sleep::SleepUse;

/// How the radio of a station was used since an instant. What is in no other state was asleep.
#[derive(Clone, Copy, Debug)]
pub(super) struct Usage {
    state: RadioState,
    since: SimTime,
    from: SimTime,
    spans: RadioSpans,
    /// Checks, those in which nobody sent included.
    pub(super) checks: u64,
    /// Frames sent to wake a receiver, and copies of frames.
    pub(super) strobes: u64,
    /// Packets that ended without having been sent, although frames to wake a receiver were.
    pub(super) unanswered: u64,
}

impl Usage {
    pub(super) fn new(state: RadioState, now: SimTime) -> Self {
        Self { state, since: now, from: now, spans: RadioSpans::default(), checks: 0, strobes: 0, unanswered: 0 }
    }

    /// The state of the radio.
    pub(super) fn state(&self) -> RadioState {
        self.state
    }

    /// The radio changes its state.
    #[inline]
    pub(super) fn enter(&mut self, state: RadioState, now: SimTime) {
        let span = now.saturating_since(self.since);
        match self.state {
            RadioState::Transmit => self.spans.transmitting += span,
            RadioState::Receive => self.spans.receiving += span,
            RadioState::Turnaround => self.spans.turning += span,
            RadioState::Idle | RadioState::Sleep => {}
        }
        (self.state, self.since) = (state, now);
    }

    /// So many checks in which nobody sent were whole.
    pub(super) fn add_checks(&mut self, checks: u64, spans: CheckSpans) {
        let times = |span: Duration| Duration::from_nanos((SimTime::ZERO + span).as_nanos().saturating_mul(checks));
        self.checks += checks;
        self.spans.receiving += times(spans.receiving);
        self.spans.turning += times(spans.turning);
    }

    /// A part of a check passed.
    pub(super) fn add_part(&mut self, spans: CheckSpans) {
        self.checks += 1;
        self.spans.receiving += spans.receiving;
        self.spans.turning += spans.turning;
    }

    /// All so far is forgotten.
    pub(super) fn restart(&mut self, now: SimTime) {
        *self = Self::new(self.state, now);
    }

    /// The meter of the radio, and how the station slept.
    pub(super) fn close(mut self, now: SimTime) -> (EnergyMeter, SleepUse) {
        self.enter(self.state, now);
        let RadioSpans { transmitting, receiving, turning } = self.spans;
        let used = SleepUse {
            on: transmitting + receiving + turning,
            span: now.saturating_since(self.from),
            checks: self.checks,
            strobes: self.strobes,
            unanswered: self.unanswered,
            is_member: true,
        };
        (self.spans.meter(self.from, now), used)
    }
}
