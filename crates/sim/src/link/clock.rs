//! The clock of a station, which runs a little too fast or too slow.

use std::time::Duration;

use sextant_kernel::SimTime;

/// The clock of a station: what it takes for a span is longer or shorter in truth.
///
/// A span of true time is a whole number of nanoseconds. What rounding leaves is owed to the next spans, so that the
/// clock keeps its rate over any number of spans, however short they are.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Clock {
    /// True time that passes beyond each second of the clock (s).
    excess: f64,
    /// Time owed to the next span (ns): -0.5 to 0.5.
    owed_ns: f64,
}

impl Clock {
    /// A clock that is fast by `ppm` millionths, or slow if that is negative.
    pub(crate) fn fast_by(ppm: f64) -> Self {
        Self { excess: 1.0 / (1.0 + 1e-6 * ppm) - 1.0, owed_ns: 0.0 }
    }

    #[inline]
    fn is_exact(self) -> bool {
        self.excess.abs() <= 0.0
    }

    /// True time of the next span, which has this length on the clock.
    #[inline]
    pub(crate) fn span(&mut self, length: Duration) -> Duration {
        if self.is_exact() {
            return length;
        }
        let exact_ns = length.as_secs_f64() * 1e9 * self.excess + self.owed_ns;
        let whole_ns = exact_ns.round();
        self.owed_ns = exact_ns - whole_ns;
        moved(length, whole_ns)
    }

    /// The same in nanoseconds.
    #[inline]
    pub(crate) fn span_ns(&mut self, length_ns: u64) -> u64 {
        if self.is_exact() {
            return length_ns;
        }
        let span = self.span(Duration::from_nanos(length_ns));
        (SimTime::ZERO + span).as_nanos()
    }

    /// What rounding left is forgotten: the instants of a new frame do not depend on what the station did before.
    pub(crate) fn forget_rounding(&mut self) {
        self.owed_ns = 0.0;
    }

    /// True time of an instant of the clock, which started with the simulation.
    pub(crate) fn instant(self, local: SimTime) -> SimTime {
        if self.is_exact() {
            return local;
        }
        let since_start = local.saturating_since(SimTime::ZERO);
        SimTime::ZERO + moved(since_start, (since_start.as_secs_f64() * 1e9 * self.excess).round())
    }
}

/// A span that is longer by so many nanoseconds, or shorter.
fn moved(span: Duration, by_ns: f64) -> Duration {
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "whole and not negative, below 2^63")]
    let by = Duration::from_nanos(by_ns.abs() as u64);
    if by_ns < 0.0 { span.saturating_sub(by) } else { span + by }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clock_keeps_its_rate_over_many_short_spans() {
        for ppm in [40.0, -40.0, 0.3] {
            let mut clock = Clock::fast_by(ppm);
            let spans = 1_000_000_u32;
            let symbol = Duration::from_micros(16);
            let total: Duration = (0..spans).map(|_| clock.span(symbol)).sum();
            let expected_s = 16.0 / (1.0 + 1e-6 * ppm);
            assert!((total.as_secs_f64() - expected_s).abs() <= 1e-9, "{ppm}: {total:?}");
        }
    }

    #[test]
    fn an_exact_clock_changes_nothing() {
        let span = Duration::from_nanos(123_456_789);
        assert_eq!(Clock::default().span(span), span);
        assert_eq!(Clock::fast_by(0.0).instant(SimTime::from_nanos(7)), SimTime::from_nanos(7));
    }

    #[test]
    fn a_fast_clock_is_early() {
        let hour = SimTime::ZERO + Duration::from_secs(3600);
        let early = hour - Clock::fast_by(10.0).instant(hour);
        assert!((early.as_secs_f64() - 0.036).abs() < 1e-6, "{early:?}");
        assert!(Clock::fast_by(-10.0).instant(hour) > hour);
    }
}
