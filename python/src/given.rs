//! Tables that are given by a user, as columns of Arrow.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
    UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchOptions, StringArray,
    new_empty_array,
};
use arrow_buffer::NullBuffer;
use arrow_schema::{ArrowError, DataType, Field, FieldRef, Schema};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyInt, PyString};

use crate::arrow_check::checked;
use crate::arrow_input::{Chunks, chunks_of};
use crate::entries::each_entry_of_dict;
use crate::numpy_column::of_numpy;
use crate::table::Table;
use crate::work::caught;

/// Make a :class:`Table` of anything that is a table.
///
/// Parameters
/// ----------
/// data : table
///     A data frame with the Arrow PyCapsule interface, a dict of columns, or a structured array of NumPy.
///
/// Returns
/// -------
/// Table
#[pyfunction]
pub(crate) fn table(data: &Bound<'_, PyAny>) -> PyResult<Table> {
    batch_of(data).map(Table::from)
}

/// The rows of `data`: anything with the Arrow PyCapsule interface, or columns by name (a dict, a data frame, a structured
/// array of NumPy).
pub(crate) fn batch_of(data: &Bound<'_, PyAny>) -> PyResult<RecordBatch> {
    if let Ok(table) = data.cast::<Table>() {
        return Ok(table.get().batch().clone());
    }
    caught(|| match chunks_of(data)? {
        Some(chunks) => of_chunks(data.py(), &chunks),
        None => of_columns(&columns_of(data)?),
    })
}

/// The rows of a table of Arrow.
fn of_chunks(py: Python<'_>, chunks: &Chunks) -> PyResult<RecordBatch> {
    let DataType::Struct(fields) = &chunks.kind else {
        let words = format!("a table is an array of the type {}; allowed: one with columns", chunks.kind);
        return Err(PyTypeError::new_err(words));
    };
    let column = |index: usize, field: &FieldRef| {
        let parts = chunks.parts.iter().map(|part| {
            let rows = part.as_struct();
            (Arc::clone(rows.column(index)), rows.nulls().cloned())
        });
        whole_column(py, field.name(), field.data_type(), parts)
    };
    let arrays: Vec<ArrayRef> =
        fields.iter().enumerate().map(|(index, field)| column(index, field)).collect::<PyResult<_>>()?;
    let fields =
        fields.iter().zip(&arrays).map(|(field, array)| Field::new(field.name(), array.data_type().clone(), true));
    let rows = chunks.parts.iter().map(|part| part.len()).sum();
    let options = RecordBatchOptions::new().with_row_count(Some(rows));
    let schema = Arc::new(Schema::new(fields.collect::<Vec<_>>()));
    RecordBatch::try_new_with_options(schema, arrays, &options).map_err(unsound)
}

/// A column of parts, each with the rows that are there if not all are: what is in it is checked.
fn whole_column(
    py: Python<'_>,
    name: &str,
    kind: &DataType,
    parts: impl Iterator<Item = (ArrayRef, Option<NullBuffer>)>,
) -> PyResult<ArrayRef> {
    let mut first = 0;
    let mut sound: Vec<ArrayRef> = Vec::new();
    for (part, rows) in parts {
        let part = checked(py, name, &part, first)?;
        first += part.len();
        sound.push(match rows {
            None => part,
            Some(rows) => {
                let missing = BooleanArray::new(!rows.inner(), None);
                arrow_select::nullif::nullif(&part, &missing).map_err(unsound)?
            }
        });
    }
    match &sound[..] {
        [] => Ok(new_empty_array(kind)),
        [only] => Ok(Arc::clone(only)),
        several => {
            let several: Vec<&dyn Array> = several.iter().map(AsRef::as_ref).collect();
            arrow_select::concat::concat(&several).map_err(unsound)
        }
    }
}

/// The exception that columns of Arrow do not go together.
#[expect(clippy::needless_pass_by_value, reason = "it is what `map_err` gives")]
fn unsound(why: ArrowError) -> PyErr {
    PyTypeError::new_err(why.to_string())
}

