//! Who could hear the frames of a station, in the order of their wake-ups: only these are looked at when it sends.

use std::ops::Range;
use std::time::Duration;

use sextant_kernel::{SimTime, StationId};

use super::checks::Checks;

/// The order is made anew before phases have moved by this part of an interval.
const PARTS: u64 = 64;

/// Stations that sleep, in the order of their wake-ups in the interval.
#[derive(Clone, Debug)]
pub(super) struct WakeOrder {
    /// Phase in the interval (ns), and station.
    sorted: Vec<(u64, StationId)>,
    interval_ns: u64,
    made_at: SimTime,
    lasts_until: SimTime,
    /// Largest deviation of a clock from the true time, as a factor.
    drift: f64,
}

impl WakeOrder {
    /// The order of these stations as it is now.
    pub(super) fn new<'a>(
        stations: impl Iterator<Item = (StationId, &'a Checks)>,
        interval: Duration,
        drift: f64,
        now: SimTime,
    ) -> Self {
        let interval_ns = (SimTime::ZERO + interval).as_nanos();
        let phase = |checks: &Checks| checks.start_of(checks.next_from(now)).as_nanos() % interval_ns;
        let mut sorted: Vec<_> = stations.map(|(station, checks)| (phase(checks), station)).collect();
        sorted.sort_unstable();
        let lasts = if drift > 0.0 {
            now + Duration::from_nanos(interval_ns / PARTS).div_f64(drift)
        } else {
            SimTime::from_nanos(u64::MAX)
        };
        Self { sorted, interval_ns, made_at: now, lasts_until: lasts, drift }
    }

    /// Whether it holds no more.
    pub(super) fn is_stale(&self, now: SimTime) -> bool {
        now > self.lasts_until
    }

    /// Its stations, to make the order anew.
    pub(super) fn stations(&self) -> impl Iterator<Item = StationId> + '_ {
        self.sorted.iter().map(|&(_, station)| station)
    }

    /// The stations that may wake up within `span`, and a few more: in the order of their phases from the start of the span on.
    pub(super) fn waking(&self, span: Range<SimTime>) -> impl Iterator<Item = StationId> + '_ {
        // Phases are those of the interval after the order was made.
        let since = span.end.saturating_since(self.made_at) + Duration::from_nanos(self.interval_ns);
        let moved = since.mul_f64(self.drift) + Duration::from_nanos(1);
        let from = span.start.saturating_sub(moved).as_nanos();
        let length = (span.end + moved).as_nanos() - from;
        let from = from % self.interval_ns;
        let to = from + length.min(self.interval_ns);
        let at = |phase: u64| self.sorted.partition_point(|&(other, _)| other < phase);
        let first = at(from)..at(to.min(self.interval_ns));
        // What goes beyond the end of the interval is at its start.
        let second = 0..at(to.saturating_sub(self.interval_ns));
        self.sorted[first].iter().chain(&self.sorted[second]).map(|&(_, station)| station)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::link::clock::Clock;

    const INTERVAL: Duration = Duration::from_millis(100);

    fn checks(phase_ms: u64, ppm: f64) -> Checks {
        Checks::new(Clock::fast_by(ppm), Duration::from_millis(phase_ms), INTERVAL)
    }

    fn at(ms: u64) -> SimTime {
        SimTime::from_nanos(ms * 1_000_000)
    }

    #[test]
    fn those_that_wake_up_in_a_span_are_found_also_over_the_end_of_an_interval() {
        let all = [5, 50, 95].map(|phase| checks(phase, 0.0));
        let stations = || all.iter().enumerate().map(|(i, checks)| (StationId::from_index(i), checks));
        let order = WakeOrder::new(stations(), INTERVAL, 0.0, at(0));
        let found = |from, to| order.waking(at(from)..at(to)).map(|station| station.0).collect::<Vec<_>>();
        assert_eq!(found(1_000, 1_004), [0; 0]);
        assert_eq!(found(1_004, 1_051), [0, 1]);
        assert_eq!(found(1_090, 1_106), [2, 0]);
        assert_eq!(found(1_006, 1_200), [1, 2, 0]);
    }

    #[test]
    fn an_order_holds_as_long_as_clocks_have_hardly_drifted() {
        let all = [checks(50, 100.0), checks(60, -100.0)];
        let stations = || all.iter().enumerate().map(|(i, checks)| (StationId::from_index(i), checks));
        let order = WakeOrder::new(stations(), INTERVAL, 1e-4, at(0));
        // 100 ms / 64 / 1e-4 = 15.6 s.
        assert!(!order.is_stale(at(15_000)) && order.is_stale(at(16_000)));
        for (i, checks) in all.iter().enumerate() {
            let wakes = checks.start_of(140);
            let span = wakes..wakes + Duration::from_micros(1);
            assert!(order.waking(span).any(|station| station.index() == i));
        }
    }
}
