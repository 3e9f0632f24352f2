//! The runs of each cell in a few numbers.

use std::iter::Peekable;

use sextant::summary::Measure;

use super::average::Average;
use super::error::TableError;
use super::plan::Sweep;
use super::row::RunRow;
use super::rows::{RowIter, Rows};
use super::statistics::Sums;

/// The runs of a cell in a few numbers.
#[derive(Clone, Debug)]
pub struct CellSummary {
    /// How many succeeded.
    pub succeeded: usize,
    /// How many failed.
    pub failed: usize,
    /// Of each measure of the plan.
    sums: Vec<Sums>,
}

impl CellSummary {
    /// The average of a measure of `plan` over the runs that succeeded: of an outcome the share of the runs in which it
    /// happened, and the mean of others. `None` if there are none, or it does not apply.
    #[must_use]
    pub fn average(&self, plan: &Sweep, measure: &Measure) -> Option<Average> {
        let at = plan.measures().iter().position(|other| other == measure)?;
        Average::of_sums(measure.unit(), self.sums.get(at)?)
    }
}

/// The summaries of the cells of `plan`, from the first one on. Rows are read twice and not kept.
pub fn summaries(plan: &Sweep, rows: &dyn Rows) -> impl Iterator<Item = Result<CellSummary, TableError>> {
    let (mut first, mut second) = (rows.read().peekable(), rows.read().peekable());
    (0..plan.cells().len()).map(move |cell| {
        let mut summary = CellSummary { succeeded: 0, failed: 0, sums: vec![Sums::default(); plan.measures().len()] };
        while let Some(row) = next_of(&mut first, cell) {
            match row?.outcome {
                Err(_) => summary.failed += 1,
                Ok(values) => {
                    summary.succeeded += 1;
                    summary.add(&values, Sums::add);
                }
            }
        }
        while let Some(row) = next_of(&mut second, cell) {
            if let Ok(values) = row?.outcome {
                summary.add(&values, Sums::add_deviation);
            }
        }
        Ok(summary)
    })
}

impl CellSummary {
    fn add(&mut self, values: &[Option<f64>], add: fn(&mut Sums, f64)) {
        for (sums, value) in self.sums.iter_mut().zip(values) {
            if let Some(value) = value {
                add(sums, *value);
            }
        }
    }
}

/// The next row if it is of this cell, or an error.
fn next_of(rows: &mut Peekable<RowIter<'_>>, cell: usize) -> Option<Result<RunRow, TableError>> {
    rows.next_if(|row| row.as_ref().map_or(true, |row| row.cell == cell))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::table_reader::tests::{STEPS, made_up, plan};

    #[test]
    fn a_summary_has_the_means_of_the_rows_of_its_cell() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path(), STEPS, 2);
        let rows = made_up(&plan);
        let found: Vec<CellSummary> = summaries(&plan, &rows.as_slice()).map(Result::unwrap).collect();
        let counts: Vec<_> = found.iter().map(|cell| (cell.succeeded, cell.failed)).collect();
        assert_eq!(counts, [(2, 0), (1, 1)]);
        for (cell, summary) in found.iter().enumerate() {
            for measure in plan.measures() {
                let values: Vec<f64> =
                    plan.values_of(&rows, cell, measure).into_iter().map(|(_, value)| value).collect();
                let expected = Average::of(measure.unit(), &values);
                assert_eq!(summary.average(&plan, measure), expected, "{}", measure.path());
            }
        }
    }
}
