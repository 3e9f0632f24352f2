//! The clock of the poses and packets of a bag.

use sextant_kernel::SimTime;

use crate::options::bag_options::BagClock;

/// A clock of one topic can be off by this much before a note says so (ns).
const NOTABLE_NS: i128 = 100_000_000;

/// When something happened, by both clocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Moment {
    /// The stamp in the message (ns); `None` if it has none.
    pub(super) stamp_ns: Option<i64>,
    /// When the message was recorded (ns).
    pub(super) log_ns: u64,
}

impl Moment {
    /// The time by `clock`; `None` if it has no stamp, or one before 1970. A stamp of 0 is one that was never set.
    pub(super) fn time(self, clock: BagClock) -> Option<SimTime> {
        let ns = match clock {
            BagClock::Log => self.log_ns,
            BagClock::Stamp => self.stamp_ns.and_then(|ns| u64::try_from(ns).ok()).filter(|&ns| ns > 0)?,
        };
        Some(SimTime::from_nanos(ns))
    }
}

/// The least delay from stamp to recording. It is short if the clock of the stamps is that of the recorder.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeastDelay(Option<i128>);

impl LeastDelay {
    pub(super) fn take(&mut self, moment: Moment) {
        if let Some(stamp_ns) = moment.stamp_ns {
            let delay = i128::from(moment.log_ns) - i128::from(stamp_ns);
            self.0 = Some(self.0.map_or(delay, |least| least.min(delay)));
        }
    }

    /// What to tell the user if the stamps of poses and packets are of clocks that differ.
    pub(crate) fn differs(self, packets: Self) -> Option<String> {
        let (poses, packets) = (self.0?, packets.0?);
        let off_ns = packets - poses;
        (off_ns.abs() > NOTABLE_NS).then(|| {
            format!(
                "the stamps of poses and packets seem to be of different clocks, {:.3} s apart: if they are, give \
                 `bag_clock=log`",
                off_ns.abs() as f64 * 1e-9
            )
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn moment(stamp_ns: i64, log_ns: u64) -> Moment {
        Moment { stamp_ns: Some(stamp_ns), log_ns }
    }

    #[test]
    fn a_stamp_that_was_never_set_is_no_time() {
        let at = |stamp_ns, clock| moment(stamp_ns, 9).time(clock).map(SimTime::as_nanos);
        assert_eq!(at(7, BagClock::Stamp), Some(7));
        assert_eq!(at(0, BagClock::Stamp), None);
        assert_eq!(at(-7, BagClock::Stamp), None);
        assert_eq!(at(0, BagClock::Log), Some(9));
        assert_eq!(Moment { stamp_ns: None, log_ns: 9 }.time(BagClock::Stamp), None);
    }

    #[test]
    fn clocks_that_differ_are_noticed_by_their_least_delays() {
        let least = |delays_ms: &[i64]| {
            let mut least = LeastDelay::default();
            for (index, delay_ms) in (1..).zip(delays_ms) {
                least.take(moment(
                    index * 1_000_000_000 - delay_ms * 1_000_000,
                    1_000_000_000 * index.cast_unsigned(),
                ));
            }
            least
        };
        // A long delay of some messages is no other clock.
        assert_eq!(least(&[20, 900, 30]).differs(least(&[400, 50, 80])), None);
        let note = least(&[20, 900, 30]).differs(least(&[-1480, -1400])).unwrap();
        assert!(note.contains("1.500 s apart"), "{note}");
        assert_eq!(LeastDelay::default().differs(least(&[5])), None);
    }
}
