//! Tables in Apache Parquet, written by the crate of the Arrow project.

use std::fs::File;
use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::record::{Field, Row};
use parquet::schema::types::Type;

use super::{TextRows, Texts};
use crate::sweep::column::{Column, ColumnKind};
use crate::sweep::error::TableError;
use crate::sweep::row::written;

/// The values of a column, and for each row whether it has one.
struct Values {
    present: Vec<i16>,
    values: Typed,
}

enum Typed {
    Integer(Vec<i64>),
    /// Their octets are those of integers with a sign.
    Unsigned(Vec<i64>),
    Real(Vec<f64>),
    Text(Vec<ByteArray>),
}

impl Values {
    fn of(column: &Column) -> Self {
        let values = match column.kind {
            ColumnKind::Integer => Typed::Integer(Vec::new()),
            ColumnKind::Unsigned => Typed::Unsigned(Vec::new()),
            ColumnKind::Real => Typed::Real(Vec::new()),
            ColumnKind::Text => Typed::Text(Vec::new()),
        };
        Self { present: Vec::new(), values }
    }

    /// Adds the value of a row; `None` if the text is of another kind. An empty text becomes null.
    fn push(&mut self, text: &str) -> Option<()> {
        self.present.push((!text.is_empty()).into());
        if text.is_empty() {
            return Some(());
        }
        match &mut self.values {
            Typed::Integer(values) => values.push(text.parse().ok()?),
            Typed::Unsigned(values) => values.push(text.parse::<u64>().ok()?.cast_signed()),
            Typed::Real(values) => values.push(text.parse().ok()?),
            Typed::Text(values) => values.push(text.into()),
        }
        Some(())
    }
}

/// Why a table cannot be written.
#[derive(Debug)]
pub(super) enum EncodeError {
    /// A row cannot be read.
    Rows(TableError),
    /// The file cannot be written.
    File(ParquetError),
}

impl From<ParquetError> for EncodeError {
    fn from(error: ParquetError) -> Self {
        Self::File(error)
    }
}

/// Rows of a row group: so many are in memory at once.
const GROUP: usize = 1 << 16;

/// Writes `rows` under `columns` to `out` as a Parquet file.
pub(super) fn encode(
    columns: &[Column],
    rows: impl Iterator<Item = Result<Vec<String>, TableError>>,
    out: impl Write + Send,
) -> Result<(), EncodeError> {
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("sweep").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_created_by(format!("sextant {}", env!("CARGO_PKG_VERSION")));
    let mut file = SerializedFileWriter::new(out, schema, Arc::new(properties.build()))?;
    let mut rows = rows.peekable();
    // A table without rows has one group.
    loop {
        let mut group: Vec<Values> = columns.iter().map(Values::of).collect();
        for row in rows.by_ref().take(GROUP) {
            let row = row.map_err(EncodeError::Rows)?;
            for ((column, values), text) in columns.iter().zip(&mut group).zip(&row) {
                let misfit = || ParquetError::General(format!("`{text}` in column `{}`", column.name));
                values.push(text).ok_or_else(misfit)?;
            }
        }
        write_group(&mut file, group)?;
        if rows.peek().is_none() {
            break;
        }
    }
    file.close()?;
    Ok(())
}

/// Writes a row group.
fn write_group<W: Write + Send>(
    file: &mut SerializedFileWriter<W>,
    columns: Vec<Values>,
) -> Result<(), ParquetError> {
    let mut group = file.next_row_group()?;
    for Values { present, values } in columns {
        let Some(mut writer) = group.next_column()? else {
            return Err(ParquetError::General("a column is missing in the schema".to_owned()));
        };
        match values {
            Typed::Integer(values) | Typed::Unsigned(values) => {
                writer.typed::<Int64Type>().write_batch(&values, Some(&present), None)?
            }
            Typed::Real(values) => writer.typed::<DoubleType>().write_batch(&values, Some(&present), None)?,
            Typed::Text(values) => writer.typed::<ByteArrayType>().write_batch(&values, Some(&present), None)?,
        };
        writer.close()?;
    }
    group.close()?;
    Ok(())
}

