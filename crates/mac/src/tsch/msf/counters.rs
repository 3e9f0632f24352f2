//! How many cells to the parent went by, and how many of them were used.

use super::super::Asn;

/// The counters NumCellsElapsed and NumCellsUsed (RFC 9033, section 5.1). Cells are not counted one by one as they go by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CellCounters {
    elapsed: u64,
    pub(super) used: u64,
    /// Cells are counted up to but not including this slot.
    counted: Asn,
}

impl CellCounters {
    pub(super) const fn new(now: Asn) -> Self {
        Self { elapsed: 0, used: 0, counted: now }
    }

    /// Cells in these slots of each slotframe of `length` slots have gone by up to but not including `now`. Returns how many have
    /// since the start of the counters.
    pub(super) fn elapse(&mut self, timeslots: impl Iterator<Item = u16>, length: u16, now: Asn) -> u64 {
        if now > self.counted {
            let within = |timeslot: u16| {
                let first = self.counted.next_at(timeslot, length);
                now.0.saturating_sub(first.0).div_ceil(length.into())
            };
            self.elapsed += timeslots.map(within).sum::<u64>();
            self.counted = now;
        }
        self.elapsed
    }

    /// The slot after that in which cell number `limit` goes by, if the cells stay as they are; `None` if there are none.
    pub(super) fn full_at(&self, timeslots: impl Iterator<Item = u16>, length: u16, limit: u64) -> Option<Asn> {
        let mut next: Vec<u64> = timeslots.map(|timeslot| self.counted.next_at(timeslot, length).0).collect();
        next.sort_unstable();
        let cells = next.len() as u64;
        if cells == 0 {
            return None;
        }
        let Some(last) = limit.checked_sub(self.elapsed + 1) else { return Some(self.counted) };
        let place = usize::try_from(last % cells).expect("a place among the cells");
        Some(Asn(next[place] + last / cells * u64::from(length) + 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A counter as the text of the standard has it: each slot is looked at.
    fn one_by_one(timeslots: &[u16], length: u16, from: u64, limit: u64) -> u64 {
        let (mut elapsed, mut asn) = (0, from);
        while elapsed < limit {
            elapsed +=
                timeslots.iter().filter(|&&timeslot| asn % u64::from(length) == u64::from(timeslot)).count() as u64;
            asn += 1;
        }
        asn
    }

    #[test]
    fn cells_that_go_by_are_counted_as_one_would_count_them_one_by_one() {
        for timeslots in [&[7][..], &[3, 50, 99], &[1, 2, 3, 4, 100], &[0]] {
            for from in [0, 5, 99, 100, 101, 1234] {
                let all = || timeslots.iter().copied();
                let mut counters = CellCounters::new(Asn(from));
                let full = one_by_one(timeslots, 101, from, 100);
                assert_eq!(counters.full_at(all(), 101, 100), Some(Asn(full)), "{timeslots:?} from {from}");
                // On the way there, in steps.
                for step in [17, 230, 231, 1000] {
                    counters.elapse(all(), 101, Asn(from + step));
                    assert_eq!(counters.full_at(all(), 101, 100), Some(Asn(full)), "{timeslots:?} from {from}");
                }
                assert_eq!(counters.elapse(all(), 101, Asn(full - 1)), 99);
                assert_eq!(counters.elapse(all(), 101, Asn(full)), 100);
            }
        }
        assert_eq!(CellCounters::new(Asn(3)).full_at(std::iter::empty(), 101, 100), None);
    }
}
