//! The finished runs of a sweep in a store, so that it goes on after an interruption: beside its table, or in the folder of a plan.
//!
//! The rows stay on the disk. In memory is where each of them stands: 16 octets a run.

use std::fs;
use std::sync::{Mutex, PoisonError};
use std::time::SystemTime;

use rayon::prelude::*;
use sextant::NumberRange;
use sextant::summary::Stopwatch;
use sextant_kernel::{Interrupted, Watch, Work};
use sextant_recording::output::OutputError;
use sextant_recording::output::store::{PartName, Store, StoreError, UnfinishedPart};

use super::plan::Sweep;
use super::row::{RunRow, parsed, text};
use super::run_places::RunPlaces;
use super::unit;

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
#[derive(Debug)]
pub(crate) struct Done {
    /// Where the rows of the runs stand.
    pub(crate) places: RunPlaces,
    whole: Vec<NumberRange>,
    pub(crate) unfinished: Vec<PartName>,
    pub(crate) written: Vec<Written>,
}

/// A part that is being done.
#[derive(Debug)]
pub(crate) struct RunsPart<'a> {
    runs: &'a FinishedRuns<'a>,
    range: NumberRange,
    start: Stopwatch,
    own: Mutex<OwnFile>,
}

/// The file of this process.
#[derive(Debug)]
struct OwnFile {
    part: UnfinishedPart,
    /// When the disk was waited for (s).
    synced_s: f64,
    /// Of all runs that are finished, also those of other files.
    places: RunPlaces,
}

impl<'a> FinishedRuns<'a> {
    pub(crate) fn of(sweep: &'a Sweep, store: Store) -> Self {
        Self { sweep, store }
    }

    /// What they are the runs of.
    pub(crate) fn sweep(&self) -> &'a Sweep {
        self.sweep
    }

    /// All that is done.
    pub(crate) fn read(&self) -> Result<Done, StoreError> {
        self.read_within(NumberRange { start: 0, end: self.sweep.work().len() })
    }

    /// What is done of the runs in `range`.
    pub(crate) fn read_within(&self, range: NumberRange) -> Result<Done, StoreError> {
        let measures = self.sweep.measures().len();
        let places = RunPlaces::none(range, measures);
        let mut done = Done { places, whole: Vec::new(), unfinished: Vec::new(), written: Vec::new() };
        for part in self.store.parts()? {
            if part.range.start < range.end && range.start < part.range.end {
                self.read_part(part, &mut done)?;
            }
        }
        done.unfinished.retain(|part| part.range == range);
        Ok(done)
    }

    fn read_part(&self, part: PartName, done: &mut Done) -> Result<(), StoreError> {
        let Some(mut found) = self.store.read(part)? else { return Ok(()) };
        let path = self.store.path(part);
        let invalid = |why: String| StoreError::Invalid { path: path.clone(), why };
        let (work, measures) = (self.sweep.work(), self.sweep.measures().len());
        let place = |rows: usize| format!("row {}", rows + 1);
        let mut has = vec![false; part.range.len()];
        let (mut rows, mut finite) = (0, 0);
        let mut of_part = done.places.part(part);
        while let Some(block) = found.next_block().map_err(|why| StoreError::Read { path: path.clone(), why })? {
            for row in parsed(block.rows, measures) {
                let (row, within) = row.ok_or_else(|| invalid(format!("{} is no row of the plan", place(rows))))?;
                let number = work.number_of(row.run()).filter(|number| part.range.has(*number));
                let number = number.ok_or_else(|| invalid(format!("{} is of a run outside it", place(rows))))?;
                if std::mem::replace(&mut has[number - part.range.start], true) {
                    return Err(invalid(format!("{} is of a run that it has before", place(rows))));
                }
                rows += 1;
                // A number that is none was not written here: the run is done again.
                if row.is_finite() {
                    of_part.add(number, &row, block.start, within);
                    finite += 1;
                }
            }
        }
        if part.unfinished.is_some() {
            done.unfinished.push(part);
        } else if finite == part.range.len() {
            // Otherwise it was damaged, and what it lacks is done again.
            done.whole.push(part.range);
        }
        let has_begun = part.unfinished.is_none() || rows > 0;
        if let Some(at) = fs::metadata(&path).and_then(|data| data.modified()).ok().filter(|_| has_begun) {
            done.written.push(Written { at, wall_s: found.wall_s() });
        }
        self.store.keep_open(found)
    }

    /// Begins the part `range`, of which the runs at `places` are finished.
    pub(crate) fn begin(&self, range: NumberRange, places: RunPlaces) -> Result<RunsPart<'_>, OutputError> {
        let own = OwnFile { part: self.store.begin(range)?, synced_s: 0.0, places };
        Ok(RunsPart { runs: self, range, start: Stopwatch::start(), own: Mutex::new(own) })
    }

    /// Removes parts, once all that they have is in another one.
    pub(crate) fn remove(&self, parts: &[PartName]) {
        parts.iter().for_each(|part| self.store.remove(*part));
    }

    /// Texts of the rows of some runs, in the order of `numbers`, with many rows each. Runs without a row are left out.
    pub(super) fn texts<'r>(
        &'r self,
        places: &'r RunPlaces,
        numbers: impl Iterator<Item = usize> + 'r,
    ) -> impl Iterator<Item = Result<Vec<u8>, StoreError>> + 'r {
        let mut found = numbers.filter_map(|number| places.of(number));
        std::iter::from_fn(move || {
            let mut text = Vec::new();
            for place in found.by_ref() {
                if let Err(error) = self.store.read_rows(place, &mut text) {
                    return Some(Err(error));
                }
                if text.len() >= TEXT {
                    break;
                }
            }
            (!text.is_empty()).then_some(Ok(text))
        })
    }

    /// The rows of some runs, as [`texts`](Self::texts).
    pub(crate) fn rows<'r>(
        &'r self,
        places: &'r RunPlaces,
        numbers: impl Iterator<Item = usize> + 'r,
    ) -> impl Iterator<Item = Result<RunRow, StoreError>> + 'r {
        let measures = self.sweep.measures().len();
        self.texts(places, numbers).flat_map(move |text| match text {
            Err(error) => vec![Err(error)],
            Ok(text) => {
                parsed(&text, measures).map(|row| row.map(|(row, _)| row).ok_or_else(|| self.changed())).collect()
            }
        })
    }

    /// A row is no longer one that was read before.
    fn changed(&self) -> StoreError {
        let path = self.store.folder().to_owned();
        StoreError::Invalid { path, why: "a row in it was changed meanwhile".to_owned() }
    }
}

