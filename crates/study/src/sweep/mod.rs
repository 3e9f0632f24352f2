//! Sweeps: many runs of one scenario, with their results in one table. A cell is one combination of settings; its runs
//! are called replicates.
//!
//! The replicates of a cell have the seeds `seed`, `seed` + 1, .. The seeds are the same in each cell (common random
//! numbers), so that cells differ only by their settings. Cells whose settings differ only in the evaluation of the
//! reception log share their surveys. The table depends on scenario, seeds and version alone: the number of threads and
//! shards does not change its rows.

mod average;
mod cell_check;
mod column;
mod described;
mod effects;
mod error;
mod facts;
mod figures;
mod finished_runs;
mod finished_table;
mod plan;
mod row;
mod rows;
mod run_places;
mod setting;
mod shard;
mod share;
mod statistics;
mod stored_rows;
mod summary;
mod table_file;
mod table_reader;
mod tidy;
mod trial;
pub(crate) mod unit;
mod work_list;

pub use average::Average;
pub use column::{Column, ColumnKind};
pub use described::{ColumnSubject, DescribedColumn, described_columns};
pub use error::{SweepError, TableError};
pub use figures::{StudyDrawing, StudyFigures};
pub use finished_table::{FinishedTable, exact_number};
pub use plan::{Cell, Sweep};
pub use row::RunRow;
pub use rows::{Overview, RowIter, Rows};
pub use shard::Shard;
pub use share::Share;
pub use statistics::{Mean, students_t_975};
pub use stored_rows::{StoredRows, SweptRows};
pub use summary::{CellSummary, summaries};
pub use table_file::TableFormat;
pub use table_reader::{TableRows, read_own_table, read_table};
pub use trial::{Trial, TrialError, trial};
pub use work_list::{CellRun, WorkList};

pub(crate) use cell_check::{CellCheckError, check_cells};
pub(crate) use finished_runs::{Done, FinishedRuns, Written};
pub(crate) use plan::{Checked, CheckedCell, check_runs, check_seeds};
#[cfg(feature = "parquet")]
pub(crate) use table_file::write_table as write_texts;

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use rayon::prelude::*;
use sextant::NumberRange;
use sextant_kernel::{Interrupted, Watch, Work};
use sextant_recording::output::store::{self, Begun, Store};

/// Runs the units of `plan` that belong to `shard`, on all cores, and returns their rows by cell, then replicate.
/// Finished runs are kept in a folder beside `out`, until [`clear_parts`]. With `resume`, those of an interrupted sweep are
/// used again.
///
/// # Errors
/// If a file cannot be written, or `watch` stops the work. A run that fails gives a row with its error.
pub fn run<'a>(
    plan: &'a Sweep,
    shard: Shard,
    out: &Path,
    resume: bool,
    watch: &dyn Watch,
) -> Result<SweptRows<'a>, SweepError> {
    extend(plan, None, shard, out, resume, watch)
}

/// As [`run`], but of a sweep of which the rows `known` are there already, from [`read_own_table`]: only what is missing is
/// run. Returns all rows.
///
/// # Errors
/// As [`run`].
pub fn extend<'a>(
    plan: &'a Sweep,
    known: Option<TableRows<'a>>,
    shard: Shard,
    out: &Path,
    resume: bool,
    watch: &dyn Watch,
) -> Result<SweptRows<'a>, SweepError> {
    let (work, folder) = (plan.work(), folder_beside(out));
    let (store, begun) = Store::alone(&folder, &format!("{}{}", plan.fingerprint(), shard.suffix()))?;
    if begun == Begun::Before && !resume {
        return Err(SweepError::Unfinished { folder });
    }
    let all = NumberRange { start: 0, end: work.len() };
    let is_known = |number: usize| known.as_ref().is_some_and(|known| known.has(number));
    let is_wanted = |number: usize| shard.has(work.survey_of(number)) && !is_known(number);
    let mut wanted: Vec<bool> = (0..all.end).map(is_wanted).collect();
    let runs = FinishedRuns::of(plan, store);
    let mut places = runs.read()?.places;
    places.retain(|number| wanted[number]);
    wanted.iter_mut().enumerate().for_each(|(number, wanted)| *wanted &= !places.has(number));
    let part = runs.begin(all, places)?;
    part.run::<SweepError>(&wanted, watch)?;
    watch.check()?;
    let places = part.into_places();
    Ok(SweptRows::new(known, StoredRows::new(runs, places)))
}

