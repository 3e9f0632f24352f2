//! When a station sends its beacons: the Trickle timer (RFC 6206), without suppression.

use std::time::Duration;

use sextant_kernel::SimTime;

/// The Trickle timer: one message in each interval, at a random instant of its second half. Intervals double up to the
/// longest one. A reset begins again with the shortest one (RFC 6206, 4.2; messages are never suppressed, as with k = 0 there).
#[derive(Clone, Debug, PartialEq)]
pub struct Trickle {
    shortest: Duration,
    longest: Duration,
    /// Length of the interval of the next message, ...
    interval: Duration,
    /// ... when it begins, ...
    begins: SimTime,
    /// ... and the length of the one before.
    before: Duration,
}

impl Trickle {
    /// A timer with intervals from `shortest` to `longest`.
    #[must_use]
    pub fn new(shortest: Duration, longest: Duration) -> Self {
        Self { shortest, longest, interval: shortest, begins: SimTime::ZERO, before: shortest }
    }

    /// The first interval begins `now`: when to send the first message, by a number uniform in (0, 1).
    pub fn begin(&mut self, now: SimTime, uniform: f64) -> SimTime {
        (self.interval, self.before, self.begins) = (self.shortest, self.shortest, now);
        self.message(uniform)
    }

    /// A message was sent: when to send the next one.
    pub fn next(&mut self, uniform: f64) -> SimTime {
        self.begins += self.interval;
        self.before = self.interval;
        self.interval = (2 * self.interval).min(self.longest);
        self.message(uniform)
    }

    /// Something does not fit at `now`: when to send the next message instead; `None` if the interval under way is the
    /// shortest one already.
    pub fn reset(&mut self, now: SimTime, uniform: f64) -> Option<SimTime> {
        let under_way = if now < self.begins { self.before } else { self.interval };
        (under_way > self.shortest).then(|| self.begin(now, uniform))
    }

    fn message(&self, uniform: f64) -> SimTime {
        self.begins + self.interval.mul_f64(0.5 + 0.5 * uniform)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The numbers of messages of a station alone in the first hour, by earliest and latest draws.
    fn in_an_hour(trickle: &Trickle) -> [usize; 2] {
        [0.0, 1.0].map(|uniform| {
            let mut trickle = trickle.clone();
            let hour = SimTime::ZERO + Duration::from_secs(3600);
            let first = trickle.begin(SimTime::ZERO, uniform);
            std::iter::successors(Some(first), |_| Some(trickle.next(uniform))).take_while(|&at| at <= hour).count()
        })
    }

    /// Intervals of 4.096 s with 8 doublings end at 4.096, 12.288, .., 1044.48 s, then each 1048.576 s: whatever is drawn,
    /// an hour has ten messages. With 128 ms and 12 doublings it has 17 or 18.
    #[test]
    fn an_hour_has_as_many_messages_as_the_intervals_say() {
        let contiki = Trickle::new(Duration::from_millis(4096), Duration::from_millis(4096 << 8));
        assert_eq!(in_an_hour(&contiki), [10, 10]);
        let ctp = Trickle::new(Duration::from_millis(128), Duration::from_millis(128 << 12));
        assert_eq!(in_an_hour(&ctp), [18, 17]);
    }

    #[test]
    fn intervals_double_and_a_reset_begins_again() {
        let second = Duration::from_secs(1);
        let at = |s: f64| SimTime::ZERO + Duration::from_secs_f64(s);
        let mut trickle = Trickle::new(second, 4 * second);
        assert_eq!(trickle.begin(at(10.0), 0.5), at(10.75));
        // The first interval ends at 11, and is the shortest one.
        assert_eq!(trickle.next(0.5), at(12.5));
        assert_eq!(trickle.reset(at(10.9), 0.0), None);
        assert_eq!((trickle.next(0.5), trickle.next(0.5)), (at(16.0), at(20.0)));
        assert_eq!(trickle.reset(at(16.1), 0.0), Some(at(16.6)));
        assert_eq!(trickle.reset(at(16.2), 0.0), None);
    }
}
