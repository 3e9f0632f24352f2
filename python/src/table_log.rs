//! Logs in tables of Arrow.

use std::borrow::Cow;

use arrow_array::cast::AsArray;
use arrow_array::types::{
    Float64Type, Int64Type, TimestampMicrosecondType, TimestampMillisecondType, TimestampNanosecondType,
    TimestampSecondType,
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
    pub(crate) heard: RecordBatch,
    pub(crate) contacts: Option<RecordBatch>,
}

/// Reads a log from its tables.
pub(crate) fn read(given: &Given, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let with_stops = given.places.column_by_name("stop").is_some();
    let (places, heard) = if with_stops { ("stops", "receptions") } else { ("path", "packets") };
    let contacts = given.contacts.as_ref().map(|contacts| memory_table("contacts", contacts)).transpose()?;
    let log = MemoryLog::new(memory_table(places, &given.places)?, memory_table(heard, &given.heard)?);
    gather_tables(&MemoryLog { contacts, ..log }, options)
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
fn memory_table<'a>(name: &str, batch: &'a RecordBatch) -> Result<MemoryTable<'a>, RobotLogError> {
    let fields = batch.schema_ref().fields().iter().zip(batch.columns());
    MemoryTable::new(name, fields.map(|(field, array)| (field.name().clone(), column(array))).collect())
}

/// A column. What is already in the form of the library is not copied.
fn column<'a>(array: &'a ArrayRef) -> MemoryColumn<'a> {
    match array.data_type() {
        DataType::Float64 if array.null_count() == 0 => {
            MemoryColumn::Floats(Cow::Borrowed(array.as_primitive::<Float64Type>().values()))
        }
        DataType::Int64 if array.null_count() == 0 => {
            let values = Cow::Borrowed(array.as_primitive::<Int64Type>().values().as_ref());
            MemoryColumn::Whole { values, empty: None }
        }
        DataType::Utf8 => names(array.as_string::<i32>().iter()),
        DataType::LargeUtf8 => names(array.as_string::<i64>().iter()),
        DataType::Utf8View => names(array.as_string_view().iter()),
        DataType::Dictionary(..) => dictionary(array).unwrap_or_else(|| unknown(array)),
        DataType::Timestamp(unit, _) => instants(array, *unit),
        _ => match (whole_of(array), numbers_of(array)) {
            (Some(whole), _) => {
                let empty = (array.null_count() > 0).then(|| whole.iter().map(Option::is_none).collect());
                MemoryColumn::Whole { values: whole.into_iter().map(Option::unwrap_or_default).collect(), empty }
            }
            (None, Some(numbers)) => MemoryColumn::Floats(numbers.into()),
            (None, None) => unknown(array),
        },
    }
}

/// A column of another type: it is an error only if it is needed, and the error names the type.
fn unknown<'a>(array: &ArrayRef) -> MemoryColumn<'a> {
    let kind = array.data_type().to_string();
    names((0..array.len()).map(|row| (!array.is_null(row)).then_some(kind.as_str())))
}

/// Times, in any unit. Their zone is left out: the instants are the same.
fn instants<'a>(array: &ArrayRef, unit: TimeUnit) -> MemoryColumn<'a> {
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

fn names<'a, 'b>(texts: impl Iterator<Item = Option<&'b str>>) -> MemoryColumn<'a> {
    let (codes, names) = coded(texts);
    MemoryColumn::Names { codes: codes.into(), names }
}

/// A column of texts of which each is there once: the codes are used as they are. `None` if it has no texts.
fn dictionary<'a>(array: &'a ArrayRef) -> Option<MemoryColumn<'a>> {
    let dictionary = array.as_any_dictionary();
    let values: Vec<String> = match dictionary.values().data_type() {
        DataType::Utf8 => texts(dictionary.values().as_string::<i32>().iter()),
        DataType::LargeUtf8 => texts(dictionary.values().as_string::<i64>().iter()),
        DataType::Utf8View => texts(dictionary.values().as_string_view().iter()),
        _ => return None,
    };
    let code = |key: Option<usize>| key.and_then(|key| u32::try_from(key).ok()).unwrap_or(MemoryColumn::NO_NAME);
    let keys = dictionary.normalized_keys();
    let keys = keys.iter().enumerate().map(|(row, &key)| (!array.is_null(row)).then_some(key));
    let mut known: Vec<&String> = values.iter().collect();
    known.sort_unstable();
    known.dedup();
    if known.len() == values.len() {
        return Some(MemoryColumn::Names { codes: keys.map(code).collect(), names: values });
    }
    let texts: Vec<Option<&str>> = keys.map(|key| key.and_then(|key| values.get(key)).map(String::as_str)).collect();
    Some(names(texts.into_iter()))
}

fn texts<'a>(texts: impl Iterator<Item = Option<&'a str>>) -> Vec<String> {
    texts.map(|text| text.unwrap_or_default().to_owned()).collect()
}
