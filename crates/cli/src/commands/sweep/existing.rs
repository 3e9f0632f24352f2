//! A table that is there before a sweep begins: it is extended by runs, and never replaced unless that is asked for.

use std::path::Path;

use sextant_kernel::text::counted;
use sextant_study::sweep::{Rows, Shard, Sweep, TableError, TableRows, read_own_table};

use super::Arguments;
use crate::diagnostic::Failure;

/// What to do, and the rows that are there already.
pub(super) enum Start<'a> {
    /// These rows are known, or none; the others are run.
    Run(Option<TableRows<'a>>),
    /// All rows are there.
    Finished(TableRows<'a>),
}

const WAYS_OUT: &str = "`--force` replaces it, `--out TABLE` names another table";

/// What to do about the table at `out`.
///
/// # Errors
/// If there is one that may neither be replaced nor extended.
pub(super) fn start<'a>(arguments: &Arguments, plan: &'a Sweep, out: &Path) -> Result<Start<'a>, Failure> {
    if arguments.force || !out.is_file() {
        return Ok(Start::Run(None));
    }
    let table = out.display();
    let known = read_own_table(out, plan).map_err(|error| match error {
        error @ TableError::Other { .. } => {
            Failure::bad_input_with_help(format!("`{table}` exists, and {}", unquoted(&error, out)), WAYS_OUT)
        }
        error @ (TableError::OtherSweep { .. } | TableError::Read { .. }) => {
            Failure::bad_input_with_help(error.to_string(), WAYS_OUT)
        }
        other => other.into(),
    })?;
    if arguments.shard != Shard::default() {
        return Err(Failure::bad_input_with_help(
            format!("`{table}` exists, and a part of a sweep is not extended"),
            WAYS_OUT,
        ));
    }
    let runs = known.runs();
    let (found, all) = (known.overview().rows, plan.cells().len() * plan.runs() as usize);
    if runs > plan.runs() {
        let (more, asked) = (counted(runs as usize, "run"), plan.runs());
        return Err(Failure::bad_input_with_help(
            format!("`{table}` has {more} of each cell of this sweep, and {asked} are asked for"),
            WAYS_OUT,
        ));
    }
    if found < all {
        arguments.work.note(&format!("`{table}` has {found} of {all} runs of this sweep; the others are added"));
        return Ok(Start::Run(Some(known)));
    }
    if arguments.resume {
        return Ok(Start::Finished(known));
    }
    Err(Failure::bad_input_with_help(
        format!("`{table}` is finished: it has all runs of this sweep, {runs} of each cell"),
        format!("`--runs N` with a larger N adds runs, {WAYS_OUT}"),
    ))
}

/// What is wrong with a table, without its name.
fn unquoted(error: &TableError, path: &Path) -> String {
    error.to_string().replacen(&format!("`{}` ", path.display()), "", 1)
}
