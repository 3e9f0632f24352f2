//! Sweeps that outgrow one machine: a plan in a folder, done part by part by any number of machines.
//!
//! The folder has all that a run needs, and can be moved. Whoever does a part adds what is
//! finished to a file of its own, and writes the part when it is whole: there are no locks, and no file has two writers. The
//! rows of a run do not depend on where it was done, so it is harmless to do one twice.
//!
//! A plan that was moved may have been made by somebody else. So each value in its files has a type with bounds, files outside
//! of its folder are not read, and what decides a row is worked out again.
//!
//! | in the folder | what |
//! | --- | --- |
//! | `plan.json` | what the plan is of: the version, the seeds, hashes of all files |
//! | `files/` | the scenario, what it extends and what it names |
//! | `work.jsonl`, `work.parquet` | the work list: one line a run of a cell, numbered from 0 |
//! | `parts/` | what is done: `A-B.csv` has the runs A to B - 1 |
//! | `unfinished` | an empty file, only as long as the plan is being written |
//! | `slurm/` | one folder a submission: the job script, its chunks, the identities of the jobs, what the tasks printed |

mod bundle;
mod error;
mod json_object;
mod plan_file;
mod progress;
mod room;
pub mod slurm;
mod work_file;

pub use error::CampaignError;
pub use plan_file::Estimate;
pub use progress::{FailedRun, Pace, Progress};

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use sextant::NumberRange;
use sextant_kernel::Watch;
use sextant_recording::ForeignFolder;
use sextant_recording::disk;
use sextant_recording::output::OutputError;
use sextant_recording::output::store::Store;

use crate::sweep::{CellCheckError, Done, FinishedRuns, StoredRows, Sweep, Trial, check_cells};
use plan_file::PlanFile;

/// A sweep as a plan in a folder.
#[derive(Debug)]
pub struct Campaign {
    folder: PathBuf,
    sweep: Sweep,
    estimate: Option<Estimate>,
}

impl Campaign {
    /// Writes the plan of `sweep` to `folder`, which is new or empty, or has a plan that is replaced if `replace` is set.
    /// `trial` is how long one run took.
    ///
    /// # Errors
    /// If there is something else in the folder, a file cannot be written, or one that the scenario names cannot move.
    pub fn create(
        sweep: Sweep,
        folder: &Path,
        trial: Option<Trial>,
        replace: Replace,
    ) -> Result<Self, CampaignError> {
        bundle::check(&sweep)?;
        let room = room::make(folder, replace)?;
        let estimate = trial.map(|trial| Estimate::of(&sweep, trial));
        let files = bundle::write(&sweep, &folder.join(FILES))?;
        work_file::write(&sweep, folder)?;
        let parts = folder.join(PARTS);
        disk::create_folders(&parts).map_err(|error| OutputError::new(&parts, &error))?;
        // Without this file the folder is no plan, so it comes last.
        PlanFile::of(&sweep, files, estimate).write(folder)?;
        let campaign = Self::read(folder)?;
        room.complete()?;
        Ok(campaign)
    }

    /// Rejects a folder where [`create`](Self::create) could not write the plan of `sweep`, before long work.
    ///
    /// # Errors
    /// If there is something else in the folder, or a file that the scenario extends or names cannot move.
    pub fn check_room(sweep: &Sweep, folder: &Path, replace: Replace) -> Result<(), CampaignError> {
        bundle::check(sweep)?;
        room::check(folder, replace)
    }

    /// Opens the plan in `folder`. Somebody else may have made it: all of its cells are worked out again, and compared with
    /// what it says of them.
    ///
    /// # Errors
    /// If there is none, it is of another version, it was changed, or it names files outside of its folder.
    pub fn open(folder: &Path) -> Result<Self, CampaignError> {
        let this = Self::read(folder)?;
        this.check(&(0..this.sweep.cells().len()).collect::<Vec<_>>())?;
        work_file::check(&this.sweep, &this.foreign())?;
        Ok(this)
    }

    /// Opens the plan in `folder` to do the runs of `range`: only the cells of these are worked out again.
    ///
    /// # Errors
    /// As [`open`](Self::open), and if the range has runs that the plan has not.
    pub fn open_part(folder: &Path, range: NumberRange) -> Result<Self, CampaignError> {
        let this = Self::read(folder)?;
        this.check_range(range)?;
        let work = this.sweep.work();
        let cells: BTreeSet<usize> = (range.start..range.end).map(|number| work.get(number).cell).collect();
        this.check(&cells.into_iter().collect::<Vec<_>>())?;
        Ok(this)
    }

