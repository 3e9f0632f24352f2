//! The heap of the standard library.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::{Entry, Order};

/// A binary heap.
#[derive(Default)]
pub struct StdHeap(BinaryHeap<Reverse<Entry>>);

impl Order for StdHeap {
    #[inline]
    fn push(&mut self, entry: Entry) {
        self.0.push(Reverse(entry));
    }

    #[inline]
    fn pop(&mut self) -> Option<Entry> {
        self.0.pop().map(|Reverse(entry)| entry)
    }
}