/// Rows are read again together until they have so many octets.
const TEXT: usize = 1 << 16;

impl Done {
    /// Whether there is a finished part of just these runs.
    pub(crate) fn has_whole(&self, range: NumberRange) -> bool {
        self.whole.contains(&range)
    }
}

impl RunsPart<'_> {
    /// Does the runs of the part that are `wanted`, by their numbers from its first one, on all cores, and adds their rows. If the
    /// work ends early, what is done until then is kept.
    ///
    /// # Errors
    /// If a row cannot be written, or `watch` stops the work.
    pub(crate) fn run<E: From<Interrupted> + From<OutputError> + Send>(
        &self,
        wanted: &[bool],
        watch: &dyn Watch,
    ) -> Result<(), E> {
        let (sweep, range) = (self.runs.sweep, self.range);
        let work = sweep.work();
        let is_wanted = |number: &usize| range.has(*number) && wanted[number - range.start];
        let units =
            || work.unit_indices(range).into_par_iter().filter(|&unit| work.numbers(unit).any(|n| is_wanted(&n)));
        watch.begin(Work { name: "sweeping", unit: "survey", steps: units().count() as u64, operations: 0.0 });
        let outcome = units().try_for_each(|index| {
            watch.check()?;
            let unit = work.unit(index, is_wanted);
            let rows = unit::run(sweep, &unit, watch).ok_or(Interrupted)?;
            watch.advance(1);
            Ok::<(), E>(self.append(&rows)?)
        });
        if outcome.is_err() {
            // The first error is told; runs that do not reach the disk are missing and are seen to be.
            let _ = self.own.lock().unwrap_or_else(PoisonError::into_inner).part.sync();
        }
        outcome
    }

    /// Adds rows that are finished.
    fn append(&self, rows: &[RunRow]) -> Result<(), OutputError> {
        let texts: Vec<Vec<u8>> = rows.iter().map(|row| text([row])).collect();
        let wall_s = self.start.elapsed_s();
        let mut own = self.own.lock().unwrap_or_else(PoisonError::into_inner);
        let start = own.part.append(&texts.concat(), wall_s)?;
        if wall_s - own.synced_s > SYNCED_EVERY_S {
            own.synced_s = wall_s;
            own.part.sync()?;
        }
        let name = own.part.name();
        let mut places = own.places.part(name);
        let mut within = 0;
        for (row, text) in rows.iter().zip(&texts) {
            if let Some(number) = self.runs.sweep.work().number_of(row.run()) {
                places.add(number, row, start, within..within + text.len());
            }
            within += text.len();
        }
        Ok(())
    }

    /// Where the rows of all finished runs stand.
    pub(crate) fn into_places(self) -> RunPlaces {
        self.own.into_inner().unwrap_or_else(PoisonError::into_inner).places
    }

    /// Writes the finished part, all of whose runs are finished.
    pub(crate) fn finish(self) -> Result<(), StoreError> {
        let OwnFile { part, places, .. } = self.own.into_inner().unwrap_or_else(PoisonError::into_inner);
        let texts = self.runs.texts(&places, self.range.start..self.range.end);
        self.runs.store.finish(self.range, texts, self.start.elapsed_s())?;
        self.runs.store.remove(part.name());
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

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
        let measures = plan.measures().len();
        let part = runs.begin(ALL, RunPlaces::none(ALL, measures)).unwrap();
        part.append(&rows[..1]).unwrap();
        part.append(&rows[2..]).unwrap();
        let done = runs.read().unwrap();
        let by_number: BTreeMap<usize, RunRow> =
            [0, 2, 3].map(|i| (plan.work().number_of(rows[i].run()).unwrap(), rows[i].clone())).into();
        let found = |done: &Done| runs.rows(&done.places, 0..4).collect::<Result<Vec<_>, _>>().unwrap();
        assert_eq!((found(&done), done.unfinished.len()), (by_number.into_values().collect(), 1));
        assert!(!done.has_whole(ALL) && !done.places.has_succeeded(plan.work().number_of(rows[3].run()).unwrap()));
        part.append(&rows[1..2]).unwrap();
        part.finish().unwrap();
        let done = runs.read_within(ALL).unwrap();
        assert_eq!((found(&done).len(), done.unfinished.len(), done.has_whole(ALL)), (4, 0, true));

        let refused = |rows: &[RunRow]| {
            let mut part = runs.store.begin(NumberRange { start: 0, end: 2 }).unwrap();
            part.append(&text(rows), 1.0).unwrap();
            let error = runs.read().unwrap_err().to_string();
            runs.remove(&[part.name()]);
            error
        };
        let CellRun { cell, replicate } = plan.work().get(0);
        let first = RunRow { cell, replicate, outcome: Err("no".into()) };
        let short = RunRow { outcome: Ok(vec![None; 3]), ..first.clone() };
        assert!(refused(&[first.clone(), short]).contains("row 2 is no row of the plan"));
        assert!(refused(&[RunRow { cell: 9, ..first.clone() }]).contains("row 1 is of a run outside it"));
        assert!(refused(&rows).contains("is of a run outside it"), "of another part");
        assert!(refused(&[first.clone(), first]).contains("row 2 is of a run that it has before"));

        // A finished part that lost its end, and one with a number that is none.
        let path = runs.store.path(PartName { range: ALL, unfinished: None });
        let whole = std::fs::read(&path).unwrap();
        std::fs::write(&path, &whole[..whole.len() - 1]).unwrap();
        let done = runs.read().unwrap();
        assert_eq!((found(&done).len(), done.has_whole(ALL)), (0, false));
        let first = rows[0].clone();
        for (value, kept) in [(f64::NAN, 3), (f64::INFINITY, 3), (0.5, 4)] {
            rows[0] = RunRow { outcome: Ok(vec![Some(value); measures]), ..first.clone() };
            let folder = folder.path().join("parts");
            let store = Store::shared(ForeignFolder::new(&folder), folder, plan.fingerprint());
            let runs = FinishedRuns::of(&plan, store);
            runs.store.finish(ALL, [Ok(text(&rows))], 1.0).unwrap();
            let done = runs.read().unwrap();
            let found = runs.rows(&done.places, 0..4).filter(Result::is_ok).count();
            assert_eq!((found, done.has_whole(ALL)), (kept, kept == 4), "{value}");
        }
    }
}
