//! The finished runs of a sweep in a store, so that it goes on after an interruption: beside its table, or in the folder of a plan.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use sextant::NumberRange;
use sextant::summary::Stopwatch;
use sextant_recording::output::store::{PartName, Store, StoreError, UnfinishedPart};
use sextant_recording::output::{CsvFile, EmptyCell, OutputError};

use super::plan::Sweep;
use super::row::RunRow;

/// The disk is waited for this often (s), so that little is lost with a machine.
const SYNCED_EVERY_S: f64 = 30.0;

/// The finished runs of a sweep.
#[derive(Debug)]
pub(crate) struct FinishedRuns<'a> {
    sweep: &'a Sweep,
    store: Store,
}

/// When a part was written, and how long the work on it took.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Written {
    pub(crate) at: SystemTime,
    pub(crate) wall_s: f64,
}

/// What some parts have.
#[derive(Debug, Default)]
pub(crate) struct Done {
    /// By number in the work list. A run that succeeded in any part has succeeded.
    pub(crate) rows: BTreeMap<usize, RunRow>,
    whole: Vec<NumberRange>,
    pub(crate) unfinished: Vec<PartName>,
    pub(crate) written: Vec<Written>,
}

/// A part that is being done.
#[derive(Debug)]
pub(crate) struct RunsPart<'a> {
    runs: &'a FinishedRuns<'a>,
    start: Stopwatch,
    /// The file of this process, and when the disk was waited for (s).
    own: Mutex<(UnfinishedPart, f64)>,
}

impl<'a> FinishedRuns<'a> {
    pub(crate) fn of(sweep: &'a Sweep, store: Store) -> Self {
        Self { sweep, store }
    }

    /// All that is done.
    pub(crate) fn read(&self) -> Result<Done, StoreError> {
        self.read_where(|_| true)
    }

    /// What is done of the runs in `range`.
    pub(crate) fn read_within(&self, range: NumberRange) -> Result<Done, StoreError> {
        let mut done = self.read_where(|other| other.start < range.end && range.start < other.end)?;
        done.rows.retain(|number, _| range.has(*number));
        done.unfinished.retain(|part| part.range == range);
        Ok(done)
    }

    fn read_where(&self, wanted: impl Fn(NumberRange) -> bool) -> Result<Done, StoreError> {
        let mut done = Done::default();
        for part in self.store.parts()?.into_iter().filter(|part| wanted(part.range)) {
            self.read_part(part, &mut done)?;
        }
        Ok(done)
    }

    fn read_part(&self, part: PartName, done: &mut Done) -> Result<(), StoreError> {
        let Some(text) = self.store.read(part)? else { return Ok(()) };
        let path = self.store.path(part);
        let invalid = |why: String| StoreError::Invalid { path: path.clone(), why };
        let measures = self.sweep.measures().len();
        let mut numbers = BTreeSet::new();
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text);
        for record in reader.records() {
            let record = match record.map_err(csv::Error::into_kind) {
                Err(csv::ErrorKind::Io(why)) => return Err(StoreError::Read { path, why }),
                record => record.ok(),
            };
            // Rows of an unfinished part are not on lines of their own.
            let place = |rows: usize| match part.unfinished {
                None => format!("line {}", rows + 2),
                Some(_) => format!("row {}", rows + 1),
            };
            let row = record.and_then(|record| RunRow::parse(&record, measures));
            let row = row.ok_or_else(|| invalid(format!("{} is no row of the plan", place(numbers.len()))))?;
            let number = self.sweep.work().number_of(row.run()).filter(|number| part.range.has(*number));
            let number = number.ok_or_else(|| invalid(format!("{} is of a run outside it", place(numbers.len()))))?;
            if !numbers.insert(number) {
                return Err(invalid(format!("{} is of a run that it has before", place(numbers.len()))));
            }
            done.add(number, row);
        }
        if part.unfinished.is_some() {
            done.unfinished.push(part);
        } else if numbers.len() == part.range.len() {
            done.whole.push(part.range);
        } else {
            return Err(invalid(format!("it has {} rows, not {}", numbers.len(), part.range.len())));
        }
        let has_begun = part.unfinished.is_none() || !numbers.is_empty();
        if let Some(at) = fs::metadata(&path).and_then(|data| data.modified()).ok().filter(|_| has_begun) {
            done.written.push(Written { at, wall_s: reader.get_ref().wall_s() });
        }
        Ok(())
    }

    /// Begins the part `range`.
    pub(crate) fn begin(&self, range: NumberRange) -> Result<RunsPart<'_>, OutputError> {
        Ok(RunsPart { runs: self, start: Stopwatch::start(), own: Mutex::new((self.store.begin(range)?, 0.0)) })
    }

    /// Removes parts, once all that they have is in another one.
    pub(crate) fn remove(&self, parts: &[PartName]) {
        parts.iter().for_each(|part| self.store.remove(*part));
    }
}

