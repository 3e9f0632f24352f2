//! Logs in tables of Arrow.

use std::borrow::Cow;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float64Type, Int64Type, TimestampMicrosecondType, TimestampMillisecondType, TimestampNanosecondType,
    TimestampSecondType, UInt64Type,
};
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::{DataType, TimeUnit};
use sextant::logs::{
    LocalPlane, MemoryColumn, MemoryLog, MemoryTable, ReadOptions, RobotLog, RobotLogError, TrueNodes, gather_tables,
    read_truth_table,
};

use crate::given::{coded, numbers_of, whole_of};

/// The tables of a log.
pub(crate) struct Given {
    pub(crate) places: RecordBatch,
    pub(crate) heard: Option<RecordBatch>,
    pub(crate) ranges: Option<RecordBatch>,
    pub(crate) contacts: Option<RecordBatch>,
}

/// Reads a log from its tables.
pub(crate) fn read(given: &Given, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let with_stops = given.places.column_by_name("stop").is_some();
    let (places, heard) = if with_stops { ("stops", "receptions") } else { ("path", "packets") };
    let contacts = given.contacts.as_ref().map(|contacts| memory_table("contacts", contacts)).transpose()?;
    let ranges = given.ranges.as_ref().map(|ranges| memory_table("ranges", ranges)).transpose()?;
    let heard = given.heard.as_ref().map(|batch| memory_table(heard, batch)).transpose()?;
    let places = memory_table(places, &given.places)?;
    gather_tables(&MemoryLog { places, heard, ranges, contacts, sectors: None, sector_snrs: None }, options)
}

/// The true places of nodes.
pub(crate) fn truth(
    table: &RecordBatch,
    plane: Option<&LocalPlane>,
    notes: &mut Vec<String>,
) -> Result<TrueNodes, RobotLogError> {
    read_truth_table(&memory_table("truth", table)?, None, plane, notes)
}

/// A table of Arrow as the library reads tables.
pub(crate) fn memory_table<'a>(name: &str, batch: &'a RecordBatch) -> Result<MemoryTable<'a>, RobotLogError> {
    let fields = batch.schema_ref().fields().iter().zip(batch.columns());
    MemoryTable::new(name, fields.map(|(field, array)| (field.name().clone(), column(array))).collect())
}

/// A column. What is already in the form of the library is not copied.
fn column(array: &ArrayRef) -> MemoryColumn<'_> {
    match array.data_type() {
        DataType::Float64 if array.null_count() == 0 => {
            MemoryColumn::Floats(Cow::Borrowed(array.as_primitive::<Float64Type>().values()))
        }
        DataType::Int64 if array.null_count() == 0 => {
            let values = Cow::Borrowed(array.as_primitive::<Int64Type>().values().as_ref());
            MemoryColumn::Whole { values, empty: None }
        }
        DataType::Dictionary(_, values) => match dictionary(array) {
            Some(names) => names,
            None => written_out(array, values),
        },
        _ => owned(array),
    }
}

/// A column that is written in another form.
fn owned(array: &ArrayRef) -> MemoryColumn<'static> {
    match array.data_type() {
        DataType::Utf8 => names(array.as_string::<i32>().iter()),
        DataType::LargeUtf8 => names(array.as_string::<i64>().iter()),
        DataType::Utf8View => names(array.as_string_view().iter()),
        DataType::Timestamp(unit, _) => instants(array, *unit),
        _ => match (whole_of(array), numbers_of(array)) {
            (Some(whole), _) => {
                let empty = (array.null_count() > 0).then(|| whole.iter().map(Option::is_none).collect());
                MemoryColumn::Whole { values: whole.into_iter().map(Option::unwrap_or_default).collect(), empty }
            }
            (None, Some(numbers)) => MemoryColumn::Floats(numbers.into()),
            (None, None) => others(array),
        },
    }
}

