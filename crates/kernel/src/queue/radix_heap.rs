//! A radix heap over instants (Ahuja, Mehlhorn, Orlin and Tarjan 1990, "Faster algorithms for the shortest
//! path problem", section 2, with buckets by the highest differing bit), with a sorted bucket in front.

use super::entry::Entry;
use super::quad_heap::QuadHeap;
use crate::SimTime;

/// A bucket with at most this many entries is sorted as a whole.
const SMALL_BUCKET: usize = 16;

/// Entries, the smallest first.
///
/// Entries up to the horizon are in `near` and `late`. A later entry is in the bucket of the highest bit in which its
/// instant differs from the horizon, so lower buckets have earlier instants. When nothing is left up to the horizon, it
/// moves into the lowest bucket, and the entries of this bucket go to `near` and to lower buckets.
pub(super) struct RadixHeap {
    /// The entries that the horizon moved over, the smallest last.
    near: Vec<Entry>,
    /// Those that were pushed when the horizon had moved over their instants.
    late: QuadHeap,
    horizon: SimTime,
    /// Bit b is set where `far[b]` has entries.
    occupied: u64,
    far: [Vec<Entry>; 64],
}

impl Default for RadixHeap {
    fn default() -> Self {
        Self {
            near: Vec::new(),
            late: QuadHeap::default(),
            horizon: SimTime::ZERO,
            occupied: 0,
            far: std::array::from_fn(|_| Vec::new()),
        }
    }
}

impl RadixHeap {
    #[inline]
    pub(super) fn push(&mut self, entry: Entry) {
        if entry.time() <= self.horizon {
            self.late.push(entry);
        } else {
            self.put_off(entry);
        }
    }

    /// Puts an entry beyond the horizon into its bucket.
    #[inline]
    fn put_off(&mut self, entry: Entry) {
        let differing = entry.time().as_nanos() ^ self.horizon.as_nanos();
        let bucket = differing.ilog2();
        self.occupied |= 1 << bucket;
        self.far[bucket as usize].push(entry);
    }

    #[inline]
    pub(super) fn peek(&mut self) -> Option<&Entry> {
        if self.near.is_empty() && self.late.is_empty() {
            self.advance();
        }
        match (self.near.last(), self.late.peek()) {
            (Some(near), Some(late)) => Some(near.min(late)),
            (near, late) => near.or(late),
        }
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Option<Entry> {
        if self.late.is_empty() {
            if self.near.is_empty() {
                self.advance();
            }
            return self.near.pop();
        }
        self.pop_late()
    }

    /// The smallest entry up to the horizon, of which some are late.
    fn pop_late(&mut self) -> Option<Entry> {
        match (self.near.last(), self.late.peek()) {
            (Some(near), Some(late)) if near < late => self.near.pop(),
            _ => self.late.pop(),
        }
    }

    /// Moves the horizon to the first instant beyond it that has entries, or over the next few entries.
    #[inline(never)]
    fn advance(&mut self) {
        if self.occupied == 0 {
            return;
        }
        let lowest = self.occupied.trailing_zeros() as usize;
        self.occupied &= self.occupied - 1;
        if self.far[lowest].len() <= SMALL_BUCKET {
            std::mem::swap(&mut self.near, &mut self.far[lowest]);
        } else {
            let mut bucket = std::mem::take(&mut self.far[lowest]);
            self.horizon = bucket.iter().map(Entry::time).fold(SimTime::MAX, SimTime::min);
            for &entry in &bucket {
                if entry.time() == self.horizon { self.near.push(entry) } else { self.put_off(entry) }
            }
            bucket.clear();
            // Its entries went to `near` or to lower buckets. It keeps its memory.
            self.far[lowest] = bucket;
        }
        self.near.sort_unstable_by(|a, b| b.cmp(a));
        // Not to the end of the bucket, which may be years ahead.
        self.horizon = self.near.first().map_or(self.horizon, Entry::time);
    }

    /// Removes the entries for which `keep` is false. Looks at every entry.
    #[cold]
    pub(super) fn retain(&mut self, mut keep: impl FnMut(&Entry) -> bool) {
        self.near.retain(&mut keep);
        self.late.retain(&mut keep);
        for (bit, bucket) in self.far.iter_mut().enumerate() {
            bucket.retain(&mut keep);
            if bucket.is_empty() {
                self.occupied &= !(1 << bit);
            }
        }
    }

    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.near.len() + self.late.len() + self.far.iter().map(Vec::len).sum::<usize>()
    }
}