impl Done {
    fn add(&mut self, number: usize, row: RunRow) {
        let known = self.rows.entry(number).or_insert_with(|| row.clone());
        if known.outcome.is_err() && row.outcome.is_ok() {
            *known = row;
        }
    }

    /// Whether a run succeeded.
    pub(crate) fn is_done(&self, number: usize) -> bool {
        self.rows.get(&number).is_some_and(|row| row.outcome.is_ok())
    }

    /// Whether there is a finished part of just these runs.
    pub(crate) fn has_whole(&self, range: NumberRange) -> bool {
        self.whole.contains(&range)
    }
}

impl RunsPart<'_> {
    /// Adds rows that are finished.
    pub(crate) fn append(&self, rows: &[RunRow]) -> Result<(), OutputError> {
        let text = text(rows);
        let wall_s = self.start.elapsed_s();
        let mut guard = self.own.lock().unwrap_or_else(PoisonError::into_inner);
        let (own, synced_s) = &mut *guard;
        own.append(&text, wall_s)?;
        if wall_s - *synced_s > SYNCED_EVERY_S {
            *synced_s = wall_s;
            own.sync()?;
        }
        Ok(())
    }

    /// Makes what was added reach the disk.
    pub(crate) fn sync(&self) -> Result<(), OutputError> {
        self.own.lock().unwrap_or_else(PoisonError::into_inner).0.sync()
    }

    /// Writes the finished part, which has all of these `rows`.
    pub(crate) fn finish<'r>(self, rows: impl IntoIterator<Item = &'r RunRow>) -> Result<(), OutputError> {
        let own = self.own.into_inner().unwrap_or_else(PoisonError::into_inner).0.name();
        self.runs.store.finish(own.range, &text(rows), self.start.elapsed_s())?;
        self.runs.store.remove(own);
        Ok(())
    }
}

fn text<'r>(rows: impl IntoIterator<Item = &'r RunRow>) -> Vec<u8> {
    let mut file = CsvFile::headless(EmptyCell::Bare);
    rows.into_iter().for_each(|row| file.row(row.record()));
    file.take()
}

#[cfg(test)]
mod tests {
    use sextant_recording::ForeignFolder;

    use super::*;
    use crate::sweep::CellRun;
    use crate::sweep::table_reader::tests::{STEPS, made_up, plan};

    const ALL: NumberRange = NumberRange { start: 0, end: 4 };

    #[test]
    fn finished_runs_are_read_back_only_as_runs_of_their_own_part_and_sweep() {
        let folder = tempfile::tempdir().unwrap();
        let plan = plan(folder.path(), STEPS, 2);
        let store = Store::shared(ForeignFolder::new(folder.path()), folder.path().join("parts"), plan.fingerprint());
        std::fs::create_dir(folder.path().join("parts")).unwrap();
        let runs = FinishedRuns::of(&plan, store);
        let mut rows = made_up(&plan);
        rows[3].outcome = Err("a \"b\",\nc".into());
        let part = runs.begin(ALL).unwrap();
        part.append(&rows[..1]).unwrap();
        part.append(&rows[2..]).unwrap();
        let done = runs.read().unwrap();
        let by_number: BTreeMap<usize, RunRow> =
            [0, 2, 3].map(|i| (plan.work().number_of(rows[i].run()).unwrap(), rows[i].clone())).into();
        assert_eq!((&done.rows, done.unfinished.len()), (&by_number, 1));
        assert!(!done.has_whole(ALL) && !done.is_done(plan.work().number_of(rows[3].run()).unwrap()));
        part.append(&rows[1..2]).unwrap();
        part.finish(&rows).unwrap();
        let done = runs.read_within(ALL).unwrap();
        assert_eq!((done.rows.len(), done.unfinished.len(), done.has_whole(ALL)), (4, 0, true));

        let refused = |rows: &[RunRow]| {
            let part = runs.begin(NumberRange { start: 0, end: 2 }).unwrap();
            part.append(rows).unwrap();
            let error = runs.read().unwrap_err().to_string();
            runs.remove(&[part.own.into_inner().unwrap().0.name()]);
            error
        };
        let CellRun { cell, replicate } = plan.work().get(0);
        let first = RunRow { cell, replicate, outcome: Err("no".into()) };
        let short = RunRow { outcome: Ok(vec![None; 3]), ..first.clone() };
        assert!(refused(&[first.clone(), short]).contains("row 2 is no row of the plan"));
        assert!(refused(&[RunRow { cell: 9, ..first.clone() }]).contains("row 1 is of a run outside it"));
        assert!(refused(&rows).contains("is of a run outside it"), "of another part");
        assert!(refused(&[first.clone(), first]).contains("row 2 is of a run that it has before"));
    }
}
