//! When a station wakes up.

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::link::clock::Clock;

/// When a station wakes up: at each interval of its clock, from a phase on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Checks {
    clock: Clock,
    phase_ns: u64,
    interval_ns: u64,
}

impl Checks {
    /// The wake-ups at `phase` and at each `interval` after it.
    pub(super) fn new(clock: Clock, phase: Duration, interval: Duration) -> Self {
        let nanos = |span: Duration| (SimTime::ZERO + span).as_nanos();
        Self { clock, phase_ns: nanos(phase), interval_ns: nanos(interval) }
    }

    /// The start of a check.
    pub(super) fn start_of(&self, check: u64) -> SimTime {
        self.clock.instant(SimTime::from_nanos(self.phase_ns + check * self.interval_ns))
    }

    /// The first check that does not begin before `instant`.
    pub(super) fn next_from(&self, instant: SimTime) -> u64 {
        let mut check = instant.as_nanos().saturating_sub(self.phase_ns).div_ceil(self.interval_ns);
        // The clock is off by less than an interval in a thousand of them.
        while check > 0 && self.start_of(check - 1) >= instant {
            check -= 1;
        }
        while self.start_of(check) < instant {
            check += 1;
        }
        check
    }

    /// The true time of a span on its clock.
    pub(super) fn span(&self, span: Duration) -> Duration {
        self.clock.instant(SimTime::ZERO + span) - SimTime::ZERO
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checks_come_at_each_interval_of_the_clock() {
        let (phase, interval) = (Duration::from_millis(40), Duration::from_millis(125));
        let exact = Checks::new(Clock::default(), phase, interval);
        assert_eq!(exact.start_of(8), SimTime::from_nanos(1_040_000_000));
        assert_eq!(
            [0, 40, 41, 165, 1_041].map(|ms| exact.next_from(SimTime::from_nanos(ms * 1_000_000))),
            [0, 0, 1, 1, 9]
        );
        // A clock that is fast by 1000 millionths wakes up 1 ms early after a second, and 3.6 s after an hour.
        let fast = Checks::new(Clock::fast_by(1000.0), phase, interval);
        let hour = fast.start_of(28_800);
        assert!((hour.as_nanos() as f64 * 1e-9 - 3600.04 / 1.001).abs() < 1e-6);
        assert_eq!(fast.next_from(hour), 28_800);
        assert_eq!(fast.next_from(hour + Duration::from_nanos(1)), 28_801);
        assert_eq!(fast.next_from(hour.saturating_sub(Duration::from_nanos(1))), 28_800);
    }
}
