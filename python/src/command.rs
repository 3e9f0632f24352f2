//! The command `sextant`.

use std::ffi::OsString;
use std::path::PathBuf;
use std::process::{ExitCode, Termination};

use pyo3::prelude::*;
use sextant_cli::Invocation;

use crate::work::guarded;

/// Runs the command line: `program` is the path of the script that was called, `words` follow it. Returns the exit code.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, program: PathBuf, words: Vec<OsString>) -> PyResult<u8> {
    guarded(py, || sextant_cli::main(&Invocation::of_script(program, words))).map(code_of)
}

/// The number of an exit code, of which the standard library compares but does not tell it.
fn code_of(code: ExitCode) -> u8 {
    let code = code.report();
    (0..=u8::MAX).find(|&number| ExitCode::from(number) == code).unwrap_or(1)
}
