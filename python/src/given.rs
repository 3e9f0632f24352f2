//! Tables that are given by a user, as columns of Arrow.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
    UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{Array, ArrayRef, Float64Array, Int64Array, RecordBatch, StringArray};
use arrow_schema::{DataType, Field, Schema};
use numpy::PyReadonlyArray1;
use pyo3::exceptions::{PyImportError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use pyo3_arrow::PyChunkedArray;
use pyo3_arrow::input::AnyRecordBatch;

use crate::table::Table;

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
    if data.hasattr("__arrow_c_stream__")? || data.hasattr("__arrow_c_array__")? {
        // A data frame of pandas gives a stream only if pyarrow is installed.
        match data.extract::<AnyRecordBatch>() {
            Ok(stream) => return collected(stream),
            Err(error) if !error.is_instance_of::<PyImportError>(data.py()) => return Err(error),
            Err(_) => {}
        }
    }
    of_columns(&columns_of(data)?)
}

fn collected(stream: AnyRecordBatch) -> PyResult<RecordBatch> {
    let reader = stream.into_reader()?;
    let schema = reader.schema();
    let wrong = |why: arrow_schema::ArrowError| PyTypeError::new_err(why.to_string());
    let batches: Vec<RecordBatch> = reader.collect::<Result<_, _>>().map_err(wrong)?;
    match <[RecordBatch; 1]>::try_from(batches) {
        Ok([batch]) => Ok(batch),
        Err(batches) => arrow_select::concat::concat_batches(&schema, &batches).map_err(wrong),
    }
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
    for (name, values) in columns {
        let name: String = name.extract().map_err(|_| PyTypeError::new_err("the name of a column must be a str"))?;
        let array = array_of(&values)
            .map_err(|why| PyTypeError::new_err(format!("column `{name}`: {}", why.value(columns.py()))))?;
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
    }
    let batch = RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays);
    batch.map_err(|why| PyTypeError::new_err(why.to_string()))
}

/// A column: of Arrow, of NumPy, or a list.
fn array_of(values: &Bound<'_, PyAny>) -> PyResult<ArrayRef> {
    if values.hasattr("__arrow_c_array__")? || values.hasattr("__arrow_c_stream__")? {
        match values.extract::<PyChunkedArray>() {
            Ok(chunks) => {
                let chunks: Vec<&dyn Array> = chunks.chunks().iter().map(AsRef::as_ref).collect();
                let whole = arrow_select::concat::concat(&chunks);
                return whole.map_err(|why| PyTypeError::new_err(why.to_string()));
            }
            Err(error) if !error.is_instance_of::<PyImportError>(values.py()) => return Err(error),
            Err(_) => {}
        }
    }
    let kind = values.getattr("dtype").and_then(|kind| kind.getattr("kind")).and_then(|kind| kind.extract::<char>());
    let py = values.py();
    let Ok(kind) = kind else { return of_list(values) };
    let numpy = py.import("numpy")?;
    let array = |kind: &str| {
        let keywords = PyDict::new(py);
        keywords.set_item("dtype", kind)?;
        numpy.call_method("ascontiguousarray", (values,), Some(&keywords))
    };
    match kind {
        'f' => Ok(Arc::new(Float64Array::from(
            array("float64")?.extract::<PyReadonlyArray1<'_, f64>>()?.as_slice()?.to_vec(),
        ))),
        'i' | 'u' | 'b' => Ok(Arc::new(Int64Array::from(
            array("int64")?.extract::<PyReadonlyArray1<'_, i64>>()?.as_slice()?.to_vec(),
        ))),
        'M' => {
            let instants = array("datetime64[ns]")?.call_method1("view", ("int64",))?;
            let instants = instants.extract::<PyReadonlyArray1<'_, i64>>()?.as_slice()?.to_vec();
            let instants = instants.into_iter().map(|instant| (instant != i64::MIN).then_some(instant));
            Ok(Arc::new(instants.collect::<arrow_array::TimestampNanosecondArray>()))
        }
        _ => of_list(&values.call_method0("tolist")?),
    }
}

/// A list: of numbers, or of texts if any item is one. None and NaN are empty cells.
fn of_list(values: &Bound<'_, PyAny>) -> PyResult<ArrayRef> {
    let items: Vec<Bound<'_, PyAny>> = values.try_iter()?.collect::<PyResult<_>>()?;
    let is_empty = |item: &Bound<'_, PyAny>| item.is_none() || item.extract::<f64>().is_ok_and(f64::is_nan);
    if items.iter().any(|item| item.is_instance_of::<PyString>()) {
        let text = |item: &Bound<'_, PyAny>| {
            let text = || item.str().and_then(|text| text.extract::<String>());
            if is_empty(item) { Ok(None) } else { text().map(Some) }
        };
        return Ok(Arc::new(items.iter().map(text).collect::<PyResult<StringArray>>()?));
    }
    if let Ok(whole) = items.iter().map(|item| item.extract::<Option<i64>>()).collect::<PyResult<Int64Array>>() {
        return Ok(Arc::new(whole));
    }
    let number = |item: &Bound<'_, PyAny>| if is_empty(item) { Ok(None) } else { item.extract::<f64>().map(Some) };
    Ok(Arc::new(items.iter().map(number).collect::<PyResult<Float64Array>>()?))
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
