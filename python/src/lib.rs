//! The module `sextant._native` of Python: scenarios, runs, logs and maps of the crate `sextant`, and sweeps of `sextant-study`.
//!
//! Users see it through the package `sextant` beside it, whose classes have the documentation. What is here is small: it turns
//! values of Python into those of the library and back, keeps the interpreter free while the library works, and lets programs
//! of the user be called by a simulation.

mod arrow_check;
mod arrow_input;
mod command;
mod depth;
mod entries;
mod error;
mod given;
mod localise;
mod log;
mod map;
mod names;
mod next;
mod numpy_column;
mod options;
mod picture;
mod programs;
mod recorded;
mod run;
mod scenario;
mod sweep;
mod table;
mod table_log;
mod track;
mod values;
mod whole;
mod work;

use pyo3::prelude::*;

/// The module.
#[pymodule]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    error::add(module)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<table::Table>()?;
    module.add_class::<scenario::Scenario>()?;
    module.add_class::<run::Run>()?;
    module.add_class::<log::Log>()?;
    module.add_class::<map::Map>()?;
    module.add_class::<track::Tracks>()?;
    programs::add(module)?;
    module.add_function(wrap_pyfunction!(given::table, module)?)?;
    module.add_function(wrap_pyfunction!(log::read, module)?)?;
    module.add_function(wrap_pyfunction!(log::log_of_tables, module)?)?;
    module.add_function(wrap_pyfunction!(map::algorithms, module)?)?;
    module.add_function(wrap_pyfunction!(next::next_stops, module)?)?;
    module.add_function(wrap_pyfunction!(track::track, module)?)?;
    module.add_function(wrap_pyfunction!(sweep::sweep, module)?)?;
    module.add_function(wrap_pyfunction!(localise::localise, module)?)?;
    module.add_function(wrap_pyfunction!(command::main, module)?)?;
    Ok(())
}
