//! Sweeps.

use std::num::NonZeroU32;
use std::path::PathBuf;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use sextant::recording::admission::{OutputKind, Outputs, Replace};
use sextant_study::sweep::{self as sweeps, ColumnKind, Shard, Sweep, TableError};

use crate::entries::each_entry_of_dict;
use crate::error::{OrException, RunError};
use crate::scenario::{Scenario, settings as settings_of};
use crate::table::{Columns, Table};
use crate::values::toml;
use crate::whole::{threads, whole_u32};
use crate::work::{guarded, supervised};

/// What is swept.
#[derive(FromPyObject)]
pub(crate) enum Swept<'py> {
    /// A scenario that is made.
    Scenario(PyRef<'py, Scenario>),
    /// The path of a file.
    Path(PathBuf),
}

/// Runs a scenario with many settings and seeds. Returns the table of all runs.
#[pyfunction]
#[pyo3(signature = (swept, settings, axes, runs=None, out=None, resume=false, force=false, progress=None, threads=None))]
#[expect(clippy::too_many_arguments, reason = "they are keywords in Python")]
pub(crate) fn sweep(
    py: Python<'_>,
    swept: Swept<'_>,
    settings: &Bound<'_, PyDict>,
    axes: &Bound<'_, PyDict>,
    runs: Option<&Bound<'_, PyAny>>,
    out: Option<PathBuf>,
    resume: bool,
    force: bool,
    progress: Option<Py<PyAny>>,
    threads: Option<&Bound<'_, PyAny>>,
) -> PyResult<Table> {
    let threads = self::threads(threads)?;
    let runs = runs.map(|runs| whole_u32("runs", runs, 1..=u32::MAX)).transpose()?.and_then(NonZeroU32::new);
    let (mut set, seed) = settings_of(settings)?;
    each_entry_of_dict(axes, "an axis", |key, values| {
        set.push(format!("sweep.product.{}={}", serde_json::Value::from(key), toml(&values)?));
        Ok(())
    })?;
    let plan = match swept {
        Swept::Path(path) => guarded(py, || Sweep::read(&path, &set, seed, runs))?,
        Swept::Scenario(scenario) => {
            let scenario = scenario.0.clone();
            let (own, own_seed) = scenario.overrides();
            let set: Vec<String> = own.iter().cloned().chain(set).collect();
            guarded(py, || Sweep::of(scenario.file().clone(), &set, seed.or(own_seed), runs))?
        }
    };
    let plan = plan.or_exception(py)?;
    if let Some(out) = &out {
        let mut outputs = Outputs::new(if force { Replace::Any } else { Replace::Ours });
        let named = plan.named_files().iter().map(|file| file.path.as_path());
        plan.file().layers().chain(named).for_each(|path| {
            outputs.reads(path);
        });
        outputs.writes("out", out, OutputKind::Table).admit().or_exception(py)?;
    }
    let table = |why: TableError| RunError::new_err(why.to_string());
    let (columns, texts) = match &out {
        Some(out) => {
            let rows = supervised(py, threads, progress.as_ref(), |supervisor| {
                sweeps::run(&plan, Shard::default(), out, resume, supervisor)
            })?;
            let rows = rows.or_exception(py)?;
            sweeps::write_table(out, &plan, &rows).map_err(table)?;
            let made = sweeps::table(&plan, &rows).map_err(table)?;
            sweeps::clear_parts(out).or_exception(py)?;
            made
        }
        None => {
            let made = supervised(py, threads, progress.as_ref(), |supervisor| {
                let (mut rows, outcome) = sweeps::rows(std::slice::from_ref(&plan), supervisor);
                outcome.map(|()| rows.pop().unwrap_or_default())
            })?;
            let rows = made.or_exception(py)?;
            sweeps::table(&plan, &rows.as_slice()).map_err(table)?
        }
    };
    let mut made = Columns::default();
    for (at, column) in columns.iter().enumerate() {
        let cells = || texts.iter().map(|row| row[at].as_str()).map(|cell| (!cell.is_empty()).then_some(cell));
        made = match column.kind {
            ColumnKind::Integer => {
                made.optional_whole(&column.name, cells().map(|cell| cell.and_then(|cell| cell.parse().ok())))
            }
            ColumnKind::Unsigned => {
                made.optional_unsigned(&column.name, cells().map(|cell| cell.and_then(|cell| cell.parse().ok())))
            }
            ColumnKind::Real => {
                made.optional_numbers(&column.name, cells().map(|cell| cell.and_then(|cell| cell.parse().ok())))
            }
            ColumnKind::Text => made.optional_texts(&column.name, cells().map(|cell| cell.map(str::to_owned))),
        };
    }
    made.table().map_err(|why| PyValueError::new_err(why.to_string()))
}
