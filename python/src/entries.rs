//! The entries of a mapping. Reading one of them may run code of the user, which may change the mapping.

use pyo3::exceptions::{PyRuntimeError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyString};

/// Calls `take` with the name and the value of each entry. `what` says what has the name, for the error.
pub(crate) fn each_entry<'py>(
    mapping: &Bound<'py, PyMapping>,
    what: &str,
    mut take: impl FnMut(String, Bound<'py, PyAny>) -> PyResult<()>,
) -> PyResult<()> {
    // A copy: an iterator over the mapping itself would fail if the mapping changed meanwhile.
    let items = mapping.items()?;
    let count = items.len();
    for item in items {
        let (name, value): (Bound<'py, PyAny>, Bound<'py, PyAny>) = item.extract()?;
        let Ok(name) = name.cast::<PyString>() else {
            let kind = name.get_type().name()?;
            return Err(PyTypeError::new_err(format!("the name of {what} is a {kind}; allowed: str")));
        };
        take(name.to_str()?.to_owned(), value)?;
    }
    unchanged(count, mapping.len()?, "dict")
}

/// The same for a dict.
pub(crate) fn each_entry_of_dict<'py>(
    dict: &Bound<'py, PyDict>,
    what: &str,
    take: impl FnMut(String, Bound<'py, PyAny>) -> PyResult<()>,
) -> PyResult<()> {
    each_entry(dict.as_mapping(), what, take)
}

/// Refuses a collection that had `before` items when it began to be read, and has `after` now.
pub(crate) fn unchanged(before: usize, after: usize, kind: &str) -> PyResult<()> {
    if before == after {
        Ok(())
    } else {
        let words = format!("a {kind} was changed while it was read: it had {before} items, and has {after}");
        Err(PyRuntimeError::new_err(words))
    }
}