fn field(column: &Column) -> Result<Arc<Type>, ParquetError> {
    let (physical, converted) = match column.kind {
        ColumnKind::Integer => (Physical::INT64, ConvertedType::NONE),
        ColumnKind::Unsigned => (Physical::INT64, ConvertedType::UINT_64),
        ColumnKind::Real => (Physical::DOUBLE, ConvertedType::NONE),
        ColumnKind::Text => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
    };
    let builder = Type::primitive_type_builder(&column.name, physical);
    Ok(Arc::new(builder.with_repetition(Repetition::OPTIONAL).with_converted_type(converted).build()?))
}

/// The rows of the Parquet file at `path`, which are read when they are asked for.
pub(super) fn stream(path: &Path) -> Result<TextRows, TableError> {
    let file = File::open(path).map_err(|why| TableError::Read { path: path.to_owned(), why: why.to_string() })?;
    let path = path.to_owned();
    let wrong = move |error: ParquetError| TableError::Other { path: path.clone(), why: error.to_string() };
    let reader = SerializedFileReader::new(file).map_err(&wrong)?;
    let columns = names(&reader);
    let rows = reader.into_iter().map(move |row| Ok(texts(&row.map_err(&wrong)?)));
    Ok(TextRows { columns, rows: Box::new(rows) })
}

/// The texts of a Parquet file; why it cannot be read.
pub(super) fn decode(file: File) -> Result<Texts, String> {
    all_rows(file).map_err(|error| error.to_string())
}

fn all_rows(file: File) -> Result<Texts, ParquetError> {
    let reader = SerializedFileReader::new(file)?;
    let rows = reader.get_row_iter(None)?.map(|row| Ok(texts(&row?)));
    Ok(Texts { columns: names(&reader), rows: rows.collect::<Result<_, ParquetError>>()? })
}

fn names(reader: &SerializedFileReader<File>) -> Vec<String> {
    let fields = reader.metadata().file_metadata().schema().get_fields();
    fields.iter().map(|field| field.name().to_owned()).collect()
}

fn texts(row: &Row) -> Vec<String> {
    row.get_column_iter().map(|(_, field)| text(field)).collect()
}

/// A value as it would stand in a CSV table.
fn text(field: &Field) -> String {
    match field {
        Field::Null => String::new(),
        Field::Str(text) => text.clone(),
        Field::Double(value) => written(*value, ColumnKind::Real),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::table;
    use super::*;

    #[test]
    fn a_long_table_has_several_groups_and_an_empty_one_has_one() {
        let (columns, rows) = table();
        for (count, groups) in [(0, 1), (GROUP, 1), (2 * GROUP + 1, 3)] {
            let mut octets = Vec::new();
            encode(&columns, (0..count).map(|i| Ok(rows[i % 2].clone())), &mut octets).unwrap();
            let reader = SerializedFileReader::new(bytes::Bytes::from(octets)).unwrap();
            assert_eq!((reader.num_row_groups(), reader.get_row_iter(None).unwrap().count()), (groups, count));
        }
    }

    #[test]
    fn a_parquet_table_keeps_types_and_nulls() {
        let (columns, rows) = table();
        let mut octets = Vec::new();
        encode(&columns, rows.into_iter().map(Ok), &mut octets).unwrap();
        let reader = SerializedFileReader::new(bytes::Bytes::from(octets)).unwrap();
        let read: Vec<Vec<Field>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(_, field)| field.clone()).collect())
            .collect();
        assert_eq!(
            read,
            [
                vec![Field::Long(0), Field::Null, Field::Double(0.1)],
                vec![Field::Long(1), Field::Str("no, \"never\"".into()), Field::Null],
            ]
        );
    }

    #[test]
    fn seeds_of_64_bits_are_exact() {
        let columns = [Column::new("seed", ColumnKind::Unsigned)];
        let rows = [0, 1 << 63, u64::MAX].map(|seed: u64| vec![seed.to_string()]);
        let file = tempfile::NamedTempFile::new().unwrap();
        encode(&columns, rows.iter().cloned().map(Ok), file.as_file()).unwrap();
        assert_eq!(decode(file.reopen().unwrap()).unwrap().rows, rows);
    }
}
