//! The rows of a sweep, wherever they are.

use super::error::TableError;
use super::row::RunRow;

/// The rows of a sweep by cell, then replicate. They are read as often as is needed, and need not be in memory.
pub trait Rows {
    /// What is known of all of them.
    fn overview(&self) -> Overview;

    /// Reads them from the first one on.
    fn read(&self) -> RowIter<'_>;
}

/// Rows that are read one after the other.
pub type RowIter<'a> = Box<dyn Iterator<Item = Result<RunRow, TableError>> + 'a>;

/// What is known of all rows of a sweep.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Overview {
    /// Number of rows.
    pub rows: usize,
    /// How many of them are of runs that failed.
    pub failed: usize,
    /// Of each measure of the plan, whether any run has a value.
    pub has_value: Vec<bool>,
}

impl Overview {
    /// Adds a row.
    pub(super) fn add(&mut self, row: &RunRow) {
        self.rows += 1;
        match &row.outcome {
            Err(_) => self.failed += 1,
            Ok(values) => self.add_values(values.iter().map(Option::is_some)),
        }
    }

    pub(super) fn add_values(&mut self, values: impl ExactSizeIterator<Item = bool>) {
        self.has_value.resize(values.len().max(self.has_value.len()), false);
        values.zip(&mut self.has_value).for_each(|(value, has)| *has |= value);
    }
}

impl Rows for &[RunRow] {
    fn overview(&self) -> Overview {
        let mut overview = Overview::default();
        self.iter().for_each(|row| overview.add(row));
        overview
    }

    fn read(&self) -> RowIter<'_> {
        Box::new(self.iter().cloned().map(Ok))
    }
}
