//! Many runs of one scenario: cells of settings, replicates of each, one table.
//!
//! The replicates of a cell have the seeds `seed`, `seed` + 1, .., the same ones in each cell (common random numbers), so
//! that cells differ by their settings alone. Cells that differ only in what is made of the reception log share their
//! surveys. The table is a function of scenario, seeds and version: threads and shards do not change a byte of its rows.

mod measures;
mod parts;
mod plan;
mod shard;
mod statistics;
mod table_file;
mod unit;

pub(crate) use measures::node_error_cdf;
pub use measures::{Column, Kind};
pub use plan::{Cell, Plan};
pub use shard::Shard;
pub use statistics::Mean;
pub use table_file::{TableFormat, write_table};
pub use unit::Row;

use std::path::Path;
use std::sync::Mutex;
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
    let units: Vec<_> = plan.units().into_iter().filter(|unit| shard.has(unit.index)).collect();
    let progress = Progress::new("sweeping", units.len() as u64, quiet);
    let done = AtomicU64::new(0);
    let failure = Mutex::new(None);
    let rows: Vec<Vec<Row>> = units
        .par_iter()
        .map(|unit| {
            if interrupt.is_requested() || failure.lock().is_ok_and(|failure| failure.is_some()) {
                return Vec::new();
            }
            let result = match parts.read(unit.index) {
                Ok(Some(rows)) => Ok(Some(rows)),
                Ok(None) => unit::run(plan, unit, interrupt)
                    .map_or(Ok(None), |rows| parts.write(unit.index, &rows).map(|()| Some(rows))),
                Err(failure) => Err(failure),
            };
            progress.set(done.fetch_add(1, Ordering::Relaxed) + 1, "surveys with their maps".to_owned());
            match result {
                Ok(rows) => rows.unwrap_or_default(),
                Err(first) => {
                    if let Ok(mut failure) = failure.lock() {
                        failure.get_or_insert(first);
                    }
                    Vec::new()
                }
            }
        })
        .collect();
    progress.clear();
    if let Ok(Some(failure)) = failure.into_inner() {
        return Err(failure);
    }
    if interrupt.is_requested() {
        return Err(Failure::Interrupted);
    }
    let mut rows: Vec<Row> = rows.into_iter().flatten().collect();
    rows.sort_by_key(|row| (row.cell, row.replicate));
    Ok(rows)
}

/// Runs all units of several plans, all cores at once, and returns the rows of each plan by cell, then replicate.
///
/// # Errors
/// If the user interrupts. A run that fails is a row with its error instead.
pub fn rows(plans: &[Plan], interrupt: &Interrupt, quiet: bool) -> Result<Vec<Vec<Row>>, Failure> {
    let units: Vec<_> =
        plans.iter().enumerate().flat_map(|(i, plan)| plan.units().into_iter().map(move |u| (i, u))).collect();
    let progress = Progress::new("running", units.len() as u64, quiet);
    let done = AtomicU64::new(0);
    let made: Vec<(usize, Vec<Row>)> = units
        .par_iter()
        .map(|(i, unit)| {
            let rows = if interrupt.is_requested() { None } else { unit::run(&plans[*i], unit, interrupt) };
            progress.set(done.fetch_add(1, Ordering::Relaxed) + 1, "surveys with their maps".to_owned());
            (*i, rows.unwrap_or_default())
        })
        .collect();
    progress.clear();
    if interrupt.is_requested() {
        return Err(Failure::Interrupted);
    }
    let mut rows = vec![Vec::new(); plans.len()];
    for (i, made) in made {
        rows[i].extend(made);
    }
    for rows in &mut rows {
        rows.sort_by_key(|row| (row.cell, row.replicate));
    }
    Ok(rows)
}

/// Forgets the finished units beside `out`: the table is written.
///
/// # Errors
/// If they cannot be removed.
pub fn clear_parts(out: &Path) -> Result<(), Failure> {
    parts::remove(out)
}