/// A column of a dictionary with other values than texts, each value where it is meant.
fn written_out(array: &ArrayRef, values: &DataType) -> MemoryColumn<'static> {
    arrow_cast::cast(array, values).map_or_else(|_| others(array), |plain| owned(&plain))
}

/// A column of a type that means nothing in a log, or of whole numbers that are too large to be counted with: addresses.
fn others(array: &ArrayRef) -> MemoryColumn<'static> {
    if let DataType::UInt64 = array.data_type() {
        let numbers: Vec<Option<String>> =
            array.as_primitive::<UInt64Type>().iter().map(|number| number.map(|number| number.to_string())).collect();
        return names(numbers.iter().map(Option::as_deref));
    }
    // A column of nothing has no mask.
    let missing = array.logical_nulls();
    let is_empty = |row| missing.as_ref().is_some_and(|missing| missing.is_null(row));
    MemoryColumn::Other { kind: array.data_type().to_string(), empty: (0..array.len()).map(is_empty).collect() }
}

/// Times, in any unit. Their zone is left out: the instants are the same.
fn instants(array: &ArrayRef, unit: TimeUnit) -> MemoryColumn<'static> {
    /// The times of one unit, and how many nanoseconds it has.
    macro_rules! instants {
        ($kind:ty, $nanos:expr) => {
            array
                .as_primitive::<$kind>()
                .iter()
                .map(|time| time.and_then(|time: i64| time.checked_mul($nanos)))
                .collect()
        };
    }
    let instants: Vec<Option<i64>> = match unit {
        TimeUnit::Second => instants!(TimestampSecondType, 1_000_000_000),
        TimeUnit::Millisecond => instants!(TimestampMillisecondType, 1_000_000),
        TimeUnit::Microsecond => instants!(TimestampMicrosecondType, 1_000),
        TimeUnit::Nanosecond => instants!(TimestampNanosecondType, 1),
    };
    MemoryColumn::Instants(instants.into_iter().map(|time| time.unwrap_or(MemoryColumn::NO_INSTANT)).collect())
}

fn names<'a>(texts: impl Iterator<Item = Option<&'a str>>) -> MemoryColumn<'static> {
    let (codes, names) = coded(texts);
    MemoryColumn::Names { codes: codes.into(), names }
}

/// A column of texts of which each is there once: the codes are used as they are. `None` if it has no texts.
fn dictionary(array: &ArrayRef) -> Option<MemoryColumn<'static>> {
    let dictionary = array.as_any_dictionary();
    let values: Vec<Option<String>> = match dictionary.values().data_type() {
        DataType::Utf8 => texts(dictionary.values().as_string::<i32>().iter()),
        DataType::LargeUtf8 => texts(dictionary.values().as_string::<i64>().iter()),
        DataType::Utf8View => texts(dictionary.values().as_string_view().iter()),
        _ => return None,
    };
    // Of a dictionary without entries all cells are empty, and it has no keys that could be asked for.
    let keys = if values.is_empty() { vec![0; array.len()] } else { dictionary.normalized_keys() };
    let keys = keys.iter().enumerate().map(|(row, &key)| {
        let is_there = !array.is_null(row) && values.get(key).is_some_and(Option::is_some);
        is_there.then_some(key)
    });
    let mut known: Vec<&String> = values.iter().flatten().collect();
    known.sort_unstable();
    known.dedup();
    if known.len() == values.len() {
        let code = |key: Option<usize>| key.and_then(|key| u32::try_from(key).ok()).unwrap_or(MemoryColumn::NO_NAME);
        return Some(MemoryColumn::Names {
            codes: keys.map(code).collect(),
            names: values.into_iter().flatten().collect(),
        });
    }
    let texts: Vec<Option<&str>> = keys.map(|key| values.get(key?)?.as_deref()).collect();
    Some(names(texts.into_iter()))
}

fn texts<'a>(texts: impl Iterator<Item = Option<&'a str>>) -> Vec<Option<String>> {
    texts.map(|text| text.map(str::to_owned)).collect()
}
