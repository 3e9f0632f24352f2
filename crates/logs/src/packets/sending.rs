//! How many packets a node sent during each slot, from those that were heard.

use std::time::Duration;

use sextant_kernel::SimTime;

use crate::path::slot::Slot;

/// Most packets that a node can have sent at a stop.
pub(crate) const MOST_SENT: u32 = u32::MAX - 1;

/// Counts the packets that a node sent in each of `slots`, which are in the order of time and do not overlap, and adds them
/// to `counts`. The node sends every `interval`, was heard at the times `heard` (in order, at least one), and sent from
/// `from` to `to`.
///
/// Between two times at which it was heard, as many packets were lost as intervals fit in to the nearest whole number; they
/// are spread evenly. So a drifting clock and a rough interval do no harm. Before the first and after the last time it sent
/// every interval.
pub(crate) fn count(
    slots: &[Slot],
    counts: &mut [u64],
    heard: &[SimTime],
    interval: Duration,
    from: SimTime,
    to: SimTime,
) {
    let interval_ns = u64::try_from(interval.as_nanos()).unwrap_or(u64::MAX).max(1);
    let (Some(&first), Some(&last)) = (heard.first(), heard.last()) else { return };
    let before = first.as_nanos().saturating_sub(from.as_nanos()) / interval_ns;
    let after = to.as_nanos().saturating_sub(last.as_nanos()) / interval_ns;
    let back = first.as_nanos() - before * interval_ns;
    let mut runs = Runs { slots, counts };
    runs.add(Run { start: back, span: before * interval_ns, packets: before });
    for pair in heard.windows(2) {
        let span = pair[1].as_nanos() - pair[0].as_nanos();
        let packets = (span.saturating_add(interval_ns / 2) / interval_ns).max(1);
        runs.add(Run { start: pair[0].as_nanos(), span, packets });
    }
    let packets = after + 1;
    runs.add(Run { start: last.as_nanos(), span: packets.saturating_mul(interval_ns), packets });
}

/// Packets at even times: the first at `start`, the one that would follow the last at `start + span` (ns).
struct Run {
    start: u64,
    span: u64,
    packets: u64,
}

impl Run {
    /// How many of its packets were sent before a time (ns).
    fn before(&self, time: u64) -> u64 {
        let Some(passed) = time.checked_sub(self.start) else { return 0 };
        if self.span == 0 || passed >= self.span {
            return self.packets;
        }
        let count = (u128::from(passed) * u128::from(self.packets)).div_ceil(u128::from(self.span));
        u64::try_from(count).expect("at most all packets")
    }
}

struct Runs<'a> {
    slots: &'a [Slot],
    counts: &'a mut [u64],
}

impl Runs<'_> {
    fn add(&mut self, run: Run) {
        if run.packets == 0 {
            return;
        }
        let first = self.slots.partition_point(|slot| slot.end.as_nanos() <= run.start);
        for (slot, count) in self.slots.iter().zip(self.counts.iter_mut()).skip(first) {
            if slot.start.as_nanos() >= run.start.saturating_add(run.span.max(1)) {
                break;
            }
            let sent = run.before(slot.end.as_nanos()) - run.before(slot.start.as_nanos());
            *count += sent;
        }
    }
}
