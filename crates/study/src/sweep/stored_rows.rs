//! The rows of a sweep that are on the disk.

use std::cmp::Ordering;
use std::iter::Peekable;

use super::error::TableError;
use super::finished_runs::FinishedRuns;
use super::row::RunRow;
use super::rows::{Overview, RowIter, Rows};
use super::run_places::RunPlaces;
use super::table_reader::TableRows;
use super::work_list::CellRun;

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

/// The rows of a table that was there before, and those of the runs that it had not.
#[derive(Debug)]
pub struct SweptRows<'a> {
    known: Option<TableRows<'a>>,
    new: StoredRows<'a>,
}

impl<'a> SweptRows<'a> {
    pub(super) fn new(known: Option<TableRows<'a>>, new: StoredRows<'a>) -> Self {
        Self { known, new }
    }
}

impl Rows for SweptRows<'_> {
    fn overview(&self) -> Overview {
        let mut overview = self.new.overview();
        if let Some(known) = self.known.as_ref().map(Rows::overview) {
            overview.rows += known.rows;
            overview.failed += known.failed;
            overview.add_values(known.has_value.into_iter());
        }
        overview
    }

    fn read(&self) -> RowIter<'_> {
        match &self.known {
            None => self.new.read(),
            Some(known) => Box::new(Merged { known: known.read().peekable(), new: self.new.read().peekable() }),
        }
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
        if order == Ordering::Equal {
            // The table was replaced meanwhile by one that has all rows.
            self.new.next();
        }
        if order == Ordering::Greater { self.new.next() } else { self.known.next() }
    }
}
