//! The queue of pending events.
//!
//! A monotone radix heap over instants with a sorted bucket in front; the events are in a slab. What is pushed while time goes
//! over that bucket is in a 4-ary heap. With that heap in front instead of the bucket, saturated networks took a tenth longer.
//!
//! That older queue was measured beside a 4-ary heap alone under the load of the bench `event_queue`. An event took 0.55 to 0.85
//! of the time with 500 to 10⁴ pending events (about one per node), with and without ties, and 0.4 to 0.6 with 10⁶.
//! Rejected: a 4-ary heap alone, because of these figures. Also a calendar queue, because it is as fast with up to
//! 500 events but 1.5 to 5 times slower with 10⁶. It guesses the width of its days from a sample, and mixed gaps
//! mislead that guess.

mod entry;
mod quad_heap;
mod radix_heap;
mod slab;

use crate::{SimTime, StationId};
use entry::Entry;
use radix_heap::RadixHeap;
use slab::Slab;

/// Order of an event among those of the same instant: by class, then by station, then by insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rank {
    class: u8,
    station: StationId,
}

impl Rank {
    /// Events of the lower class leave first; within a class, events of the lower station.
    #[must_use]
    #[inline]
    pub const fn new(class: u8, station: StationId) -> Self {
        Self { class, station }
    }
}

/// Handle of a pending event, for [`EventQueue::cancel`]. It never refers to another event of the same queue,
/// even after its own event has left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EventKey {
    insertion: u64,
    slot: u32,
}

/// Pending events. They leave in the order of their instants; events of one instant leave by [`Rank`], and events
/// of equal rank in the order in which they were pushed.
///
/// Time goes forward only: an event may be pushed at the instant of the last one that left, or later.
/// An entry moves at most once per bit of its distance in time (ns), apart from moves in a small heap of the next
/// events. No event allocates once the queue has reached its greatest size.
///
/// ```
/// use sextant_kernel::{EventQueue, StationId, Rank, SimTime};
///
/// let mut queue = EventQueue::new();
/// let rank = Rank::new(5, StationId(0));
/// let timeout = queue.push(SimTime::from_nanos(864_000), rank, "no acknowledgement");
/// queue.push(SimTime::from_nanos(544_000), rank, "acknowledged");
/// assert_eq!(queue.pop(), Some((SimTime::from_nanos(544_000), "acknowledged")));
/// assert_eq!(queue.cancel(timeout), Some("no acknowledgement"));
/// assert_eq!(queue.pop(), None);
/// ```
pub struct EventQueue<E> {
    pending: RadixHeap,
    events: Slab<E>,
    /// Entries in `pending` whose event was cancelled.
    cancelled: usize,
    /// Events ever pushed.
    insertions: u64,
    now: SimTime,
}

/// Number of cancelled entries that are always tolerated, so that small queues are not swept.
const CANCELLED_BORNE: usize = 64;

impl<E> EventQueue<E> {
    /// An empty queue at the start of time.
    #[must_use]
    #[inline]
    pub fn new() -> Self {
        Self {
            pending: RadixHeap::default(),
            events: Slab::default(),
            cancelled: 0,
            insertions: 0,
            now: SimTime::ZERO,
        }
    }

    /// Adds an event that leaves at the instant `at`.
    ///
    /// # Panics
    /// If `at` is before [`now`](Self::now): an event in the past is a bug of the caller. Also if 2³² events are
    /// pending.
    #[inline]
    pub fn push(&mut self, at: SimTime, rank: Rank, event: E) -> EventKey {
        assert!(at >= self.now, "an event was pushed at {at}, but the queue has reached {} already", self.now);
        let insertion = self.insertions;
        self.insertions += 1;
        let key = self.events.insert(insertion, event);
        self.pending.push(Entry::new(at, rank, key));
        key
    }

    /// Takes the next event and its instant.
    #[inline]
    pub fn pop(&mut self) -> Option<(SimTime, E)> {
        loop {
            let entry = self.pending.pop()?;
            if let Some(event) = self.events.take(entry.key()) {
                self.now = entry.time();
                return Some((self.now, event));
            }
            self.cancelled -= 1;
        }
    }

