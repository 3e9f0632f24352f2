//! The order of the work of a sweep.

use std::ops::Range;

use sextant::NumberRange;

/// The runs of a sweep in the order in which they are done, numbered from 0. Runs that share a survey follow one another:
/// by survey, then replicate, then cell.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WorkList {
    /// The cells, by survey.
    cells: Vec<usize>,
    /// Where each cell stands in `cells`.
    places: Vec<usize>,
    /// Where the cells of each survey begin in `cells`, and the end of the last.
    starts: Vec<usize>,
    /// Runs of each cell.
    runs: usize,
}

/// A run of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct CellRun {
    /// Number of the cell, from 0.
    pub cell: usize,
    /// Number of the run, from 0.
    pub replicate: u32,
}

/// The smallest part of a sweep: one survey and the cells that share it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Unit {
    pub(crate) replicate: u32,
    pub(crate) cells: Vec<usize>,
}

impl WorkList {
    /// The list of cells with these `surveys`, each of which has this many `runs`.
    pub(super) fn of(surveys: &[usize], runs: u32) -> Self {
        let count = surveys.iter().map(|survey| survey + 1).max().unwrap_or(0);
        let mut starts = vec![0; count + 1];
        for survey in surveys {
            starts[survey + 1] += 1;
        }
        for survey in 0..count {
            starts[survey + 1] += starts[survey];
        }
        let mut next = starts.clone();
        let (mut order, mut places) = (vec![0; surveys.len()], vec![0; surveys.len()]);
        for (i, &survey) in surveys.iter().enumerate() {
            let place = next[survey];
            next[survey] += 1;
            (order[place], places[i]) = (i, place);
        }
        Self { cells: order, places, starts, runs: runs as usize }
    }

    /// Number of runs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.cells.len() * self.runs
    }

    /// Whether there is nothing to do.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The run with this number.
    ///
    /// # Panics
    /// If there is none.
    #[must_use]
    pub fn get(&self, number: usize) -> CellRun {
        let (unit, within) = self.unit_at(number);
        let survey = unit / self.runs;
        CellRun { cell: self.cells[self.starts[survey] + within], replicate: self.replicate(unit) }
    }

    /// The number of a run; `None` if it is none of the sweep.
    #[must_use]
    pub fn number_of(&self, run: CellRun) -> Option<usize> {
        let place = *self.places.get(run.cell)?;
        let survey = self.starts.partition_point(|&start| start <= place) - 1;
        let (start, end) = (self.starts[survey], self.starts[survey + 1]);
        let replicate = run.replicate as usize;
        (replicate < self.runs).then(|| self.runs * start + replicate * (end - start) + (place - start))
    }

    /// The numbers of the runs that share a survey with run `number`.
    #[must_use]
    pub fn shared(&self, number: usize) -> Range<usize> {
        let (unit, within) = self.unit_at(number);
        let survey = unit / self.runs;
        let first = number - within;
        first..first + self.starts[survey + 1] - self.starts[survey]
    }

    /// The number of the survey of run `number`: runs with the same one share it.
    #[must_use]
    pub(crate) fn survey_of(&self, number: usize) -> usize {
        self.unit_at(number).0
    }

    /// Number of units.
    pub(crate) fn unit_count(&self) -> usize {
        (self.starts.len() - 1) * self.runs
    }

    /// All units.
    pub(crate) fn units(&self) -> impl Iterator<Item = Unit> {
        (0..self.unit_count()).map(|index| self.unit(index, |_| true))
    }

    /// The numbers of the units that have any of these runs.
    pub(crate) fn unit_indices(&self, runs: NumberRange) -> Range<usize> {
        if runs.is_empty() { 0..0 } else { self.unit_at(runs.start).0..self.unit_at(runs.end - 1).0 + 1 }
    }

    /// The numbers of the runs of unit `index`.
    pub(crate) fn numbers(&self, index: usize) -> Range<usize> {
        let (survey, replicate) = (index / self.runs, index % self.runs);
        let (start, end) = (self.starts[survey], self.starts[survey + 1]);
        let first = self.runs * start + replicate * (end - start);
        first..first + (end - start)
    }

    /// The unit `index` with only the cells of the runs that are wanted, by their numbers.
    pub(crate) fn unit(&self, index: usize, is_wanted: impl Fn(&usize) -> bool) -> Unit {
        let cells = self.numbers(index).filter(is_wanted).map(|number| self.get(number).cell).collect();
        Unit { replicate: self.replicate(index), cells }
    }

    /// The unit of run `number`, and which of its runs this is.
    fn unit_at(&self, number: usize) -> (usize, usize) {
        assert!(number < self.len(), "there is no run {number}");
        let survey = self.starts.partition_point(|&start| start * self.runs <= number) - 1;
        let (start, end) = (self.starts[survey], self.starts[survey + 1]);
        let within = number - self.runs * start;
        (survey * self.runs + within / (end - start), within % (end - start))
    }

    #[expect(clippy::cast_possible_truncation, reason = "the number of runs is a u32")]
    fn replicate(&self, unit: usize) -> u32 {
        (unit % self.runs) as u32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_share_a_survey_follow_one_another() {
        let list = WorkList::of(&[0, 1, 0], 2);
        let runs: Vec<_> = (0..list.len()).map(|i| list.get(i)).map(|run| (run.cell, run.replicate)).collect();
        assert_eq!(runs, [(0, 0), (2, 0), (0, 1), (2, 1), (1, 0), (1, 1)]);
        assert_eq!((list.shared(3), list.shared(4)), (2..4, 4..5));
        let units: Vec<_> = list.units().collect();
        assert_eq!(units.len(), 4);
        assert_eq!(units[1], Unit { replicate: 1, cells: vec![0, 2] });
        let of = |start, end| list.unit_indices(NumberRange { start, end });
        assert_eq!((of(0, 6), of(3, 4), of(3, 5), of(0, 0)), (0..4, 1..2, 1..3, 0..0));
        assert_eq!((list.numbers(1), list.numbers(2)), (2..4, 4..5));
        assert_eq!(list.unit(1, |number| *number == 3), Unit { replicate: 1, cells: vec![2] });
    }

    #[test]
    fn each_run_has_one_number() {
        for (surveys, runs) in [(&[0][..], 1), (&[0, 0, 0], 3), (&[0, 1, 2, 1, 0, 2, 3], 5)] {
            let list = WorkList::of(surveys, runs);
            for number in 0..list.len() {
                assert_eq!(list.number_of(list.get(number)), Some(number));
                assert!(list.shared(number).contains(&number));
            }
            assert_eq!(list.number_of(CellRun { cell: surveys.len(), replicate: 0 }), None);
            assert_eq!(list.number_of(CellRun { cell: 0, replicate: runs }), None);
        }
    }
}
