//! When a station sends its beacons: the Trickle timer (RFC 6206).

use std::time::Duration;

use sextant_kernel::SimTime;

/// The Trickle timer: one message in each interval, at a random instant of its second half. Intervals double up to the
/// longest one. A reset begins again with the shortest one (RFC 6206, 4.2). With a redundancy k above zero a message is left
/// out if k like it were heard in its interval.
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
    /// Messages of others that make one superfluous; zero: none do.
    redundancy: u8,
    /// Those of the interval of the next message.
    heard: u8,
}

impl Trickle {
    /// A timer with intervals from `shortest` to `longest`.
    #[must_use]
    pub fn new(shortest: Duration, longest: Duration) -> Self {
        let (interval, before, begins) = (shortest, shortest, SimTime::ZERO);
        Self { shortest, longest, interval, begins, before, redundancy: 0, heard: 0 }
    }

    /// The same, with messages that are left out if so many like them were heard; zero: none is.
    #[must_use]
    pub fn with_redundancy(self, redundancy: u8) -> Self {
        Self { redundancy, ..self }
    }

    /// A message of another station, like one's own, was heard.
    pub fn hear(&mut self, now: SimTime) {
        // After its own message a station is in the old interval, whose count does not matter any more.
        if now >= self.begins {
            self.heard = self.heard.saturating_add(1);
        }
    }

    /// Whether the message that is due is left out.
    #[must_use]
    pub fn is_superfluous(&self) -> bool {
        self.redundancy > 0 && self.heard >= self.redundancy
    }

    /// The first interval begins `now`: when to send the first message, by a number uniform in (0, 1).
    pub fn begin(&mut self, now: SimTime, uniform: f64) -> SimTime {
        (self.interval, self.before, self.begins, self.heard) = (self.shortest, self.shortest, now, 0);
        self.message(uniform)
    }

    /// A message was sent: when to send the next one.
    pub fn next(&mut self, uniform: f64) -> SimTime {
        self.begins += self.interval;
        self.heard = 0;
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
        // The defaults of RFC 6550, 17: 8 ms and 20 doublings.
        let rfc = Trickle::new(Duration::from_millis(8), Duration::from_millis(8 << 20));
        assert_eq!(in_an_hour(&rfc), [19, 18]);
    }

    /// Stations that hear each other, begin together and leave out messages after one: each interval has one message. Nine
    /// intervals end at 2044 s, and 33 more of 1024 s begin and have their message within ten hours.
    #[test]
    fn with_a_redundancy_of_one_all_stations_together_send_one_message_an_interval() {
        for stations in [1_u8, 5, 30] {
            let trickle = Trickle::new(Duration::from_secs(4), Duration::from_secs(4 << 8)).with_redundancy(1);
            let mut all = vec![trickle; stations.into()];
            // Other numbers at each station and each interval.
            let uniform = |station: usize, round: u32| {
                let station = u32::try_from(station).expect("few stations");
                f64::from((station * 37 + round * 11) % 101) / 101.0
            };
            let mut due: Vec<SimTime> = (0..all.len()).map(|i| all[i].begin(SimTime::ZERO, uniform(i, 0))).collect();
            let (mut sent, mut rounds) = (0, vec![0_u32; all.len()]);
            while let Some(i) =
                (0..all.len()).min_by_key(|&i| due[i]).filter(|&i| due[i] <= SimTime::from_secs(36_000))
            {
                let now = due[i];
                if !all[i].is_superfluous() {
                    sent += 1;
                    (0..all.len()).filter(|&other| other != i).for_each(|other| all[other].hear(now));
                }
                rounds[i] += 1;
                due[i] = all[i].next(uniform(i, rounds[i]));
            }
            assert_eq!(sent, 42, "{stations} stations");
        }
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
