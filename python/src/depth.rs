//! How deep what Python hands over may be nested.

use pyo3::PyResult;
use pyo3::exceptions::PyValueError;

/// What is nested deeper is refused: whatever reads it calls itself for each level, and what holds itself has no end.
const MOST_DEEP: usize = 64;

/// How deep the value is that is read now.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Depth(usize);

impl Depth {
    /// The depth of what is in this value. `what` says of what, for the error.
    pub(crate) fn inner(self, what: &str) -> PyResult<Self> {
        if self.0 < MOST_DEEP {
            Ok(Self(self.0 + 1))
        } else {
            let words = format!("{what} is nested more than {MOST_DEEP} deep, or holds itself; allowed: {MOST_DEEP}");
            Err(PyValueError::new_err(words))
        }
    }
}