/// The columns of `data` by name.
fn columns_of<'py>(data: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyDict>> {
    let py = data.py();
    if let Ok(dict) = data.cast::<PyDict>() {
        return Ok(dict.clone());
    }
    let columns = PyDict::new(py);
    let names = match (data.getattr("columns"), data.getattr("dtype").and_then(|kind| kind.getattr("names"))) {
        (Ok(names), _) => names,
        (Err(_), Ok(names)) if !names.is_none() => names,
        _ => {
            let kind = data.get_type().name()?;
            return Err(PyTypeError::new_err(format!(
                "a table is a {kind}; allowed: a data frame (pandas, polars, pyarrow, duckdb: anything with the Arrow PyCapsule \
                 interface), a dict of columns, or a structured array of NumPy"
            )));
        }
    };
    for name in names.try_iter()? {
        let name = name?;
        columns.set_item(name.str()?, data.get_item(&name)?)?;
    }
    Ok(columns)
}

/// The columns as rows.
fn of_columns(columns: &Bound<'_, PyDict>) -> PyResult<RecordBatch> {
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    each_entry_of_dict(columns, "a column", |name, values| {
        let array = array_of(&name, &values).map_err(|why| of_column(columns.py(), &name, why))?;
        if let Some(first) = arrays.first()
            && first.len() != array.len()
        {
            let (rows, first) = (array.len(), first.len());
            return Err(PyTypeError::new_err(format!(
                "column `{name}` has {rows} rows, but the first column has {first}"
            )));
        }
        fields.push(Field::new(name, array.data_type().clone(), true));
        arrays.push(array);
        Ok(())
    })?;
    let options = RecordBatchOptions::new().with_row_count(Some(arrays.first().map_or(0, |array| array.len())));
    RecordBatch::try_new_with_options(Arc::new(Schema::new(fields)), arrays, &options).map_err(unsound)
}

/// The same exception with the name of the column, if its words are all that it has.
fn of_column(py: Python<'_>, name: &str, why: PyErr) -> PyErr {
    let words = format!("column `{name}`: {}", why.value(py));
    if why.get_type(py).is(py.get_type::<PyTypeError>()) {
        PyTypeError::new_err(words)
    } else if why.get_type(py).is(py.get_type::<PyValueError>()) {
        PyValueError::new_err(words)
    } else {
        why
    }
}

/// A column: of Arrow, of NumPy, or a list.
fn array_of(name: &str, values: &Bound<'_, PyAny>) -> PyResult<ArrayRef> {
    if let Some(chunks) = chunks_of(values)? {
        let parts = chunks.parts.into_iter().map(|part| (part, None));
        return whole_column(values.py(), name, &chunks.kind, parts);
    }
    match of_numpy(values)? {
        Some(column) => Ok(column),
        None => of_list(values),
    }
}

/// A list: of numbers, or of texts if any item is one. None, NaN and NA of pandas are empty cells.
pub(crate) fn of_list(values: &Bound<'_, PyAny>) -> PyResult<ArrayRef> {
    if ["str", "bytes", "bytearray", "dict", "set", "frozenset"].contains(&&*values.get_type().name()?.to_string()) {
        let kind = values.get_type().name()?;
        return Err(PyTypeError::new_err(format!("a column is a {kind}; allowed: a list, an array or a series")));
    }
    let items: Vec<Bound<'_, PyAny>> = values.try_iter()?.collect::<PyResult<_>>()?;
    if items.iter().any(|item| item.is_instance_of::<PyString>()) {
        let text = |item: &Bound<'_, PyAny>| -> PyResult<Option<String>> {
            if is_empty(item) { Ok(None) } else { item.str()?.extract::<String>().map(Some) }
        };
        return Ok(Arc::new(items.iter().map(text).collect::<PyResult<StringArray>>()?));
    }
    let whole = |item: &Bound<'_, PyAny>| if is_empty(item) { Ok(None) } else { item.extract::<i64>().map(Some) };
    if let Ok(whole) = items.iter().map(whole).collect::<PyResult<Int64Array>>() {
        return Ok(Arc::new(whole));
    }
    // Larger whole numbers are addresses, of which a float would make several one.
    if items.iter().all(|item| item.is_instance_of::<PyInt>() || is_empty(item)) {
        let digits = |item: &Bound<'_, PyAny>| -> PyResult<Option<String>> {
            if is_empty(item) { Ok(None) } else { item.str()?.extract::<String>().map(Some) }
        };
        return Ok(Arc::new(items.iter().map(digits).collect::<PyResult<StringArray>>()?));
    }
    let number = |item: &Bound<'_, PyAny>| if is_empty(item) { Ok(None) } else { item.extract::<f64>().map(Some) };
    Ok(Arc::new(items.iter().map(number).collect::<PyResult<Float64Array>>()?))
}

