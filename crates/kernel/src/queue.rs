//! The queue of events to come.
//!
//! A monotone radix heap over instants with a 4-ary heap in front, events in a slab. Chosen because at 500 to
//! 10⁴ pending events, about one a node, an event takes 0.55 to 0.85 of its time in a 4-ary heap alone, with
//! ties and without, and at 10⁶ still 0.4 to 0.6 (bench `event_queue`).
//! Rejected: a 4-ary heap alone, by these figures; a calendar queue, as fast up to 500 but 1.5 to 5 times
//! slower at 10⁶, because the width of its days is a guess from a sample that mixed gaps mislead.

mod entry;
mod quad_heap;
mod radix_heap;
mod slab;

use crate::{NodeId, SimTime};
use entry::Entry;
use radix_heap::RadixHeap;
use slab::Slab;

/// Place of an event among those of the same instant: class first, node next, then order of insertion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Rank {
    class: u8,
    node: NodeId,
}

impl Rank {
    /// Events of the lower class leave first; within a class those of the lower node.
    #[must_use]
    pub const fn new(class: u8, node: NodeId) -> Self {
        Self { class, node }
    }
}

/// Handle of a pending event, for [`EventQueue::cancel`]. Never names another event of the same queue,
/// also after its own has left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EventKey {
    insertion: u64,
    slot: u32,
}

/// Pending events, which leave in the order of their instants; those of one instant by [`Rank`], and those
/// of equal rank in the order in which they were pushed.
///
/// Time goes forward only: an event may be pushed at the instant of the last one that left, or later.
/// An entry moves at most once a bit of its distance in time [ns], besides within a heap of the next few;
/// no event allocates once the queue has seen its greatest size.
///
/// ```
/// use sextant_kernel::{EventQueue, NodeId, Rank, SimTime};
///
/// let mut queue = EventQueue::new();
/// let rank = Rank::new(5, NodeId(0));
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

/// Cancelled entries that are borne however few events are pending, so that small queues are not swept.
const CANCELLED_BORNE: usize = 64;

impl<E> EventQueue<E> {
    /// An empty queue at the start of time.
    #[must_use]
    pub fn new() -> Self {
        Self {
            pending: RadixHeap::default(),
            events: Slab::default(),
            cancelled: 0,
            insertions: 0,
            now: SimTime::ZERO,
        }
    }

    /// Adds an event that is to leave at the instant `at`.
    ///
    /// # Panics
    /// If `at` is before [`now`](Self::now): an event in the past is a bug of the caller. At 2³² pending
    /// events.
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
    /// Mutable, because the queue sorts no further ahead than it was asked to look.
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

    /// Takes a pending event back; `None` if it has left or was cancelled before. Constant time, amortised.
    #[inline]
    pub fn cancel(&mut self, key: EventKey) -> Option<E> {
        let event = self.events.take(key)?;
        // The entry stays until its instant comes or until such entries are the majority.
        self.cancelled += 1;
        if self.cancelled > self.len() + CANCELLED_BORNE {
            self.pending.retain(|entry| self.events.holds(entry.key()));
            self.cancelled = 0;
        }
        Some(event)
    }

    /// Instant of the event that left last; the start of time before the first.
    #[must_use]
    pub const fn now(&self) -> SimTime {
        self.now
    }

    /// Number of pending events.
    #[must_use]
    pub fn len(&self) -> usize {
        self.events.len()
    }

    /// Whether nothing is pending.
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

    const RANK: Rank = Rank::new(5, NodeId(3));

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
    fn places_are_used_again() {
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
        // The entry that is sorted (three words), and the event with its insertion number and presence.
        let sizes = [size_of::<Entry>(), Slab::<[u64; 3]>::SLOT_OCTETS, Slab::<Rank>::SLOT_OCTETS];
        assert_eq!(sizes, [24, 40, 24]);
    }
}
