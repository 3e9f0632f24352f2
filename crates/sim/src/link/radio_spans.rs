//! How long a radio was on.

use std::time::Duration;

use sextant_kernel::SimTime;
use sextant_mac::{EnergyMeter, RadioState};

/// How long a radio was on, by its state. The rest of the time it was asleep.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RadioSpans {
    pub(super) transmitting: Duration,
    pub(super) receiving: Duration,
    pub(super) turning: Duration,
}

impl RadioSpans {
    /// The meter of the radio from one instant to another.
    pub(super) fn meter(self, from: SimTime, to: SimTime) -> EnergyMeter {
        let mut meter = EnergyMeter::new(RadioState::Transmit, from);
        let mut at = from;
        for (span, next) in [
            (self.transmitting, RadioState::Receive),
            (self.receiving, RadioState::Turnaround),
            (self.turning, RadioState::Sleep),
        ] {
            at += span;
            meter.enter(next, at);
        }
        meter.enter(RadioState::Sleep, to.max(at));
        meter
    }
}
