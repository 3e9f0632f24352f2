//! Tables that are given to a user: columns of Arrow, which any library takes that knows them.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::ffi::FFI_ArrowSchema;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float64Type, Int64Type, UInt64Type};
use arrow_array::{
    Array, ArrayRef, BooleanArray, Float64Array, Int64Array, RecordBatch, RecordBatchIterator, StringArray,
    UInt64Array,
};
use arrow_schema::{DataType, Field, Schema};
use numpy::ToPyArray;
use pyo3::exceptions::{PyKeyError, PyTypeError};
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyDict, PyList};
use sextant::channel::Position;
use sextant::kernel::text::{printable, shortened};

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

    /// Places (m), as three columns.
    pub(crate) fn places(self, places: impl Iterator<Item = Position> + Clone) -> Self {
        self.numbers("x_m", places.clone().map(|place| place.x_m))
            .numbers("y_m", places.clone().map(|place| place.y_m))
            .numbers("z_m", places.map(|place| place.z_m))
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

    pub(crate) fn optional_unsigned(self, name: &str, values: impl IntoIterator<Item = Option<u64>>) -> Self {
        self.add(name, Arc::new(values.into_iter().collect::<UInt64Array>()))
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

impl From<RecordBatch> for Table {
    fn from(batch: RecordBatch) -> Self {
        Self { batch }
    }
}

impl Table {
    /// Its rows.
    pub(crate) fn batch(&self) -> &RecordBatch {
        &self.batch
    }

    fn array(&self, name: &str) -> PyResult<ArrayRef> {
        self.batch.column_by_name(name).map(plain).ok_or_else(|| {
            let known: Vec<String> = self.column_names().iter().map(|name| format!("`{name}`")).collect();
            PyKeyError::new_err(format!("there is no column `{name}`; columns: {}", known.join(", ")))
        })
    }

    /// The cells of a row as texts.
    fn texts(&self, row: usize) -> Vec<String> {
        self.batch.columns().iter().map(|array| text(&plain(&array.slice(row, 1)), 0)).collect()
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
        list(py, &self.array(name)?)
    }

    /// The values of a column as an array of NumPy. An empty cell is NaN, or None among texts.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let array = self.array(name)?;
        let with_gaps = array.null_count() > 0;
        match array.data_type() {
            DataType::Float64 if with_gaps => {
                Ok(with_nan(array.as_primitive::<Float64Type>().iter(), |number| number).to_pyarray(py).into_any())
            }
            DataType::Int64 if with_gaps => {
                Ok(with_nan(array.as_primitive::<Int64Type>().iter(), |number| number as f64)
                    .to_pyarray(py)
                    .into_any())
            }
            DataType::Float64 => Ok(array.as_primitive::<Float64Type>().values().to_pyarray(py).into_any()),
            DataType::Int64 => Ok(array.as_primitive::<Int64Type>().values().to_pyarray(py).into_any()),
            DataType::UInt64 if !with_gaps => {
                Ok(array.as_primitive::<UInt64Type>().values().to_pyarray(py).into_any())
            }
            DataType::Boolean if !with_gaps => {
                Ok(array.as_boolean().values().iter().collect::<Vec<_>>().to_pyarray(py).into_any())
            }
            _ => {
                let keywords = PyDict::new(py);
                keywords.set_item("dtype", "object")?;
                py.import("numpy")?.call_method("array", (list(py, &array)?,), Some(&keywords))
            }
        }
    }

    /// The table as a data frame of pandas.
    fn to_pandas<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let columns = PyDict::new(py);
        for name in self.column_names() {
            columns.set_item(&name, self.__getitem__(py, &name)?)?;
        }
        py.import("pandas")?.call_method1("DataFrame", (columns,))
    }

    /// The table as a data frame of polars.
    fn to_polars<'py>(slf: PyRef<'py, Self>, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("polars")?.call_method1("DataFrame", (slf,))
    }

    /// The table as a table of pyarrow.
    fn to_arrow<'py>(slf: PyRef<'py, Self>, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("pyarrow")?.call_method1("table", (slf,))
    }

    /// The table as a dict of lists.
    fn to_dict<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let dict = PyDict::new(py);
        for (name, array) in self.column_names().iter().zip(self.batch.columns()) {
            dict.set_item(name, list(py, &plain(array))?)?;
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
        let line = |cells: Vec<String>| cells.iter().map(|cell| on_one_line(cell)).collect();
        let lines: Vec<Vec<String>> = [names.clone()].into_iter().chain(shown).map(line).collect();
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
        Ok((py.import("sextant._native")?.getattr("table")?, (self.to_dict(py)?,)))
    }
}

/// A column in the types of our tables, as far as it means the same in one of them.
fn plain(array: &ArrayRef) -> ArrayRef {
    let kind = match array.data_type() {
        DataType::Int8 | DataType::Int16 | DataType::Int32 => DataType::Int64,
        DataType::UInt8 | DataType::UInt16 | DataType::UInt32 => DataType::Int64,
        DataType::Float16 | DataType::Float32 => DataType::Float64,
        DataType::LargeUtf8 | DataType::Utf8View | DataType::Null => DataType::Utf8,
        DataType::Dictionary(_, values) => match arrow_cast::cast(array, values) {
            Ok(values) => return plain(&values),
            Err(_) => return Arc::clone(array),
        },
        _ => return Arc::clone(array),
    };
    arrow_cast::cast(array, &kind).unwrap_or_else(|_| Arc::clone(array))
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

/// Numbers, with NaN where there is none.
fn with_nan<N>(numbers: impl Iterator<Item = Option<N>>, number: fn(N) -> f64) -> Vec<f64> {
    numbers.map(|found| found.map_or(f64::NAN, number)).collect()
}

/// A cell in a line of text: not too long, and without characters that a terminal would obey.
fn on_one_line(cell: &str) -> String {
    printable(&shortened(cell)).replace('\n', "\\n").replace('\t', "\\t")
}

/// A text inside of HTML. What would change how the text around it is shown is written as `\u{202e}`.
fn escaped(text: &str) -> String {
    printable(text).replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The values of an array as a list.
fn list<'py>(py: Python<'py>, array: &ArrayRef) -> PyResult<Bound<'py, PyList>> {
    match array.data_type() {
        DataType::Float64 => PyList::new(py, array.as_primitive::<Float64Type>().iter()),
        DataType::Int64 => PyList::new(py, array.as_primitive::<Int64Type>().iter()),
        DataType::UInt64 => PyList::new(py, array.as_primitive::<UInt64Type>().iter()),
        DataType::Boolean => PyList::new(py, array.as_boolean().iter()),
        DataType::Utf8 => PyList::new(py, array.as_string::<i32>().iter()),
        other => Err(PyTypeError::new_err(format!("a column of {other} cannot be a list"))),
    }
}
