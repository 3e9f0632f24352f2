//! Tables: columns of Arrow, given to and taken from any library that knows them.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi::FFI_ArrowSchema;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{
    Decimal128Type, Float16Type, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
    UInt16Type, UInt32Type, UInt64Type,
};
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
};
use arrow_schema::{DataType, Field, Schema};
use numpy::{PyReadonlyArray1, ToPyArray};
use pyo3::exceptions::{PyImportError, PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList, PyString};
use pyo3_arrow::PyChunkedArray;
use pyo3_arrow::input::AnyRecordBatch;

/// Rows of a table that `repr` shows.
const SHOWN: usize = 10;

/// A table with columns by name. It has the Arrow PyCapsule interface, so that `pandas.DataFrame.from_arrow`, `polars.DataFrame`,
/// `pyarrow.table` and DuckDB take it as it is, without a copy.
#[pyclass(frozen, module = "sextant")]
#[derive(Clone)]
pub(crate) struct Table {
    batch: RecordBatch,
}

/// Makes a table, column by column.
#[derive(Default)]
pub(crate) struct Columns {
    fields: Vec<Field>,
    arrays: Vec<ArrayRef>,
}

impl Columns {
    fn add(mut self, name: &str, array: ArrayRef) -> Self {
        self.fields.push(Field::new(name, array.data_type().clone(), array.is_nullable()));
        self.arrays.push(array);
        self
    }

    pub(crate) fn texts(self, name: &str, values: impl IntoIterator<Item = impl AsRef<str>>) -> Self {
        self.add(name, Arc::new(StringArray::from_iter_values(values)))
    }

    pub(crate) fn optional_texts(self, name: &str, values: impl IntoIterator<Item = Option<String>>) -> Self {
        self.add(name, Arc::new(values.into_iter().collect::<StringArray>()))
    }

    pub(crate) fn numbers(self, name: &str, values: impl IntoIterator<Item = f64>) -> Self {
        self.add(name, Arc::new(Float64Array::from_iter_values(values)))
    }

    pub(crate) fn optional_numbers(self, name: &str, values: impl IntoIterator<Item = Option<f64>>) -> Self {
        self.add(name, Arc::new(values.into_iter().collect::<Float64Array>()))
    }

    pub(crate) fn whole(self, name: &str, values: impl IntoIterator<Item = i64>) -> Self {
        self.add(name, Arc::new(Int64Array::from_iter_values(values)))
    }

    pub(crate) fn optional_whole(self, name: &str, values: impl IntoIterator<Item = Option<i64>>) -> Self {
        self.add(name, Arc::new(values.into_iter().collect::<Int64Array>()))
    }

    pub(crate) fn flags(self, name: &str, values: impl IntoIterator<Item = bool>) -> Self {
        let values: Vec<bool> = values.into_iter().collect();
        self.add(name, Arc::new(BooleanArray::from(values)))
    }

    /// Changes the columns, if `condition` holds.
    pub(crate) fn when(self, condition: bool, change: impl FnOnce(Self) -> Self) -> Self {
        if condition { change(self) } else { self }
    }

    /// The table.
    pub(crate) fn table(self) -> PyResult<Table> {
        let batch = RecordBatch::try_new(Arc::new(Schema::new(self.fields)), self.arrays);
        Ok(Table { batch: batch.map_err(|why| PyTypeError::new_err(why.to_string()))? })
    }
}

impl Table {
    fn array(&self, name: &str) -> PyResult<&ArrayRef> {
        self.batch.column_by_name(name).ok_or_else(|| {
            let known: Vec<String> = self.column_names().iter().map(|name| format!("`{name}`")).collect();
            PyKeyError::new_err(format!("there is no column `{name}`; columns: {}", known.join(", ")))
        })
    }

    /// The cells of a row as texts.
    fn texts(&self, row: usize) -> Vec<String> {
        self.batch.columns().iter().map(|array| text(array, row)).collect()
    }
}

#[pymethods]
impl Table {
    /// The names of the columns.
    #[getter]
    fn column_names(&self) -> Vec<String> {
        self.batch.schema_ref().fields().iter().map(|field| field.name().clone()).collect()
    }

    fn __len__(&self) -> usize {
        self.batch.num_rows()
    }

    fn __contains__(&self, name: &str) -> bool {
        self.batch.column_by_name(name).is_some()
    }

    /// The values of a column as a list; an empty cell is None.
    fn to_list<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyList>> {
        list(py, self.array(name)?)
    }

