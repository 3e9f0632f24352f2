//! Columns of Arrow that others made are checked before they are used: the interface that hands them over promises nothing.

use std::sync::Arc;

use arrow_array::cast::AsArray;
use arrow_array::types::{BinaryType, BinaryViewType, ByteArrayType, Int64Type, LargeBinaryType};
use arrow_array::{Array, ArrayRef, make_array, new_empty_array};
use arrow_schema::{ArrowError, DataType};
use pyo3::{PyResult, Python};

use crate::error::of_cell;

/// A column that holds what its type says, without encodings that only save memory. `first` is the row of its first cell.
pub(crate) fn checked(py: Python<'_>, column: &str, array: &ArrayRef, first: usize) -> PyResult<ArrayRef> {
    if has_union(array.data_type()) {
        let allowed = "numbers, texts, times, and lists and dictionaries of these";
        return Err(of_cell(py, column, None, &format!("the type {}", array.data_type()), allowed));
    }
    if array.is_empty() {
        // The interface does not tell how long the texts of nothing are, so an empty part of a longer array seems to be broken.
        let kind = if let DataType::RunEndEncoded(_, values) = array.data_type() {
            values.data_type()
        } else {
            array.data_type()
        };
        return Ok(new_empty_array(kind));
    }
    if let Err(why) = array.to_data().validate_full() {
        let wrong = first_wrong(array, &why);
        return Err(of_cell(py, column, wrong.row.map(|row| first + row), &wrong.found, wrong.allowed));
    }
    match array.data_type() {
        DataType::RunEndEncoded(_, values) => {
            let plain = arrow_cast::cast(array, values.data_type());
            plain.map_err(|why| of_cell(py, column, None, &why.to_string(), "runs that can be written out"))
        }
        _ => Ok(Arc::clone(array)),
    }
}

/// Whether a type has a union, of which nothing is checked by the library.
fn has_union(kind: &DataType) -> bool {
    match kind {
        DataType::Union(..) => true,
        DataType::List(field)
        | DataType::LargeList(field)
        | DataType::ListView(field)
        | DataType::LargeListView(field)
        | DataType::FixedSizeList(field, _)
        | DataType::Map(field, _)
        | DataType::RunEndEncoded(_, field) => has_union(field.data_type()),
        DataType::Struct(fields) => fields.iter().any(|field| has_union(field.data_type())),
        DataType::Dictionary(_, values) => has_union(values),
        _ => false,
    }
}

/// A cell that is not what its type says.
struct Wrong {
    row: Option<usize>,
    found: String,
    allowed: &'static str,
}

impl Wrong {
    fn text(row: Option<usize>, octets: &[u8]) -> Self {
        let shown: Vec<String> = octets.iter().take(16).map(|octet| format!("{octet:02x}")).collect();
        let more = if octets.len() > shown.len() { " .." } else { "" };
        Self { row, found: format!("the octets {}{more}", shown.join(" ")), allowed: "text in UTF-8" }
    }
}

/// The first cell of an unsound array that is wrong, as far as that can be told; `why` is what is known otherwise.
fn first_wrong(array: &ArrayRef, why: &ArrowError) -> Wrong {
    let found = match array.data_type() {
        DataType::Utf8 => wrong_text::<BinaryType>(array, &DataType::Binary),
        DataType::LargeUtf8 => wrong_text::<LargeBinaryType>(array, &DataType::LargeBinary),
        DataType::Utf8View => wrong_view(array),
        DataType::Dictionary(..) => wrong_entry(array),
        _ => None,
    };
    found.unwrap_or_else(|| Wrong { row: None, found: why.to_string(), allowed: "data that agree with their type" })
}

/// The same octets as another type, if that is sound.
fn reread(array: &ArrayRef, kind: &DataType) -> Option<ArrayRef> {
    array.to_data().into_builder().data_type(kind.clone()).build().ok().map(make_array)
}

/// The first text that is not UTF-8, or whose end is before its start.
fn wrong_text<B: ByteArrayType<Native = [u8]>>(array: &ArrayRef, octets: &DataType) -> Option<Wrong> {
    let Some(read) = reread(array, octets) else {
        let data = array.to_data();
        let offsets = &data.buffer::<B::Offset>(0)[..=data.len()];
        let row = offsets.windows(2).position(|ends| ends[0] < B::Offset::default() || ends[1] < ends[0])?;
        let found = format!("a text from octet {:?} to {:?}", offsets[row], offsets[row + 1]);
        return Some(Wrong { row: Some(row), found, allowed: "ends that are not before the starts" });
    };
    let texts = read.as_bytes::<B>();
    let row = (0..texts.len()).find(|&row| std::str::from_utf8(texts.value(row)).is_err())?;
    Some(Wrong::text(Some(row), texts.value(row)))
}

/// The first text of views that is not UTF-8.
fn wrong_view(array: &ArrayRef) -> Option<Wrong> {
    let read = reread(array, &DataType::BinaryView)?;
    let texts = read.as_byte_view::<BinaryViewType>();
    let row = (0..texts.len()).find(|&row| std::str::from_utf8(texts.value(row)).is_err())?;
    Some(Wrong::text(Some(row), texts.value(row)))
}

/// The first index that has no entry in the dictionary, or the first row whose entry is wrong.
fn wrong_entry(array: &ArrayRef) -> Option<Wrong> {
    let dictionary = array.as_any_dictionary();
    let (keys, values) = (dictionary.keys(), dictionary.values());
    let wide = arrow_cast::cast(keys, &DataType::Int64).ok()?;
    let wide = wide.as_primitive::<Int64Type>();
    let entry = |row: usize| {
        usize::try_from(wide.value(row)).ok().filter(|&entry| wide.is_valid(row) && entry < values.len())
    };
    let mut rows = (0..keys.len()).filter(|&row| keys.is_valid(row));
    let value = match values.to_data().validate_full() {
        Err(why) => Some(first_wrong(values, &why)),
        Ok(()) => None,
    };
    let row = match &value {
        Some(Wrong { row: Some(wrong), .. }) => rows.find(|&row| entry(row).is_none_or(|entry| entry == *wrong)),
        Some(_) => None,
        None => rows.find(|&row| entry(row).is_none()),
    };
    match (value, row) {
        (Some(value), row) if row.is_none_or(|row| entry(row).is_some()) => Some(Wrong { row, ..value }),
        (_, Some(row)) => {
            let found = format!("the index {} into {} entries", wide.value(row), values.len());
            Some(Wrong { row: Some(row), found, allowed: "the index of an entry, from 0" })
        }
        (_, None) => None,
    }
}
