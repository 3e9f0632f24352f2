//! Sweeps: many runs of one scenario, with their results in one table. A cell is one combination of settings; its runs
//! are called replicates.
//!
//! The replicates of a cell have the seeds `seed`, `seed` + 1, .. The seeds are the same in each cell (common random
//! numbers), so that cells differ only by their settings. Cells whose settings differ only in the evaluation of the
//! reception log share their surveys. The table depends on scenario, seeds and version alone: the number of threads and
//! shards does not change its rows.

mod column;
mod curves;
mod parts;
mod plan;
mod row;
mod shard;
mod share;
mod statistics;
mod table_file;
mod unit;

pub use column::{Column, Kind};
pub use curves::figures;
pub use plan::{Cell, Plan};
pub use row::Row;
pub use shard::Shard;
pub use share::Share;
pub use statistics::Mean;
pub use table_file::TableFormat;

use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::Progress;
use parts::Parts;

/// Runs the units of `plan` that belong to `shard`, on all cores, and returns their rows by cell, then replicate.
/// Finished units are kept in a folder beside `out`. With `resume`, those of an interrupted sweep are used again.
///
/// # Errors
/// If a file cannot be written or the user interrupts. A run that fails gives a row with its error.
pub fn run(
    plan: &Plan,
    shard: Shard,
    out: &Path,
    resume: bool,
    interrupt: &Interrupt,
    quiet: bool,
) -> Result<Vec<Row>, Failure> {
    let parts = Parts::open(out, &format!("{}{}", plan.fingerprint(), shard.suffix()), resume)?;
    let measures = plan.measures().len();
    let units = plan.units().into_iter().filter(|unit| shard.has(unit.index)).collect();
    let (rows, outcome) = each(units, "sweeping", interrupt, quiet, |unit| {
        if let Some(rows) = parts.read(unit.index, measures)? {
            return Ok(rows);
        }
        let rows = unit::run(plan, unit, interrupt).ok_or(Failure::Interrupted)?;
        let _keeper = interrupt.keep();
        parts.write(unit.index, &rows)?;
        Ok(rows)
    });
    outcome?;
    Ok(sorted(rows.into_iter().flatten().collect()))
}

/// Runs all units of several plans, on all cores, and returns the finished rows of each plan by cell, then replicate. A
/// run that fails gives a row with its error.
///
/// # Errors
/// If the user interrupts; the rows finished until then are returned as well.
pub fn rows(plans: &[Plan], interrupt: &Interrupt, quiet: bool) -> (Vec<Vec<Row>>, Result<(), Failure>) {
    let units = plans.iter().enumerate().flat_map(|(i, plan)| plan.units().into_iter().map(move |unit| (i, unit)));
    let (made, outcome) = each(units.collect(), "running", interrupt, quiet, |(i, unit)| {
        let rows = unit::run(&plans[*i], unit, interrupt).ok_or(Failure::Interrupted)?;
        Ok((*i, rows))
    });
    let mut rows = vec![Vec::new(); plans.len()];
    for (i, made) in made {
        rows[i].extend(made);
    }
    (rows.into_iter().map(sorted).collect(), outcome)
}

/// Does `work` on all `units`, on all cores, with a progress bar called `what`. Returns the results of the finished units
/// in their order, and the first failure. After a failure no further unit is started.
fn each<U: Sync, T: Send>(
    units: Vec<U>,
    what: &'static str,
    interrupt: &Interrupt,
    quiet: bool,
    work: impl Fn(&U) -> Result<T, Failure> + Sync,
) -> (Vec<T>, Result<(), Failure>) {
    let progress = Progress::new(what, units.len() as u64, quiet);
    let done = AtomicU64::new(0);
    let failure = OnceLock::new();
    let results = units.par_iter().map(|unit| {
        if failure.get().is_some() {
            return None;
        }
        let result = if interrupt.is_requested() { Err(Failure::Interrupted) } else { work(unit) };
        progress.set(done.fetch_add(1, Ordering::Relaxed) + 1, "surveys with their maps".to_owned());
        // Of several failures at once, one is reported.
        result.map_err(|error| failure.set(error)).ok()
    });
    let results: Vec<Option<T>> = results.collect();
    progress.clear();
    let outcome = match failure.into_inner() {
        None if interrupt.is_requested() => Err(Failure::Interrupted),
        None => Ok(()),
        Some(failure) => Err(failure),
    };
    (results.into_iter().flatten().collect(), outcome)
}

/// By cell, then replicate.
fn sorted(mut rows: Vec<Row>) -> Vec<Row> {
    rows.sort_by_key(|row| (row.cell, row.replicate));
    rows
}

/// Writes the table of `rows` to the file at `path`, completely or not at all.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub fn write_table(path: &Path, plan: &Plan, rows: &[Row]) -> Result<(), Failure> {
    let texts: Vec<_> = rows.iter().map(|row| plan.texts(row)).collect();
    table_file::write_table(path, &plan.columns(), &texts)
}

/// Removes the folder of finished units beside `out`, once the table is written.
///
/// # Errors
/// If they cannot be removed.
pub fn clear_parts(out: &Path) -> Result<(), Failure> {
    parts::remove(out)
}
