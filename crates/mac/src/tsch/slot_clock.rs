//! The clock of a station: when its slots start.

use std::time::Duration;

use sextant_kernel::SimTime;

use super::Asn;

/// When the slots of a station start, by its own clock, which may be fast or slow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlotClock {
    /// A slot, ...
    known: Asn,
    /// ... and when it starts in truth.
    starts: SimTime,
    /// Length of a slot (ns).
    slot_ns: u64,
    /// True time that passes beyond each second of the clock (s).
    excess: f64,
}

impl SlotClock {
    /// A clock whose slot 0 starts at the start of the simulation, fast by `ppm` millionths, or slow if that is negative.
    #[must_use]
    pub fn new(slot: Duration, ppm: f64) -> Self {
        let slot_ns = (SimTime::ZERO + slot).as_nanos();
        Self { known: Asn(0), starts: SimTime::ZERO, slot_ns, excess: 1.0 / (1.0 + 1e-6 * ppm) - 1.0 }
    }

    /// When a slot starts, or started. No slot starts before the simulation.
    #[must_use]
    #[inline]
    pub fn start_of(&self, asn: Asn) -> SimTime {
        let slots = asn.0.cast_signed() - self.known.0.cast_signed();
        let span_ns = slots * self.slot_ns.cast_signed();
        moved(self.starts, span_ns + self.drift_ns(span_ns))
    }

    /// The first slot that starts at `now` or later.
    #[must_use]
    #[inline]
    pub fn next_from(&self, now: SimTime) -> Asn {
        let span_ns = now.saturating_since(self.starts).as_nanos();
        let span_ns = u64::try_from(span_ns).expect("a time of the simulation");
        let mut next = Asn(self.known.0 + span_ns.div_ceil(self.slot_ns));
        // The guess is wrong by a slot or two if the clock drifts.
        while next > self.known && self.start_of(Asn(next.0 - 1)) >= now {
            next = Asn(next.0 - 1);
        }
        while self.start_of(next) < now {
            next = next.next();
        }
        next
    }

    /// A slot starts `later_ns` later than the clock says, or earlier if that is negative: so do all that follow.
    pub fn correct(&mut self, asn: Asn, later_ns: i64) {
        self.starts = moved(self.start_of(asn), later_ns);
        self.known = asn;
    }

    /// A slot starts at this instant: the station takes over the time of another one.
    pub fn set(&mut self, asn: Asn, starts: SimTime) {
        (self.known, self.starts) = (asn, starts);
    }

    #[inline]
    fn is_exact(&self) -> bool {
        self.excess.abs() <= 0.0
    }

    #[inline]
    fn drift_ns(&self, span_ns: i64) -> i64 {
        if self.is_exact() {
            return 0;
        }
        #[expect(clippy::cast_precision_loss, clippy::cast_possible_truncation, reason = "rounded, far below 2^53")]
        let drift = (span_ns as f64 * self.excess).round() as i64;
        drift
    }
}

/// An instant that is later by so many nanoseconds, or earlier.
fn moved(instant: SimTime, later_ns: i64) -> SimTime {
    let by = Duration::from_nanos(later_ns.unsigned_abs());
    if later_ns < 0 { instant.saturating_sub(by) } else { instant + by }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLOT: Duration = Duration::from_millis(10);

    fn at(us: u64) -> SimTime {
        SimTime::ZERO + Duration::from_micros(us)
    }

    #[test]
    fn slots_of_an_exact_clock_follow_each_other() {
        let clock = SlotClock::new(SLOT, 0.0);
        assert_eq!(clock.start_of(Asn(7)), at(70_000));
        assert_eq!((clock.next_from(at(70_000)), clock.next_from(at(70_001))), (Asn(7), Asn(8)));
    }

    #[test]
    fn a_fast_clock_is_early_and_is_corrected() {
        let mut clock = SlotClock::new(SLOT, 40.0);
        // 27.5 s are 2750 slots: early by 40 millionths of it, 1.1 ms.
        let early = at(27_500_000) - clock.start_of(Asn(2750));
        assert!((early.as_secs_f64() - 1.1e-3).abs() < 1e-6, "{early:?}");
        clock.correct(Asn(2750), i64::try_from(early.as_nanos()).expect("short"));
        assert_eq!(clock.start_of(Asn(2750)), at(27_500_000));
        // Slots before the correction are those of the corrected clock too.
        assert_eq!(clock.start_of(Asn(2749)), SimTime::from_nanos(27_490_000_400));
        let early = at(27_600_000) - clock.start_of(Asn(2760));
        assert!((early.as_secs_f64() - 4e-6).abs() < 1e-8, "{early:?}");
    }

    #[test]
    fn the_next_slot_starts_at_or_after_an_instant() {
        for ppm in [-1000.0, -40.0, 0.0, 40.0, 1000.0] {
            let clock = SlotClock::new(SLOT, ppm);
            for us in (0..40_000_000).step_by(39_997) {
                let next = clock.next_from(at(us));
                assert!(clock.start_of(next) >= at(us), "{ppm}, {us}");
                assert!(next == Asn(0) || clock.start_of(Asn(next.0 - 1)) < at(us), "{ppm}, {us}");
            }
        }
    }
}
