//! A radix heap over instants (Ahuja, Mehlhorn, Orlin and Tarjan 1990, "Faster algorithms for the shortest
//! path problem", section 2, with buckets by the highest differing bit), with a small heap in front.

use super::entry::Entry;
use super::quad_heap::QuadHeap;
use crate::SimTime;

/// A bucket with at most this many entries goes into the heap in front as a whole. Measured: 8 to 16 are best.
const SMALL_BUCKET: usize = 8;

/// Entries, the smallest first.
///
/// Entries up to the horizon are in `near`, in full order. A later entry is in the bucket of the highest bit in
/// which its instant differs from the horizon, so lower buckets have earlier instants. When `near` is empty, the
/// horizon moves into the lowest bucket, and the entries of this bucket go to `near` and to lower buckets.
pub(super) struct RadixHeap {
    near: QuadHeap,
    horizon: SimTime,
    /// Bit b is set where `far[b]` has entries.
    occupied: u64,
    far: [Vec<Entry>; 64],
}

impl Default for RadixHeap {
    fn default() -> Self {
        Self {
            near: QuadHeap::default(),
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
            self.near.push(entry);
        } else {
            let differing = entry.time().as_nanos() ^ self.horizon.as_nanos();
            let bucket = differing.ilog2();
            self.occupied |= 1 << bucket;
            self.far[bucket as usize].push(entry);
        }
    }

    #[inline]
    pub(super) fn peek(&mut self) -> Option<&Entry> {
        if self.near.len() == 0 {
            self.advance();
        }
        self.near.peek()
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Option<Entry> {
        if self.near.len() == 0 {
            self.advance();
        }
        self.near.pop()
    }

    /// Moves the horizon to the first instant beyond it that has entries, or over the next few entries.
    #[inline(never)]
    fn advance(&mut self) {
        if self.occupied == 0 {
            return;
        }
        let lowest = self.occupied.trailing_zeros() as usize;
        self.occupied &= self.occupied - 1;
        let mut bucket = std::mem::take(&mut self.far[lowest]);
        let times = bucket.iter().map(Entry::time);
        if bucket.len() <= SMALL_BUCKET {
            // Not to the end of the bucket, which may be years ahead.
            self.horizon = times.fold(self.horizon, SimTime::max);
            for entry in bucket.drain(..) {
                self.near.push(entry);
            }
        } else {
            self.horizon = times.fold(SimTime::MAX, SimTime::min);
            for entry in bucket.drain(..) {
                self.push(entry);
            }
        }
        // The bucket is empty: its entries went to `near` or to lower buckets. It keeps its memory.
        self.far[lowest] = bucket;
    }

    /// Removes the entries for which `keep` is false. Looks at every entry.
    #[cold]
    pub(super) fn retain(&mut self, mut keep: impl FnMut(&Entry) -> bool) {
        self.near.retain(&mut keep);
        for (bit, bucket) in self.far.iter_mut().enumerate() {
            bucket.retain(&mut keep);
            if bucket.is_empty() {
                self.occupied &= !(1 << bit);
            }
        }
    }

    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.near.len() + self.far.iter().map(Vec::len).sum::<usize>()
    }
}