    /// Instant of the next event. Does not move [`now`](Self::now): earlier events may still be pushed.
    /// Needs `&mut self`, because the queue sorts only as far ahead as it is asked to look.
    #[inline]
    pub fn peek_time(&mut self) -> Option<SimTime> {
        loop {
            let entry = self.pending.peek()?;
            if self.events.holds(entry.key()) {
                return Some(entry.time());
            }
            self.pending.pop();
            self.cancelled -= 1;
        }
    }

    /// Cancels a pending event and returns it; `None` if it has already left or been cancelled. Amortised constant
    /// time.
    #[inline]
    pub fn cancel(&mut self, key: EventKey) -> Option<E> {
        let event = self.events.take(key)?;
        // The entry stays until its instant comes or until cancelled entries are the majority.
        self.cancelled += 1;
        if self.cancelled > self.len() + CANCELLED_BORNE {
            self.pending.retain(|entry| self.events.holds(entry.key()));
            self.cancelled = 0;
        }
        Some(event)
    }

    /// Instant of the event that left last; zero before the first.
    #[must_use]
    pub const fn now(&self) -> SimTime {
        self.now
    }

    /// Number of pending events.
    #[must_use]
    pub fn len(&self) -> usize {
        self.events.len()
    }

    /// Whether no event is pending.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl<E> Default for EventQueue<E> {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RANK: Rank = Rank::new(5, StationId(3));

    #[test]
    fn timers_that_are_always_cancelled_do_not_pile_up() {
        let mut queue = EventQueue::new();
        for i in 0..100_000_u64 {
            let key = queue.push(SimTime::from_nanos(1_000_000 + i), RANK, i);
            assert_eq!(queue.cancel(key), Some(i));
            assert!(queue.pending.len() <= CANCELLED_BORNE + 1);
        }
        assert_eq!((queue.pop(), queue.events.slots()), (None, 1));
    }

    #[test]
    fn cancelled_entries_are_counted_until_they_leave() {
        let mut queue = EventQueue::new();
        let at = |i: u64| SimTime::from_nanos(i * 1_000);
        let keys: Vec<EventKey> = (0..10).map(|i| queue.push(at(i), RANK, i)).collect();
        for key in &keys[..6] {
            queue.cancel(*key);
        }
        assert_eq!((queue.cancelled, queue.len(), queue.pending.len()), (6, 4, 10));
        assert_eq!((queue.peek_time(), queue.cancelled), (Some(at(6)), 0));
        queue.cancel(keys[7]);
        queue.cancel(keys[8]);
        assert_eq!((queue.pop(), queue.cancelled), (Some((at(6), 6)), 2));
        assert_eq!((queue.pop(), queue.cancelled), (Some((at(9), 9)), 0));
        assert_eq!((queue.now(), queue.is_empty()), (at(9), true));
    }

    #[test]
    fn cancelled_entries_are_swept_when_they_are_the_majority() {
        let mut queue = EventQueue::new();
        let keys: Vec<EventKey> = (0..200).map(|i| queue.push(SimTime::from_nanos(i), RANK, i)).collect();
        // Of 200 events, 132 cancelled ones are no more than the 68 that are left and the 64 that are tolerated.
        for key in &keys[..132] {
            queue.cancel(*key);
        }
        assert_eq!((queue.cancelled, queue.len(), queue.pending.len()), (132, 68, 200));
        queue.cancel(keys[132]);
        assert_eq!((queue.cancelled, queue.len(), queue.pending.len()), (0, 67, 67));
    }

    #[test]
    fn freed_slots_are_reused() {
        let mut queue = EventQueue::new();
        for i in 0..100 {
            queue.push(SimTime::from_nanos(i * 64_000), RANK, i);
        }
        for _ in 0..10_000 {
            let (at, event) = queue.pop().expect("100 pending events");
            queue.push(at + std::time::Duration::from_micros(320 * (event % 7)), RANK, event);
        }
        assert_eq!((queue.len(), queue.pending.len(), queue.events.slots()), (100, 100, 100));
    }

    #[test]
    fn an_event_of_three_words_takes_eight_words() {
        // The entry that is sorted takes three words; the event, its insertion number and its presence take the rest.
        let sizes = [size_of::<Entry>(), Slab::<[u64; 3]>::SLOT_OCTETS, Slab::<Rank>::SLOT_OCTETS];
        assert_eq!(sizes, [24, 40, 24]);
    }
}