/// Whether an item of a list is an empty cell.
fn is_empty(item: &Bound<'_, PyAny>) -> bool {
    if item.is_none() {
        return true;
    }
    if item.is_instance_of::<PyString>() || item.is_instance_of::<PyInt>() {
        return false;
    }
    match item.extract::<f64>() {
        Ok(number) => number.is_nan(),
        // Of pandas, which need not be there.
        Err(_) => item.get_type().name().is_ok_and(|name| name == "NAType"),
    }
}

/// Texts of a column, each once, and the number of each row's.
#[expect(clippy::disallowed_types, reason = "texts are looked up, and their order is that of the rows")]
pub(crate) fn coded<'a>(texts: impl Iterator<Item = Option<&'a str>>) -> (Vec<u32>, Vec<String>) {
    let mut numbers: std::collections::HashMap<&'a str, u32> = std::collections::HashMap::new();
    let mut names = Vec::new();
    let codes = texts.map(|text| {
        let Some(text) = text else { return u32::MAX };
        *numbers.entry(text).or_insert_with(|| {
            names.push(text.to_owned());
            u32::try_from(names.len() - 1).unwrap_or(u32::MAX)
        })
    });
    (codes.collect(), names)
}

/// The numbers of a column, with NaN where there is none; `None` if it has no numbers.
pub(crate) fn numbers_of(array: &ArrayRef) -> Option<Vec<f64>> {
    /// One type of numbers.
    macro_rules! numbers {
        ($kind:ty, $number:expr) => {
            array.as_primitive::<$kind>().iter().map(|number| number.map_or(f64::NAN, $number)).collect()
        };
    }
    Some(match array.data_type() {
        DataType::Float16 => numbers!(Float16Type, f64::from),
        DataType::Float32 => numbers!(Float32Type, f64::from),
        DataType::Float64 => numbers!(Float64Type, |number| number),
        DataType::Decimal128(_, scale) => {
            let unit = 10_f64.powi(i32::from(*scale));
            numbers!(Decimal128Type, |number| number as f64 / unit)
        }
        _ => whole_of(array)?.into_iter().map(|number| number.map_or(f64::NAN, |number| number as f64)).collect(),
    })
}

/// The whole numbers of a column; `None` if it has others, or one that is too large.
pub(crate) fn whole_of(array: &ArrayRef) -> Option<Vec<Option<i64>>> {
    /// One type of whole numbers.
    macro_rules! whole {
        ($kind:ty) => {
            array.as_primitive::<$kind>().iter().map(|number| number.map(i64::from)).collect()
        };
    }
    Some(match array.data_type() {
        DataType::Int8 => whole!(Int8Type),
        DataType::Int16 => whole!(Int16Type),
        DataType::Int32 => whole!(Int32Type),
        DataType::Int64 => whole!(Int64Type),
        DataType::UInt8 => whole!(UInt8Type),
        DataType::UInt16 => whole!(UInt16Type),
        DataType::UInt32 => whole!(UInt32Type),
        DataType::UInt64 => {
            let numbers = array.as_primitive::<UInt64Type>().iter();
            numbers.map(|number| number.map(i64::try_from).transpose()).collect::<Result<_, _>>().ok()?
        }
        DataType::Boolean => array.as_boolean().iter().map(|flag| flag.map(i64::from)).collect(),
        _ => return None,
    })
}
