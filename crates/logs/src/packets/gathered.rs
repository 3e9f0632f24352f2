//! Rows with a key that come one by one in any order; those with the same key are merged.

/// A row of which those with the same key are one.
pub(crate) trait Keyed {
    /// What tells rows apart, and their order.
    type Key: Ord;

    fn key(&self) -> Self::Key;

    /// Adds a later row with the same key.
    fn add(&mut self, later: &Self);
}

/// Merged rows. Takes the memory of about twice as many rows as there are keys, however many rows come.
#[derive(Clone, Debug)]
pub(crate) struct Gathered<T> {
    rows: Vec<T>,
    /// Rows are merged when there are this many.
    limit: usize,
    /// Rows that were merged into others.
    merged: usize,
}

/// Fewest rows that are worth merging.
const FEWEST: usize = 1 << 16;

impl<T: Keyed> Gathered<T> {
    pub(crate) fn new() -> Self {
        Self { rows: Vec::new(), limit: FEWEST, merged: 0 }
    }

    pub(crate) fn push(&mut self, row: T) {
        // Rows of one key often follow each other.
        if let Some(last) = self.rows.last_mut()
            && last.key() == row.key()
        {
            last.add(&row);
            self.merged += 1;
            return;
        }
        if self.rows.len() == self.limit {
            self.merge();
            self.limit = (2 * self.rows.len()).max(FEWEST);
        }
        self.rows.push(row);
    }

    /// Merges the rows, in the order in which they came.
    fn merge(&mut self) {
        if !self.rows.is_sorted_by(|a, b| a.key() < b.key()) {
            self.rows.sort_by_key(T::key);
            let before = self.rows.len();
            self.rows.dedup_by(|later, row| {
                let is_same = later.key() == row.key();
                if is_same {
                    row.add(later);
                }
                is_same
            });
            self.merged += before - self.rows.len();
        }
    }

    /// The rows in the order of their keys, each key once, and how many rows were merged into others.
    pub(crate) fn finish(mut self) -> (Vec<T>, usize) {
        self.merge();
        (self.rows, self.merged)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    #[derive(Clone, Debug, PartialEq)]
    struct NumberedRow(u64, Vec<u32>);

    impl Keyed for NumberedRow {
        type Key = u64;

        fn key(&self) -> u64 {
            self.0
        }

        fn add(&mut self, later: &Self) {
            self.1.extend(&later.1);
        }
    }

    #[test]
    fn rows_are_merged_in_the_order_in_which_they_came() {
        for (rows, keys) in [(0_u32, 1_u64), (1, 1), (1000, 7), (300_000, 50), (200_000, 1 << 40)] {
            let mut gathered = Gathered::new();
            let mut expected = std::collections::BTreeMap::<u64, Vec<u32>>::new();
            for at in 0..rows {
                let draw = Seed(3).uniform(Purpose::new(8), [u64::from(at), 0, 0]).to_bits() >> 20;
                let key = draw % keys;
                gathered.push(NumberedRow(key, vec![at]));
                expected.entry(key).or_default().push(at);
                assert!(gathered.rows.len() <= FEWEST.max(2 * expected.len()));
            }
            let (found, merged) = gathered.finish();
            assert_eq!(merged, rows as usize - expected.len());
            assert_eq!(found, expected.into_iter().map(|(key, all)| NumberedRow(key, all)).collect::<Vec<_>>());
        }
    }
}
