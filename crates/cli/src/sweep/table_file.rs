//! A table of rows as a CSV or Parquet file.

use std::ffi::OsStr;
use std::io;
use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

use super::column::{Column, Kind};
use crate::diagnostic::Failure;
use crate::output::write_file;

/// The form of a table on disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated values (RFC 4180) with a header.
    Csv,
    /// Apache Parquet, uncompressed.
    Parquet,
}

impl TableFormat {
    /// The form that the extension of `path` asks for.
    ///
    /// # Errors
    /// If it is neither `.csv` nor `.parquet`.
    pub fn of(path: &Path) -> Result<Self, Failure> {
        match path.extension().and_then(OsStr::to_str) {
            Some("csv") => Ok(Self::Csv),
            Some("parquet") => Ok(Self::Parquet),
            other => Err(Failure::bad_input_with_help(
                match other {
                    Some(other) => format!("`{}` ends in `.{other}`", path.display()),
                    None => format!("`{}` has no extension", path.display()),
                },
                "name a table TABLE.csv or TABLE.parquet",
            )),
        }
    }
}

/// Writes `rows` of texts under `columns` to the file at `path`, whole or not at all.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub(super) fn write_table(path: &Path, columns: &[Column], rows: &[Vec<String>]) -> Result<(), Failure> {
    let bytes = match TableFormat::of(path)? {
        TableFormat::Csv => csv(columns, rows),
        TableFormat::Parquet => parquet(columns, rows).map_err(|error| io::Error::other(error.to_string())),
    };
    write_file(path, &bytes.map_err(|error| Failure::unwritable(path, &error))?)
}

fn csv(columns: &[Column], rows: &[Vec<String>]) -> io::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns.iter().map(|column| &column.name))?;
    for row in rows {
        writer.write_record(row)?;
    }
    writer.into_inner().map_err(|error| io::Error::other(error.to_string()))
}

/// One row group; a text that is empty is null.
fn parquet(columns: &[Column], rows: &[Vec<String>]) -> Result<Vec<u8>, ParquetError> {
    let fields = columns.iter().map(field).collect::<Result<_, _>>()?;
    let schema = Arc::new(Type::group_type_builder("sweep").with_fields(fields).build()?);
    let properties = WriterProperties::builder().set_created_by(format!("sextant {}", env!("CARGO_PKG_VERSION")));
    let mut bytes = Vec::new();
    let mut file = SerializedFileWriter::new(&mut bytes, schema, Arc::new(properties.build()))?;
    let mut group = file.next_row_group()?;
    for (i, column) in columns.iter().enumerate() {
        let texts: Vec<&str> = rows.iter().map(|row| row[i].as_str()).collect();
        let present: Vec<i16> = texts.iter().map(|text| i16::from(!text.is_empty())).collect();
        let texts = texts.into_iter().filter(|text| !text.is_empty());
        let Some(mut writer) = group.next_column()? else {
            return Err(ParquetError::General("a column is missing in the schema".to_owned()));
        };
        let misfit = |text: &str| ParquetError::General(format!("`{text}` in column `{}`", column.name));
        match column.kind {
            Kind::Integer => {
                let values =
                    texts.map(|text| text.parse().map_err(|_| misfit(text))).collect::<Result<Vec<_>, _>>()?;
                writer.typed::<Int64Type>().write_batch(&values, Some(&present), None)?;
            }
            Kind::Real => {
                let values =
                    texts.map(|text| text.parse().map_err(|_| misfit(text))).collect::<Result<Vec<_>, _>>()?;
                writer.typed::<DoubleType>().write_batch(&values, Some(&present), None)?;
            }
            Kind::Text => {
                let values: Vec<_> = texts.map(ByteArray::from).collect();
                writer.typed::<ByteArrayType>().write_batch(&values, Some(&present), None)?;
            }
        }
        writer.close()?;
    }
    group.close()?;
    file.close()?;
    Ok(bytes)
}

fn field(column: &Column) -> Result<Arc<Type>, ParquetError> {
    let (physical, converted) = match column.kind {
        Kind::Integer => (Physical::INT64, ConvertedType::NONE),
        Kind::Real => (Physical::DOUBLE, ConvertedType::NONE),
        Kind::Text => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
    };
    let builder = Type::primitive_type_builder(&column.name, physical);
    Ok(Arc::new(builder.with_repetition(Repetition::OPTIONAL).with_converted_type(converted).build()?))
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;

    fn table() -> (Vec<Column>, Vec<Vec<String>>) {
        let columns = vec![
            Column::new("cell", Kind::Integer),
            Column::new("error", Kind::Text),
            Column::new("ml-tm.connectivity_error", Kind::Real),
        ];
        let row = |texts: [&str; 3]| texts.map(str::to_owned).to_vec();
        (columns, vec![row(["0", "", "0.1"]), row(["1", "no, \"never\"", ""])])
    }

    #[test]
    fn a_csv_table_quotes_what_must_be_quoted() {
        let (columns, rows) = table();
        let text = String::from_utf8(csv(&columns, &rows).unwrap()).unwrap();
        assert_eq!(text, "cell,error,ml-tm.connectivity_error\n0,,0.1\n1,\"no, \"\"never\"\"\",\n");
    }

    #[test]
    fn a_parquet_table_is_read_back_with_types_and_nulls() {
        let (columns, rows) = table();
        let reader = SerializedFileReader::new(bytes::Bytes::from(parquet(&columns, &rows).unwrap())).unwrap();
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
    fn other_extensions_are_refused() {
        for name in ["table", "table.xlsx"] {
            assert!(matches!(TableFormat::of(Path::new(name)), Err(Failure::BadInput(_))));
        }
    }
}
