//! Logs in tables of Arrow.

use std::borrow::Cow;

use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type, TimestampNanosecondType, UInt32Type};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::{DataType, TimeUnit};
use pyo3::PyResult;
use pyo3::exceptions::PyTypeError;
use sextant::logs::{
    LocalPlane, MemoryColumn, MemoryLog, MemoryTable, ReadOptions, RobotLog, RobotLogError, TrueNodes, gather_tables, read_truth_table,
};

use crate::table::coded;

/// The tables of a log.
pub(crate) struct Given {
    pub(crate) places: RecordBatch,
    pub(crate) heard: RecordBatch,
    pub(crate) contacts: Option<RecordBatch>,
}

/// Reads a log from its tables.
pub(crate) fn read(given: &Given, options: &ReadOptions) -> PyResult<Result<RobotLog, RobotLogError>> {
    let with_stops = given.places.column_by_name("stop").is_some();
    let (of_places, of_heard) = if with_stops { ("stops", "receptions") } else { ("path", "packets") };
    let places = memory_table(of_places, &given.places)?;
    let heard = memory_table(of_heard, &given.heard)?;
    let contacts = given.contacts.as_ref().map(|contacts| memory_table("contacts", contacts)).transpose()?;
    let read = || {
        let (places, heard, contacts) = (places?, heard?, contacts.transpose()?);
        gather_tables(&MemoryLog { contacts, ..MemoryLog::new(places, heard) }, options)
    };
    Ok(read())
}

/// The true places of nodes.
pub(crate) fn truth(
    table: &RecordBatch,
    plane: Option<&LocalPlane>,
    notes: &mut Vec<String>,
) -> PyResult<Result<TrueNodes, RobotLogError>> {
    let table = memory_table("truth", table)?;
    Ok(table.and_then(|table| read_truth_table(&table, plane, notes)))
}

/// A table of Arrow as the library reads tables.
fn memory_table<'a>(name: &str, batch: &'a RecordBatch) -> PyResult<Result<MemoryTable<'a>, RobotLogError>> {
    let fields = batch.schema_ref().fields().iter().zip(batch.columns());
    let columns = fields.map(|(field, array)| Ok((field.name().clone(), column(field.name(), array)?)));
    Ok(MemoryTable::new(name, columns.collect::<PyResult<Vec<_>>>()?))
}

/// A column. What is already in the form of the library is not copied.
fn column<'a>(name: &str, array: &'a ArrayRef) -> PyResult<MemoryColumn<'a>> {
    let empty = || (array.null_count() > 0).then(|| (0..array.len()).map(|row| array.is_null(row)).collect::<Vec<_>>());
    match array.data_type() {
        DataType::Float64 if array.null_count() == 0 => {
            Ok(MemoryColumn::Floats(Cow::Borrowed(array.as_primitive::<Float64Type>().values())))
        }
        DataType::Float16 | DataType::Float32 | DataType::Float64 | DataType::Decimal128(..) => {
            let numbers = cast(name, array, &DataType::Float64)?;
            let numbers = numbers.as_primitive::<Float64Type>().iter().map(|number| number.unwrap_or(f64::NAN));
            Ok(MemoryColumn::Floats(numbers.collect::<Vec<_>>().into()))
        }
        DataType::Int64 => {
            let values = Cow::Borrowed(array.as_primitive::<Int64Type>().values().as_ref());
            Ok(MemoryColumn::Whole { values, empty: empty() })
        }
        kind if kind.is_integer() || *kind == DataType::Boolean => {
            let whole = cast(name, array, &DataType::Int64)?;
            let values = whole.as_primitive::<Int64Type>().values().to_vec().into();
            Ok(MemoryColumn::Whole { values, empty: empty() })
        }
        DataType::Utf8 => Ok(names(array.as_string::<i32>().iter())),
        DataType::LargeUtf8 => Ok(names(array.as_string::<i64>().iter())),
        DataType::Utf8View => Ok(names(array.as_string_view().iter())),
        DataType::Dictionary(_, of) if of.is_string() => dictionary(name, array),
        DataType::Timestamp(..) => {
            // Without its zone: the instants are the same.
            let instants = cast(name, array, &DataType::Timestamp(TimeUnit::Nanosecond, None))?;
            let instants = instants.as_primitive::<TimestampNanosecondType>().iter();
            let instants = instants.map(|instant| instant.unwrap_or(MemoryColumn::NO_INSTANT));
            Ok(MemoryColumn::Instants(instants.collect::<Vec<_>>().into()))
        }
        // Whatever else it is: as a text, so that a column that is not used is no error.
        _ => {
            let texts = (0..array.len()).map(|row| {
                let text = || arrow_cast::display::array_value_to_string(array, row).unwrap_or_default();
                (!array.is_null(row)).then(text)
            });
            let texts: Vec<Option<String>> = texts.collect();
            Ok(names(texts.iter().map(Option::as_deref)))
        }
    }
}

fn names<'a, 'b>(texts: impl Iterator<Item = Option<&'b str>>) -> MemoryColumn<'a> {
    let (codes, names) = coded(texts);
    MemoryColumn::Names { codes: codes.into(), names }
}

/// A column of texts of which each is there once: the codes are used as they are.
fn dictionary<'a>(name: &str, array: &'a ArrayRef) -> PyResult<MemoryColumn<'a>> {
    let texts = cast(name, array.as_any_dictionary().values(), &DataType::Utf8)?;
    let keys = arrow_cast::cast(array.as_any_dictionary().keys(), &DataType::UInt32);
    let keys = keys.map_err(|why| PyTypeError::new_err(format!("column `{name}`: {why}")))?;
    let values: Vec<String> = texts.as_string::<i32>().iter().map(|text| text.unwrap_or_default().to_owned()).collect();
    let keys = keys.as_primitive::<UInt32Type>().iter().map(|key| key.unwrap_or(MemoryColumn::NO_NAME));
    let mut known: Vec<&String> = values.iter().collect();
    known.sort_unstable();
    known.dedup();
    if known.len() == values.len() {
        return Ok(MemoryColumn::Names { codes: keys.collect::<Vec<_>>().into(), names: values });
    }
    let texts = keys.map(|key| values.get(key as usize).map(String::as_str));
    Ok(names(texts.collect::<Vec<_>>().into_iter()))
}

fn cast(name: &str, array: &ArrayRef, kind: &DataType) -> PyResult<ArrayRef> {
    arrow_cast::cast(array, kind).map_err(|why| PyTypeError::new_err(format!("column `{name}`: {why}")))
}
