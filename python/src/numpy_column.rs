//! Columns of NumPy and pandas. Cells that are masked, NA or NaT are empty.

use std::sync::Arc;

use arrow_array::{
    ArrayRef, DurationNanosecondArray, Float64Array, Int64Array, TimestampNanosecondArray, UInt64Array,
};
use numpy::{Element, PyReadonlyArray1};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::given::of_list;

/// What NumPy has for a time that is not known.
const NOT_A_TIME: i64 = i64::MIN;

/// What nanoseconds in 64 bits can tell (s).
const FARTHEST_S: u64 = 9_223_372_036;

/// The column of an array of NumPy, or of a series of pandas; `None` if it is neither.
pub(crate) fn of_numpy(values: &Bound<'_, PyAny>) -> PyResult<Option<ArrayRef>> {
    let kind = values.getattr("dtype").and_then(|kind| kind.getattr("kind")).and_then(|kind| kind.extract::<char>());
    let Ok(kind) = kind else { return Ok(None) };
    let dimensions: usize = values.getattr("ndim")?.extract()?;
    if dimensions != 1 {
        return Err(PyTypeError::new_err(format!("an array has {dimensions} dimensions; allowed: 1")));
    }
    let column = Column::of(values)?;
    let array: ArrayRef = match kind {
        'f' => Arc::new(column.cells::<f64>("float64")?.collect::<Float64Array>()),
        'u' => {
            // Addresses of 64 bits are larger than whole numbers with a sign.
            let cells: Vec<Option<u64>> = column.cells("uint64")?.collect();
            let signed = cells.iter().map(|cell| cell.map(i64::try_from).transpose());
            match signed.collect::<Result<Int64Array, _>>() {
                Ok(cells) => Arc::new(cells),
                Err(_) => Arc::new(cells.into_iter().collect::<UInt64Array>()),
            }
        }
        'i' | 'b' => Arc::new(column.cells::<i64>("int64")?.collect::<Int64Array>()),
        'M' => Arc::new(column.times("datetime64[ns]")?.collect::<TimestampNanosecondArray>()),
        'm' => Arc::new(column.times("timedelta64[ns]")?.collect::<DurationNanosecondArray>()),
        _ => return of_list(&values.call_method0("tolist")?).map(Some),
    };
    Ok(Some(array))
}

/// Values, and which of them are gaps.
struct Column<'a, 'py> {
    values: &'a Bound<'py, PyAny>,
    gaps: Option<Vec<bool>>,
    is_pandas: bool,
}

impl<'a, 'py> Column<'a, 'py> {
    fn of(values: &'a Bound<'py, PyAny>) -> PyResult<Self> {
        let numpy = values.py().import("numpy")?;
        let masked = numpy.getattr("ma")?;
        let is_pandas = values.hasattr("isna")? && values.hasattr("to_numpy")?;
        let gaps = if values.is_instance(&masked.getattr("MaskedArray")?)? {
            Some(masked.call_method1("getmaskarray", (values,))?)
        } else if is_pandas {
            Some(values.call_method0("isna")?)
        } else {
            None
        };
        let gaps = gaps.map(|gaps| -> PyResult<Vec<bool>> {
            let gaps = numpy.call_method1("ascontiguousarray", (gaps, "bool"))?;
            Ok(gaps.extract::<PyReadonlyArray1<'_, bool>>()?.as_slice()?.to_vec())
        });
        Ok(Self { values, gaps: gaps.transpose()?, is_pandas })
    }

    /// The values as an array of this type; what a gap holds has no meaning.
    fn array(&self, kind: &str) -> PyResult<Bound<'py, PyAny>> {
        let py = self.values.py();
        let keywords = PyDict::new(py);
        keywords.set_item("dtype", kind)?;
        let has_gaps = self.gaps.as_ref().is_some_and(|gaps| gaps.contains(&true));
        if self.is_pandas && has_gaps && !kind.contains("64[") {
            keywords.set_item("na_value", 0)?;
            return self.values.call_method("to_numpy", (), Some(&keywords));
        }
        py.import("numpy")?.call_method("ascontiguousarray", (self.values,), Some(&keywords))
    }

    /// The cells as numbers of this type.
    fn cells<T: Element + Copy + 'static>(&self, kind: &str) -> PyResult<impl Iterator<Item = Option<T>>> {
        let array = self.values.py().import("numpy")?.call_method1("ascontiguousarray", (self.array(kind)?,))?;
        let values = array.extract::<PyReadonlyArray1<'_, T>>()?.as_slice()?.to_vec();
        let gaps = self.gaps.clone().unwrap_or_default();
        let is_gap = move |row: usize| gaps.get(row).copied().unwrap_or(false);
        Ok(values.into_iter().enumerate().map(move |(row, value)| (!is_gap(row)).then_some(value)))
    }

    /// The cells as times of this type, in nanoseconds. NumPy turns those that nanoseconds cannot tell into others.
    fn times(&self, kind: &str) -> PyResult<impl Iterator<Item = Option<i64>>> {
        let seconds = self.moments(&kind.replace("[ns]", "[s]"))?;
        if seconds.iter().flatten().any(|seconds| seconds.unsigned_abs() > FARTHEST_S) {
            let words = "a time is too far from 1970 for nanoseconds; allowed: from the year 1678 to 2262";
            return Err(PyValueError::new_err(words));
        }
        Ok(self.moments(kind)?.into_iter())
    }

    /// The cells as times of this type, in its unit.
    fn moments(&self, kind: &str) -> PyResult<Vec<Option<i64>>> {
        let values = self.array(kind)?.call_method1("view", ("int64",))?;
        let whole = Column { values: &values, gaps: self.gaps.clone(), is_pandas: false };
        Ok(whole.cells::<i64>("int64")?.map(|time| time.filter(|&time| time != NOT_A_TIME)).collect())
    }
}
