//! Many runs of one scenario: cells of settings, replicates of each, one table.
//!
//! The replicates of a cell have the seeds `seed`, `seed` + 1, .., the same ones in each cell (common random numbers), so
//! that cells differ by their settings alone. Cells that differ only in what is made of the reception log share their
//! surveys. The table is a function of scenario, seeds and version: threads and shards do not change a byte of its rows.

mod column;
mod parts;
mod plan;
mod row;
mod shard;
mod statistics;
mod table_file;
mod unit;

pub use column::{Column, Kind};
pub use plan::{Cell, Plan};
pub use row::Row;
pub use shard::Shard;
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

/// Runs the units of `plan` that fall to `shard`, all cores at once, and returns their rows by cell, then replicate.
/// Finished units are kept beside `out` until its rows are all there; `resume` takes up those of a sweep before.
///
/// # Errors
/// If a file cannot be written or the user interrupts. A run that fails is a row with its error instead.
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

/// Runs all units of several plans, all cores at once, and returns the rows of each plan by cell, then replicate: all
/// that were finished, also when the user interrupts. A run that fails is a row with its error.
///
/// # Errors
/// Beside the rows, if the user interrupts.
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

/// Does `work` on all `units`, all cores at once, under a bar that says `what`. The results of the units that were finished,
/// in their order, and the first failure, after which no further unit is begun.
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
        // Of several failures at once, one is told.
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

/// Writes the table of `rows` to the file at `path`, whole or not at all.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub fn write_table(path: &Path, plan: &Plan, rows: &[Row]) -> Result<(), Failure> {
    let texts: Vec<_> = rows.iter().map(|row| plan.texts(row)).collect();
    table_file::write_table(path, &plan.columns(), &texts)
}

/// Forgets the finished units beside `out`: the table is written.
///
/// # Errors
/// If they cannot be removed.
pub fn clear_parts(out: &Path) -> Result<(), Failure> {
    parts::remove(out)
}
