//! Event queues that are slower than the kernel's. They have the same slab and the same packed order of events, but
//! another sorting structure. Cancelled entries stay in the queue until their time comes.

mod binary_heap;
mod calendar;
mod quad_heap;

pub use binary_heap::StdHeap;
pub use calendar::Calendar;
pub use quad_heap::QuadHeap;

use sextant_kernel::{EventQueue, Rank, SimTime, StationId};

/// The operations of an event queue that a benchmark uses.
pub trait Queue<E>: Default {
    /// Handle of a pending event.
    type Key: Copy;

    /// Adds an event of a class and a node at an instant.
    fn push(&mut self, at: SimTime, class: u8, node: StationId, event: E) -> Self::Key;
    /// Takes the next event.
    fn pop(&mut self) -> Option<(SimTime, E)>;
    /// Cancels a pending event.
    fn cancel(&mut self, key: Self::Key) -> Option<E>;
}

impl<E> Queue<E> for EventQueue<E> {
    type Key = sextant_kernel::EventKey;

    #[inline]
    fn push(&mut self, at: SimTime, class: u8, node: StationId, event: E) -> Self::Key {
        self.push(at, Rank::new(class, node), event)
    }

    #[inline]
    fn pop(&mut self) -> Option<(SimTime, E)> {
        self.pop()
    }

    #[inline]
    fn cancel(&mut self, key: Self::Key) -> Option<E> {
        self.cancel(key)
    }
}

/// Place of an event in the order, and its slot in the slab: 24 octets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Entry {
    /// Instant.
    pub time: SimTime,
    /// Class (8 bits), node (32 bits), upper 24 bits of the insertion number.
    rank: u64,
    insertion_low: u32,
    slot: u32,
}

/// A structure that sorts entries.
pub trait Order: Default {
    /// Adds an entry.
    fn push(&mut self, entry: Entry);
    /// Takes the least entry.
    fn pop(&mut self) -> Option<Entry>;
}

/// An event queue around a structure that sorts.
pub struct Candidate<E, O> {
    order: O,
    slots: Vec<(u64, Option<E>)>,
    vacant: Vec<u32>,
    insertions: u64,
}

impl<E, O: Order> Default for Candidate<E, O> {
    fn default() -> Self {
        Self { order: O::default(), slots: Vec::new(), vacant: Vec::new(), insertions: 0 }
    }
}

/// Insertion number and slot of a pending event.
pub type CandidateKey = (u64, u32);

impl<E, O: Order> Queue<E> for Candidate<E, O> {
    type Key = CandidateKey;

    #[inline]
    fn push(&mut self, at: SimTime, class: u8, node: StationId, event: E) -> CandidateKey {
        let insertion = self.insertions;
        self.insertions += 1;
        let filled = (insertion, Some(event));
        let slot = if let Some(slot) = self.vacant.pop() {
            self.slots[slot as usize] = filled;
            slot
        } else {
            self.slots.push(filled);
            u32::try_from(self.slots.len() - 1).expect("fewer than 2^32 pending events")
        };
        #[expect(clippy::cast_possible_truncation, reason = "the lower half; the upper one is in `rank`")]
        let insertion_low = insertion as u32;
        self.order.push(Entry {
            time: at,
            rank: u64::from(class) << 56 | u64::from(node.0) << 24 | insertion >> 32,
            insertion_low,
            slot,
        });
        (insertion, slot)
    }

    #[inline]
    fn pop(&mut self) -> Option<(SimTime, E)> {
        loop {
            let entry = self.order.pop()?;
            let insertion = (entry.rank & 0xFF_FFFF) << 32 | u64::from(entry.insertion_low);
            if let Some(event) = self.cancel((insertion, entry.slot)) {
                return Some((entry.time, event));
            }
        }
    }

    #[inline]
    fn cancel(&mut self, (insertion, slot): CandidateKey) -> Option<E> {
        let place = &mut self.slots[slot as usize];
        let event = place.1.take_if(|_| place.0 == insertion)?;
        self.vacant.push(slot);
        Some(event)
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use sextant_kernel::{Purpose, Seed};

    use super::*;

    /// Instants and nodes in the order in which they leave; one node in four is cancelled and pushed anew.
    fn history<Q: Queue<StationId>>() -> Vec<(SimTime, StationId)> {
        let draw = |place| Seed(3).bits(Purpose::new(2), [place, 0, 0]);
        let gap = |place| Duration::from_micros(64 * (draw(place) % 40).pow(3));
        let mut queue = Q::default();
        let mut keys: Vec<_> =
            (0..500).map(|node| queue.push(SimTime::ZERO, 0, StationId(node), StationId(node))).collect();
        let mut left = Vec::new();
        for step in 0..20_000 {
            let (at, node) = queue.pop().expect("as many events as nodes");
            left.push((at, node));
            keys[node.index()] = queue.push(at + gap(step), 1, node, node);
            let other = (node.index() * 7 + 3) % keys.len();
            if step % 4 == 0 {
                let node = queue.cancel(keys[other]).expect("one event a node");
                keys[other] = queue.push(at + gap(step + 50_000), 2, node, node);
            }
        }
        left.extend(std::iter::from_fn(|| queue.pop()));
        left
    }

    #[test]
    fn every_candidate_keeps_the_order_of_the_kernel() {
        let kernel = history::<EventQueue<_>>();
        assert_eq!(kernel.len(), 20_500);
        assert_eq!(history::<Candidate<_, StdHeap>>(), kernel);
        assert_eq!(history::<Candidate<_, QuadHeap>>(), kernel);
        assert_eq!(history::<Candidate<_, Calendar>>(), kernel);
    }
}
