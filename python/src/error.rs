//! Errors of the library as exceptions.

use std::fmt::Display;
use std::path::Path;

use pyo3::create_exception;
use pyo3::exceptions::{PyException, PyKeyboardInterrupt, PyOSError, PyRuntimeError};
use pyo3::prelude::*;
use sextant::export::ExportError;
use sextant::logs::RobotLogError;
use sextant::mapping::MapLogError;
use sextant::next::NextError;
use sextant::recording::RecordingError;
use sextant::recording::admission::OutputRefusal;
use sextant::scenario::ScenarioError as OneError;
use sextant::{RunError as LibraryRunError, ScenarioErrors};
use sextant_study::sweep::SweepError;

create_exception!(sextant, SextantError, PyException, "An error of Sextant: the base of all others.");
create_exception!(
    sextant,
    ScenarioError,
    SextantError,
    "A scenario is not valid. `key`, `found`, `allowed`, `file`, `line` and `column` are those of the first error, where they \
     are known; `errors` has all of them."
);
create_exception!(
    sextant,
    LogError,
    SextantError,
    "A log is not valid. `file` is the file or the table, `row` the row of a table (from 0), `line` the line of a file (from 1), \
     `column`, `found` and `allowed` are those of a cell, where they are known."
);
create_exception!(sextant, RunError, SextantError, "A run, a map or a sweep failed.");

/// Adds the exceptions to the module.
pub(crate) fn add(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    let places = ["key", "found", "allowed", "file", "line", "row", "column"];
    for class in [py.get_type::<ScenarioError>(), py.get_type::<LogError>()] {
        // What is not known of an error is None.
        places.iter().try_for_each(|name| class.setattr(name, py.None()))?;
    }
    module.add("SextantError", py.get_type::<SextantError>())?;
    module.add("ScenarioError", py.get_type::<ScenarioError>())?;
    module.add("LogError", py.get_type::<LogError>())?;
    module.add("RunError", py.get_type::<RunError>())
}

/// Turns an error of the library into an exception.
pub(crate) trait IntoException {
    fn into_exception(self, py: Python<'_>) -> PyErr;
}

/// The same for results.
pub(crate) trait OrException<T> {
    fn or_exception(self, py: Python<'_>) -> PyResult<T>;
}

impl<T, E: IntoException> OrException<T> for Result<T, E> {
    fn or_exception(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| error.into_exception(py))
    }
}

/// An exception with attributes.
struct Attributes<'py>(Bound<'py, PyAny>, PyErr);

impl<'py> Attributes<'py> {
    fn of(py: Python<'py>, error: PyErr) -> Self {
        Self(error.value(py).clone().into_any(), error)
    }

    /// Sets an attribute. One that cannot be set would be an error of ours, and the exception itself says more.
    fn with(self, name: &str, value: impl IntoPyObject<'py>) -> Self {
        let _ = self.0.setattr(name, value);
        self
    }

    fn done(self) -> PyErr {
        self.1
    }
}

impl IntoException for ScenarioErrors {
    fn into_exception(self, py: Python<'_>) -> PyErr {
        let all: Vec<PyErr> = self.errors().iter().map(|error| of_one(py, error)).collect();
        let mut message = String::new();
        for error in self.errors() {
            if !message.is_empty() {
                message.push('\n');
            }
            message += &told(error);
        }
        let first = self.errors().first().map(|error| of_one_with(py, error, message));
        match first {
            Some(first) => {
                let values: Vec<_> = all.into_iter().map(|error| error.into_value(py)).collect();
                Attributes::of(py, first).with("errors", values).done()
            }
            None => ScenarioError::new_err("the scenario is not valid"),
        }
    }
}

/// The error with its place and its advice, in one line.
fn told(error: &OneError) -> String {
    let place = error.place().map_or_else(String::new, |place| format!("{place}: "));
    format!("{place}{}", advised(error, error.advice()))
}

/// An error with its advice, in one line.
fn advised(error: &impl Display, advice: Option<&str>) -> String {
    advice.map_or_else(|| error.to_string(), |advice| format!("{error}; {advice}"))
}

fn of_one(py: Python<'_>, error: &OneError) -> PyErr {
    of_one_with(py, error, told(error))
}

