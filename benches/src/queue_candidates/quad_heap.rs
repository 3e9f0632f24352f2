//! A 4-ary heap for all entries. The kernel has one in front of its radix heap.

use super::{Entry, Order};

/// A heap with four children for each parent.
#[derive(Default)]
pub struct QuadHeap(Vec<Entry>);

impl Order for QuadHeap {
    #[inline]
    fn push(&mut self, entry: Entry) {
        let mut hole = self.0.len();
        self.0.push(entry);
        while hole > 0 {
            let parent = (hole - 1) / 4;
            if entry >= self.0[parent] {
                break;
            }
            self.0[hole] = self.0[parent];
            hole = parent;
        }
        self.0[hole] = entry;
    }

    #[inline]
    fn pop(&mut self) -> Option<Entry> {
        let last = self.0.pop()?;
        let entries = &mut self.0[..];
        let Some(&top) = entries.first() else {
            return Some(last);
        };
        let mut hole = 0;
        while let Some(child) = least_child(entries, hole) {
            if last <= entries[child] {
                break;
            }
            entries[hole] = entries[child];
            hole = child;
        }
        entries[hole] = last;
        Some(top)
    }
}

#[inline]
fn least_child(entries: &[Entry], parent: usize) -> Option<usize> {
    let first = 4 * parent + 1;
    if let Some(children) = entries.get(first..first + 4) {
        let left = usize::from(children[1] < children[0]);
        let right = 2 + usize::from(children[3] < children[2]);
        Some(first + if children[right] < children[left] { right } else { left })
    } else {
        (first..entries.len()).min_by_key(|&child| entries[child])
    }
}
