//! Carrier sense and backoff of the enhanced distributed channel access (IEEE 802.11-2012, 9.19.2).
//!
//! A station waits until the channel was idle for AIFS, then counts one slot down after another while it stays idle. A
//! busy channel freezes the count; it resumes after AIFS of idle. There is no event per slot: the counts follow from
//! the instants at which the channel becomes busy and idle.
//!
//! A station needs [`CCA_DETECTION`] to notice a signal. A count that ends less than that after the start of a signal
//! therefore ends in a transmission, and a slot that ends then has been counted. So stations whose counts end in the
//! same slot collide, and stations one slot (5 us) apart do not.

use std::time::Duration;

use sextant_kernel::SimTime;

use super::edca::AccessCategory;
use super::timing::{CCA_DETECTION, SLOT};

/// What a station knows about the channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Carrier {
    is_busy: bool,
    /// End of the last signal that was sensed, or of the time that decoded frames claimed (NAV), if that is later.
    free_from: SimTime,
}

impl Carrier {
    pub(super) const fn is_busy(self) -> bool {
        self.is_busy
    }

    /// Since when, or from when on, the channel is free, unless it is busy.
    pub(super) const fn free_from(self) -> SimTime {
        self.free_from
    }

    pub(super) fn becomes_busy(&mut self) {
        self.is_busy = true;
    }

    pub(super) fn becomes_idle(&mut self, now: SimTime) {
        if self.is_busy {
            self.is_busy = false;
            self.is_taken_until(now);
        }
    }

    /// A frame claims the channel until then.
    pub(super) fn is_taken_until(&mut self, until: SimTime) {
        self.free_from = self.free_from.max(until);
    }
}

/// A count of slots under way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Backoff {
    aifs: Duration,
    ready_from: SimTime,
    slots_left: u32,
    /// The instant of a transmission that a signal came too late to stop.
    committed: Option<SimTime>,
}

impl Backoff {
    /// A count of `slots` that begins once the channel was idle for AIFS, counted from `ready_from` at the earliest.
    pub(super) fn new(category: AccessCategory, ready_from: SimTime, slots: u32) -> Self {
        Self { aifs: category.aifs(), ready_from, slots_left: slots, committed: None }
    }

    /// When the station may transmit; `None` while the channel is busy.
    pub(super) fn end(&self, carrier: Carrier) -> Option<SimTime> {
        match self.committed {
            None if carrier.is_busy() => None,
            None => Some(self.first_slot(carrier) + SLOT * self.slots_left),
            committed => committed,
        }
    }

    /// The channel, idle until now, becomes busy.
    pub(super) fn freeze(&mut self, now: SimTime, carrier: Carrier) {
        let Some(end) = self.end(carrier) else { return };
        let noticed = now + CCA_DETECTION;
        if end < noticed {
            self.committed = Some(end);
        } else {
            self.count_until(noticed, carrier);
        }
    }

    /// A frame claims the channel, which was idle, from now on.
    pub(super) fn suspend(&mut self, now: SimTime, carrier: Carrier) {
        if self.end(carrier).is_some_and(|end| end > now) {
            self.count_until(now, carrier);
        }
    }

    /// Counts the slots that end before `instant`, which is not after the end of the count.
    fn count_until(&mut self, instant: SimTime, carrier: Carrier) {
        let first = self.first_slot(carrier);
        if self.committed.is_none() && first < instant {
            let slots = ((instant - first).as_nanos() - 1) / SLOT.as_nanos();
            self.slots_left -= u32::try_from(slots).expect("fewer than the slots left");
        }
    }

    fn first_slot(&self, carrier: Carrier) -> SimTime {
        self.ready_from.max(carrier.free_from()) + self.aifs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(us: u64) -> SimTime {
        SimTime::ZERO + Duration::from_micros(us)
    }

    fn counting(slots: u32) -> Backoff {
        Backoff::new(AccessCategory::BestEffort, at(100), slots)
    }

    /// A count of 4 slots in a channel that is idle except from `busy` to `idle`: its end, once idle.
    fn resumed(busy: SimTime, idle: SimTime) -> SimTime {
        let (mut carrier, mut backoff) = (Carrier::default(), counting(4));
        backoff.freeze(busy, carrier);
        carrier.becomes_busy();
        carrier.becomes_idle(idle);
        backoff.end(carrier).expect("the channel is idle")
    }

    #[test]
    fn slots_count_after_aifs_of_an_idle_channel() {
        let mut carrier = Carrier::default();
        assert_eq!(counting(0).end(carrier), Some(at(118)));
        assert_eq!(counting(15).end(carrier), Some(at(118 + 75)));
        carrier.becomes_busy();
        assert_eq!(counting(0).end(carrier), None);
        carrier.becomes_idle(at(200));
        carrier.becomes_idle(at(300));
        assert_eq!(counting(2).end(carrier), Some(at(228)));
        carrier.is_taken_until(at(500));
        assert_eq!(counting(2).end(carrier), Some(at(528)));
    }

    #[test]
    fn a_busy_channel_freezes_the_count_and_the_count_resumes_after_aifs() {
        // Slots end at 123, 128, 133, 138. A signal that starts 3 us or more before the end of a slot stops it.
        assert_eq!(resumed(at(50), at(110)), at(110 + 18 + 20));
        assert_eq!(resumed(at(118), at(200)), at(200 + 18 + 20));
        assert_eq!(resumed(at(120), at(200)), at(200 + 18 + 20));
        assert_eq!(resumed(at(121), at(200)), at(200 + 18 + 15));
        assert_eq!(resumed(at(128), at(200)), at(200 + 18 + 10));
        assert_eq!(resumed(at(133), at(200)), at(200 + 18 + 5));
    }

    #[test]
    fn a_signal_that_starts_less_than_3_us_before_the_end_of_the_count_comes_too_late() {
        let end = at(118 + 20);
        assert_eq!(resumed(at(135) + Duration::from_nanos(1), at(200)), end);
        assert_eq!(resumed(end, at(200)), end);
        assert_eq!(resumed(at(135), at(200)), at(200 + 18 + 5));
    }

    #[test]
    fn a_claim_suspends_the_count() {
        let (mut carrier, mut backoff) = (Carrier::default(), counting(4));
        backoff.suspend(at(129), carrier);
        carrier.is_taken_until(at(300));
        assert_eq!(backoff.end(carrier), Some(at(300 + 18 + 10)));
    }
}
