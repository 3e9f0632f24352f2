//! Simulated time: an integer, so that instants compare exactly.

use std::fmt;
use std::ops::{Add, AddAssign, Sub};
use std::time::Duration;

/// An instant: nanoseconds since the start of the simulation. Spans are [`Duration`].
///
/// The range is 584 years; arithmetic beyond it is a bug and panics.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct SimTime(u64);

impl SimTime {
    /// The start of the simulation.
    pub const ZERO: Self = Self(0);
    /// The last instant that can be represented.
    pub const MAX: Self = Self(u64::MAX);

    /// The instant `nanos` nanoseconds after the start.
    #[must_use]
    #[inline]
    pub const fn from_nanos(nanos: u64) -> Self {
        Self(nanos)
    }

    /// The instant `secs` seconds after the start.
    ///
    /// # Panics
    /// If that is more than 584 years.
    #[must_use]
    pub const fn from_secs(secs: u64) -> Self {
        match secs.checked_mul(1_000_000_000) {
            Some(nanos) => Self(nanos),
            None => panic!("an instant is at most 584 years after the start"),
        }
    }

    /// Nanoseconds since the start.
    #[must_use]
    #[inline]
    pub const fn as_nanos(self) -> u64 {
        self.0
    }

    /// Seconds since the start, for people and for formulas; never for comparing instants.
    #[must_use]
    pub fn as_secs_f64(self) -> f64 {
        self.0 as f64 * 1e-9
    }

    /// The span from `earlier` to this instant; zero if `earlier` is later.
    #[must_use]
    #[inline]
    pub const fn saturating_since(self, earlier: Self) -> Duration {
        Duration::from_nanos(self.0.saturating_sub(earlier.0))
    }

    /// The instant `span` before this one; the start if that would be before it.
    #[must_use]
    #[inline]
    pub fn saturating_sub(self, span: Duration) -> Self {
        Self(self.0.saturating_sub(nanos(span)))
    }
}

/// Nanoseconds of a span.
///
/// # Panics
/// If the span is longer than 584 years.
#[inline]
fn nanos(span: Duration) -> u64 {
    let whole = span.as_secs().checked_mul(1_000_000_000);
    let nanos = whole.and_then(|whole| whole.checked_add(span.subsec_nanos().into()));
    nanos.expect("a span of less than 584 years")
}

impl Add<Duration> for SimTime {
    type Output = Self;

    #[inline]
    fn add(self, span: Duration) -> Self {
        Self(self.0.checked_add(nanos(span)).expect("an instant within 584 years"))
    }
}

impl AddAssign<Duration> for SimTime {
    #[inline]
    fn add_assign(&mut self, span: Duration) {
        *self = *self + span;
    }
}

impl Sub for SimTime {
    type Output = Duration;

    /// The span from `earlier` to `self`.
    ///
    /// # Panics
    /// If `earlier` is later than `self`.
    #[inline]
    fn sub(self, earlier: Self) -> Duration {
        Duration::from_nanos(self.0.checked_sub(earlier.0).expect("an earlier instant"))
    }
}

impl fmt::Display for SimTime {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}.{:09} s", self.0 / 1_000_000_000, self.0 % 1_000_000_000)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn instants_and_spans_are_exact_beyond_the_precision_of_f64() {
        let late = SimTime::from_nanos((1 << 60) + 1);
        let later = late + Duration::from_nanos(1);
        assert_eq!(later - late, Duration::from_nanos(1));
        assert_eq!(later.to_string(), "1152921504.606846978 s");
        assert_eq!(SimTime::ZERO.saturating_sub(Duration::from_secs(1)), SimTime::ZERO);
        assert_eq!(later.saturating_sub(Duration::new(1, 2)), SimTime::from_nanos((1 << 60) - 1_000_000_000));
        assert_eq!(later.saturating_since(late), Duration::from_nanos(1));
        assert_eq!(late.saturating_since(later), Duration::ZERO);
        assert_eq!(SimTime::from_nanos(2_500_000_000).as_secs_f64().to_bits(), 2.5_f64.to_bits());
        let mut now = late;
        now += Duration::from_nanos(1);
        assert_eq!(now, later);
    }
}