fn of_one_with(py: Python<'_>, error: &OneError, message: String) -> PyErr {
    let setting = error.setting();
    let (line, column) = error.line_and_column().unzip();
    Attributes::of(py, ScenarioError::new_err(message))
        .with("key", setting.map(|setting| setting.key.clone()))
        .with("found", setting.and_then(|setting| setting.found.clone()))
        .with("allowed", setting.and_then(|setting| setting.allowed.clone()))
        .with("file", error.excerpt().map(|excerpt| excerpt.source.clone()))
        .with("line", line)
        .with("column", column)
        .with("errors", Vec::<String>::new())
        .done()
}

impl IntoException for RobotLogError {
    fn into_exception(self, py: Python<'_>) -> PyErr {
        if matches!(self, Self::Interrupted(_)) {
            return PyKeyboardInterrupt::new_err(());
        }
        let at = self.row_address();
        let file =
            at.and_then(|at| at.file().map(|file| file.display().to_string()).or(at.table().map(str::to_owned)));
        let (line, row) = (at.and_then(|at| at.line()), at.and_then(|at| at.row()));
        let cell = match &self {
            Self::Cell { column, found, allowed, .. } => Some((column.clone(), found.clone(), allowed.clone())),
            _ => None,
        };
        let (column, found, allowed) = match cell {
            Some((column, found, allowed)) => (Some(column), Some(found), Some(allowed)),
            None => (None, None, None),
        };
        Attributes::of(py, LogError::new_err(self.to_string()))
            .with("file", file)
            .with("line", line)
            .with("row", row)
            .with("column", column)
            .with("found", found)
            .with("allowed", allowed)
            .done()
    }
}

impl IntoException for MapLogError {
    fn into_exception(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            Self::Settings(errors) => errors.into_exception(py),
            Self::Log(error) => error.into_exception(py),
            Self::Recording(error) => error.into_exception(py),
            error => RunError::new_err(error.to_string()),
        }
    }
}

impl IntoException for NextError {
    fn into_exception(self, py: Python<'_>) -> PyErr {
        match self {
            Self::Map(error) => error.into_exception(py),
            Self::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            error => RunError::new_err(error.to_string()),
        }
    }
}

impl IntoException for LibraryRunError {
    fn into_exception(self, _py: Python<'_>) -> PyErr {
        match self {
            Self::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            error => RunError::new_err(advised(&error, error.advice())),
        }
    }
}

impl IntoException for SweepError {
    fn into_exception(self, _py: Python<'_>) -> PyErr {
        match self {
            Self::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            error => RunError::new_err(advised(&error, error.advice())),
        }
    }
}

impl IntoException for RecordingError {
    fn into_exception(self, _py: Python<'_>) -> PyErr {
        match self {
            Self::Interrupted(_) => PyKeyboardInterrupt::new_err(()),
            error => LogError::new_err(error.to_string()),
        }
    }
}

impl IntoException for ExportError {
    fn into_exception(self, _py: Python<'_>) -> PyErr {
        RunError::new_err(self.to_string())
    }
}

impl IntoException for OutputRefusal {
    fn into_exception(self, _py: Python<'_>) -> PyErr {
        PyOSError::new_err(advised(&self, self.advice()))
    }
}

/// The exception that the library itself failed, which is an error of ours.
pub(crate) fn failed_inside(panic: &(dyn std::any::Any + Send)) -> PyErr {
    let words = panic_words(panic);
    PyRuntimeError::new_err(format!("Sextant has failed inside, which is an error of Sextant: {words}"))
}

/// What a library said when it gave up.
pub(crate) fn panic_words(panic: &(dyn std::any::Any + Send)) -> &str {
    let words = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
    words.unwrap_or("no reason is known")
}

/// The exception that a cell of a table, or the whole column if no row is known, is not what is allowed.
pub(crate) fn of_cell(py: Python<'_>, column: &str, row: Option<usize>, found: &str, allowed: &str) -> PyErr {
    let at = row.map_or_else(String::new, |row| format!(" in row {row}"));
    let error = LogError::new_err(format!("column `{column}` has {found}{at}; allowed: {allowed}"));
    Attributes::of(py, error)
        .with("row", row)
        .with("column", column)
        .with("found", found)
        .with("allowed", allowed)
        .done()
}

/// The exception that a file cannot be read or written.
pub(crate) fn of_file(path: &Path, why: impl Display) -> PyErr {
    PyOSError::new_err(format!("`{}`: {why}", path.display()))
}