    /// The values of a column as an array of NumPy. An empty cell is NaN, or None among texts.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let array = self.array(name)?;
        let with_gaps = array.null_count() > 0;
        match array.data_type() {
            DataType::Float64 | DataType::Int64 if with_gaps => {
                let numbers = numbers_of(array).unwrap_or_default();
                Ok(numbers.to_pyarray(py).into_any())
            }
            DataType::Float64 => Ok(array.as_primitive::<Float64Type>().values().to_pyarray(py).into_any()),
            DataType::Int64 => Ok(array.as_primitive::<Int64Type>().values().to_pyarray(py).into_any()),
            DataType::Boolean if !with_gaps => {
                Ok(array.as_boolean().values().iter().collect::<Vec<_>>().to_pyarray(py).into_any())
            }
            _ => {
                let keywords = PyDict::new(py);
                keywords.set_item("dtype", "object")?;
                py.import("numpy")?.call_method("array", (list(py, array)?,), Some(&keywords))
            }
        }
    }

    /// The table as a dict of lists.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, array) in self.column_names().iter().zip(self.batch.columns()) {
            dict.set_item(name, list(py, array)?)?;
        }
        Ok(dict)
    }

    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyCapsule>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A producer may leave the requested schema out of account.
        drop(requested_schema);
        let batches = RecordBatchIterator::new([Ok(self.batch.clone())], self.batch.schema());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(batches)), c"arrow_array_stream")
    }

    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.batch.schema_ref().as_ref());
        let schema = schema.map_err(|why| PyTypeError::new_err(why.to_string()))?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    fn __repr__(&self) -> String {
        let names = self.column_names();
        let rows = self.batch.num_rows();
        let shown = (0..rows.min(SHOWN)).map(|row| self.texts(row));
        let lines: Vec<Vec<String>> = [names.clone()].into_iter().chain(shown).collect();
        let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max().unwrap_or(0);
        let widths: Vec<usize> = (0..names.len()).map(width).collect();
        let mut text = format!("sextant.Table: {rows} rows\n");
        for line in &lines {
            let cells: Vec<String> =
                line.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}")).collect();
            text += cells.join("  ").trim_end();
            text.push('\n');
        }
        if rows > SHOWN {
            text += "..";
        }
        text.trim_end().to_owned()
    }

    fn _repr_html_(&self) -> String {
        let row = |cells: &[String], tag: &str| {
            let cells: String = cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escaped(cell))).collect();
            format!("<tr>{cells}</tr>")
        };
        let rows = self.batch.num_rows();
        let body: String = (0..rows.min(SHOWN)).map(|at| row(&self.texts(at), "td")).collect();
        let more =
            if rows > SHOWN { format!("<p>{rows} rows, of which {SHOWN} are shown</p>") } else { String::new() };
        format!("<table>{}{body}</table>{more}", row(&self.column_names(), "th"))
    }

    /// For pickle: the columns as lists.
    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyAny>, (Bound<'py, PyDict>,))> {
        Ok((py.import("sextant._native")?.getattr("Table")?.getattr("of_dict")?, (self.to_dict(py)?,)))
    }

    /// A table of a dict of lists, arrays of NumPy, or columns of Arrow.
    #[staticmethod]
    fn of_dict(columns: &Bound<'_, PyDict>) -> PyResult<Self> {
        Ok(Self { batch: of_columns(columns)? })
    }
}

/// The text of a cell of a table of ours.
fn text(array: &ArrayRef, row: usize) -> String {
    if array.is_null(row) {
        return String::new();
    }
    match array.data_type() {
        DataType::Float64 => array.as_primitive::<Float64Type>().value(row).to_string(),
        DataType::Int64 => array.as_primitive::<Int64Type>().value(row).to_string(),
        DataType::Boolean => array.as_boolean().value(row).to_string(),
        DataType::Utf8 => array.as_string::<i32>().value(row).to_owned(),
        other => other.to_string(),
    }
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

/// A text inside of HTML.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The values of an array as a list.
fn list<'py>(py: Python<'py>, array: &ArrayRef) -> PyResult<Bound<'py, PyList>> {
    match array.data_type() {
        DataType::Float64 => PyList::new(py, array.as_primitive::<Float64Type>().iter()),
        DataType::Int64 => PyList::new(py, array.as_primitive::<Int64Type>().iter()),
        DataType::Boolean => PyList::new(py, array.as_boolean().iter()),
        DataType::Utf8 => PyList::new(py, array.as_string::<i32>().iter()),
        other => Err(PyTypeError::new_err(format!("a column of {other} cannot be a list"))),
    }
}

/// The rows of `data`: anything with the Arrow PyCapsule interface, or columns by name (a dict, a data frame, a structured
/// array of NumPy).
pub(crate) fn batch_of(data: &Bound<'_, PyAny>) -> PyResult<RecordBatch> {
    if let Ok(table) = data.cast::<Table>() {
        return Ok(table.get().batch.clone());
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
