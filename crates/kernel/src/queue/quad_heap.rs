//! A heap with four children per parent: half the levels of a binary heap, and siblings adjacent in memory.

use super::entry::Entry;

const CHILDREN: usize = 4;

/// Entries, the smallest on top.
#[derive(Default)]
pub(super) struct QuadHeap {
    entries: Vec<Entry>,
}

impl QuadHeap {
    #[inline]
    pub(super) fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    #[cfg(test)]
    pub(super) fn len(&self) -> usize {
        self.entries.len()
    }

    #[inline]
    pub(super) fn peek(&self) -> Option<&Entry> {
        self.entries.first()
    }

    #[inline]
    pub(super) fn push(&mut self, entry: Entry) {
        let mut hole = self.entries.len();
        self.entries.push(entry);
        let entries = &mut self.entries[..];
        while hole > 0 {
            let parent = (hole - 1) / CHILDREN;
            if entry >= entries[parent] {
                break;
            }
            entries[hole] = entries[parent];
            hole = parent;
        }
        entries[hole] = entry;
    }

    #[inline]
    pub(super) fn pop(&mut self) -> Option<Entry> {
        let last = self.entries.pop()?;
        let entries = &mut self.entries[..];
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

    /// Removes the entries for which `keep` is false.
    pub(super) fn retain(&mut self, keep: impl FnMut(&Entry) -> bool) {
        self.entries.retain(keep);
        // Sorted entries are a heap.
        self.entries.sort_unstable();
    }
}

/// Index of the smallest child of `parent`; `None` at a leaf.
#[inline]
fn least_child(entries: &[Entry], parent: usize) -> Option<usize> {
    let first = CHILDREN * parent + 1;
    if let Some(children) = entries.get(first..first + CHILDREN) {
        // Two pairs, then a final: a shorter chain of comparisons than one after the other.
        let left = usize::from(children[1] < children[0]);
        let right = 2 + usize::from(children[3] < children[2]);
        Some(first + if children[right] < children[left] { right } else { left })
    } else {
        (first..entries.len()).min_by_key(|&child| entries[child])
    }
}
