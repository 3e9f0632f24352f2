//! Whole numbers of Python within limits.

use std::ops::RangeInclusive;

use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBool;
use sextant::MOST_THREADS;
use sextant::kernel::text::shortened;

/// The whole number that is given for `name`: an `int`, or what has `__index__`, as numbers of NumPy have. True and False are
/// none.
pub(crate) fn whole(name: &str, value: &Bound<'_, PyAny>, allowed: RangeInclusive<u64>) -> PyResult<u64> {
    let words = || {
        let found = value.repr().map_or_else(|_| "unknown".to_owned(), |found| found.to_string());
        let (least, most) = (allowed.start(), allowed.end());
        format!("`{name}` is {}; allowed: a whole number from {least} to {most}", shortened(&found))
    };
    let index = value.py().import("operator")?.getattr("index")?;
    match index.call1((value,)) {
        Ok(number) if !value.is_instance_of::<PyBool>() => {
            let number = number.extract().ok().filter(|number| allowed.contains(number));
            number.ok_or_else(|| PyValueError::new_err(words()))
        }
        _ => Err(PyTypeError::new_err(words())),
    }
}

/// The same for a number of 32 bits.
pub(crate) fn whole_u32(name: &str, value: &Bound<'_, PyAny>, allowed: RangeInclusive<u32>) -> PyResult<u32> {
    let number = whole(name, value, u64::from(*allowed.start())..=u64::from(*allowed.end()))?;
    u32::try_from(number).map_err(|why| PyValueError::new_err(why.to_string()))
}

/// A number of threads; `None` is one for each core.
pub(crate) fn threads(value: Option<&Bound<'_, PyAny>>) -> PyResult<Option<usize>> {
    let Some(value) = value else { return Ok(None) };
    let number = whole("threads", value, 1..=MOST_THREADS as u64)?;
    Ok(usize::try_from(number).ok())
}