/// Runs all units of several plans, on all cores, and returns the finished rows of each plan by cell, then replicate. A
/// run that fails gives a row with its error.
///
/// # Errors
/// If `watch` stops the work; the rows finished until then are returned as well.
pub fn rows(plans: &[Sweep], watch: &dyn Watch) -> (Vec<Vec<RunRow>>, Result<(), SweepError>) {
    let units = plans.iter().enumerate().flat_map(|(i, plan)| plan.work().units().map(move |unit| (i, unit)));
    let (made, outcome) = each(&units.collect::<Vec<_>>(), watch, |(i, unit)| {
        let rows = unit::run(&plans[*i], unit, watch).ok_or(Interrupted)?;
        Ok((*i, rows))
    });
    let mut rows = vec![Vec::new(); plans.len()];
    for (i, made) in made {
        rows[i].extend(made);
    }
    (rows.into_iter().map(sorted).collect(), outcome)
}

/// Does `work` on all `units`, on all cores. Returns the results of the finished units in
/// their order, and the first failure. After a failure no further unit is started.
fn each<U: Sync, T: Send>(
    units: &[U],
    watch: &dyn Watch,
    work: impl Fn(&U) -> Result<T, SweepError> + Sync,
) -> (Vec<T>, Result<(), SweepError>) {
    watch.begin(Work { name: "running", unit: "survey", steps: units.len() as u64, operations: 0.0 });
    let failure = OnceLock::new();
    let results = units.par_iter().map(|unit| {
        if failure.get().is_some() {
            return None;
        }
        let result = watch.check().map_err(SweepError::from).and_then(|()| work(unit));
        watch.advance(1);
        // Of several failures at once, one is reported.
        result.map_err(|error| failure.set(error)).ok()
    });
    let results: Vec<Option<T>> = results.collect();
    let outcome = match failure.into_inner() {
        None => watch.check().map_err(SweepError::from),
        Some(failure) => Err(failure),
    };
    (results.into_iter().flatten().collect(), outcome)
}

/// By cell, then replicate.
fn sorted(mut rows: Vec<RunRow>) -> Vec<RunRow> {
    rows.sort_by_key(|row| (row.cell, row.replicate));
    rows
}

/// Writes the tidy table of `rows`, with one row for each cell, run and map, to the file at `path`, completely or not at all.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub fn write_table(path: &Path, plan: &Sweep, rows: &dyn Rows) -> Result<(), TableError> {
    let (columns, texts) = tidy::table(plan, rows);
    table_file::write_table(path, &columns, texts)
}

/// The same table in memory: its columns, without measures that have no value, and its texts. A cell without a value is empty.
///
/// # Errors
/// If a row cannot be read.
pub fn table(plan: &Sweep, rows: &dyn Rows) -> Result<(Vec<Column>, Vec<Vec<String>>), TableError> {
    let (columns, texts) = tidy::table(plan, rows);
    Ok((columns, texts.collect::<Result<_, _>>()?))
}

/// Removes the folder of finished runs beside `out`, once the table is written.
///
/// # Errors
/// If they cannot be removed.
pub fn clear_parts(out: &Path) -> Result<(), SweepError> {
    Ok(store::remove(&folder_beside(out))?)
}

/// The folder of the finished runs of the table `out`.
fn folder_beside(out: &Path) -> PathBuf {
    let mut folder = out.as_os_str().to_owned();
    folder.push(".parts");
    folder.into()
}
