//! The rows of a sweep, wherever they are.

use std::cmp::Ordering;
use std::iter::Peekable;

use sextant_recording::output::store::StoreError;

use super::error::TableError;
use super::finished_runs::FinishedRuns;
use super::row::RunRow;
use super::run_places::RunPlaces;
use super::work_list::CellRun;

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

    fn add_values(&mut self, values: impl ExactSizeIterator<Item = bool>) {
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

/// Rows of finished runs in a store.
#[derive(Debug)]
pub struct StoredRows<'a> {
    runs: FinishedRuns<'a>,
    places: RunPlaces,
}

impl<'a> StoredRows<'a> {
    pub(crate) fn new(runs: FinishedRuns<'a>, places: RunPlaces) -> Self {
        Self { runs, places }
    }
}

impl Rows for StoredRows<'_> {
    fn overview(&self) -> Overview {
        Overview {
            rows: self.places.count(),
            failed: self.places.failed().len(),
            has_value: self.places.has_value().to_vec(),
        }
    }

    fn read(&self) -> RowIter<'_> {
        let sweep = self.runs.sweep();
        let runs = (0..sweep.cells().len())
            .flat_map(|cell| (0..sweep.runs()).map(move |replicate| CellRun { cell, replicate }));
        let numbers = runs.filter_map(|run| sweep.work().number_of(run));
        Box::new(self.runs.rows(&self.places, numbers).map(|row| row.map_err(TableError::from)))
    }
}

/// Rows that were there before, and those of the runs that were missing.
#[derive(Debug)]
pub struct SweptRows<'a> {
    known: Vec<RunRow>,
    new: StoredRows<'a>,
}

impl<'a> SweptRows<'a> {
    pub(super) fn new(known: Vec<RunRow>, new: StoredRows<'a>) -> Self {
        Self { known, new }
    }
}

impl Rows for SweptRows<'_> {
    fn overview(&self) -> Overview {
        let (mut overview, new) = (self.known.as_slice().overview(), self.new.overview());
        overview.rows += new.rows;
        overview.failed += new.failed;
        overview.add_values(new.has_value.into_iter());
        overview
    }

    fn read(&self) -> RowIter<'_> {
        let known: RowIter = Box::new(self.known.iter().cloned().map(Ok));
        Box::new(Merged { known: known.peekable(), new: self.new.read().peekable() })
    }
}

/// Two lists of rows as one.
struct Merged<'a> {
    known: Peekable<RowIter<'a>>,
    new: Peekable<RowIter<'a>>,
}

impl Iterator for Merged<'_> {
    type Item = Result<RunRow, TableError>;

    fn next(&mut self) -> Option<Self::Item> {
        let order = match (self.known.peek(), self.new.peek()) {
            (Some(Ok(known)), Some(Ok(new))) => known.run().cmp(&new.run()),
            (Some(_), _) => Ordering::Less,
            (None, _) => Ordering::Greater,
        };
        if order == Ordering::Less { self.known.next() } else { self.new.next() }
    }
}

impl From<StoreError> for TableError {
    fn from(error: StoreError) -> Self {
        Self::Rows { why: error.to_string() }
    }
}