    /// The plan in `folder` as its files say.
    fn read(folder: &Path) -> Result<Self, CampaignError> {
        let foreign = ForeignFolder::new(folder);
        let plan = PlanFile::read(&foreign)?;
        let estimate = plan.estimate;
        let sweep = plan.sweep(&foreign)?;
        Ok(Self { folder: folder.to_owned(), sweep, estimate })
    }

    /// Refuses the plan if what it says of these cells is not true.
    fn check(&self, cells: &[usize]) -> Result<(), CampaignError> {
        check_cells(&self.sweep, cells).map_err(|error| match error {
            CellCheckError::Scenario(errors) => errors.into(),
            CellCheckError::Untrue(error) => CampaignError::invalid(&PlanFile::path(&self.folder), error),
        })
    }

    fn check_range(&self, range: NumberRange) -> Result<(), CampaignError> {
        let runs = self.sweep.work().len();
        if range.end > runs { Err(CampaignError::Range { found: range, runs }) } else { Ok(()) }
    }

    /// Its folder, whose files somebody else may have written.
    fn foreign(&self) -> ForeignFolder {
        ForeignFolder::new(&self.folder)
    }

    /// Whether there is a plan in `folder`.
    #[must_use]
    pub fn is_in(folder: &Path) -> bool {
        PlanFile::path(folder).is_file()
    }

    /// Its folder.
    #[must_use]
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What it is the plan of.
    #[must_use]
    pub fn sweep(&self) -> &Sweep {
        &self.sweep
    }

    /// How long all takes, by one run that was tried.
    #[must_use]
    pub fn estimate(&self) -> Option<Estimate> {
        self.estimate
    }

    /// Does the runs of `range` that are not done, on all cores, and returns how many it did. What is done appears in the
    /// folder at once when all is done; a run that failed before is done again. If `watch` stops the work, what is done until
    /// then is kept.
    ///
    /// # Errors
    /// If the range has runs that the plan has not, a part cannot be read or written or is of another plan, or the work is
    /// stopped. A run that fails is a row with its error.
    pub fn run(&self, range: NumberRange, watch: &dyn Watch) -> Result<usize, CampaignError> {
        self.check_range(range)?;
        let parts = self.parts();
        let Done { mut places, unfinished, .. } = {
            let before = parts.read_within(range)?;
            let is_done = (range.start..range.end).all(|number| before.places.has_succeeded(number));
            if is_done && before.has_whole(range) {
                return Ok(0);
            }
            before
        };
        places.forget_failed();
        let todo: Vec<bool> = (range.start..range.end).map(|number| !places.has(number)).collect();
        let part = parts.begin(range, places)?;
        part.run::<CampaignError>(&todo, watch)?;
        part.finish()?;
        parts.remove(&unfinished);
        Ok(todo.iter().filter(|is_todo| **is_todo).count())
    }

    /// How far it is: what the parts in the folder say.
    ///
    /// # Errors
    /// If a part cannot be read or is of another plan.
    pub fn progress(&self) -> Result<Progress, CampaignError> {
        let parts = self.parts();
        let done = parts.read()?;
        Ok(Progress::of(&parts, &done)?)
    }

    /// The rows of all runs, by cell, then replicate.
    ///
    /// # Errors
    /// If a run is missing, or a part cannot be read or is of another plan.
    pub fn collect(&self) -> Result<StoredRows<'_>, CampaignError> {
        let parts = self.parts();
        let done = parts.read()?;
        let progress = Progress::of(&parts, &done)?;
        if progress.missing() > 0 {
            return Err(CampaignError::Missing {
                missing: progress.missing(),
                runs: progress.runs(),
                ranges: progress.missing_ranges(),
            });
        }
        Ok(StoredRows::new(parts, done.places))
    }

    fn parts(&self) -> FinishedRuns<'_> {
        let store = Store::shared(self.foreign(), self.folder.join(PARTS), self.sweep.fingerprint());
        FinishedRuns::of(&self.sweep, store)
    }
}

/// Whether a plan that is in the folder may be replaced, with all that was done of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Replace {
    /// It stays.
    Nothing,
    /// It is removed.
    Plan,
}

/// The folder of what a run needs.
const FILES: &str = "files";

/// The folder of what is done.
const PARTS: &str = "parts";
