//! Tables in Apache Parquet, one row group after the other.

use std::path::Path;
use std::sync::Arc;

use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;
use sextant_recording::output::{OutputError, PartFile};
use sextant_recording::{Cell, CellKind, TableColumn, TableRow};

use super::{ExportError, TableFile};

/// Rows of a group, which is in memory.
const GROUP_ROWS: usize = 16_384;

/// A Parquet file of which one group of rows is in memory.
pub(super) struct ParquetTable {
    columns: Vec<Values>,
    rows: usize,
    writer: SerializedFileWriter<PartFile>,
}

/// The values of a column in the group under way, and which rows have one.
struct Values {
    kind: CellKind,
    present: Vec<i16>,
    integers: Vec<i64>,
    reals: Vec<f64>,
    texts: Vec<ByteArray>,
}

impl ParquetTable {
    pub(super) fn create(path: &Path, columns: &[TableColumn]) -> Result<Self, ExportError> {
        let file = PartFile::create(path)?;
        let failed = |error: &ParquetError| unwritten(path, error);
        let fields: Result<Vec<_>, _> = columns.iter().map(field).collect();
        let schema = fields.and_then(|fields| Type::group_type_builder("table").with_fields(fields).build());
        let properties = WriterProperties::builder().set_created_by(format!("sextant {}", env!("CARGO_PKG_VERSION")));
        let schema = Arc::new(schema.map_err(|error| failed(&error))?);
        let writer = SerializedFileWriter::new(file, schema, Arc::new(properties.build()));
        let values = |column: &TableColumn| Values {
            kind: column.kind,
            present: Vec::new(),
            integers: Vec::new(),
            reals: Vec::new(),
            texts: Vec::new(),
        };
        let writer = writer.map_err(|error| failed(&error))?;
        Ok(Self { columns: columns.iter().map(values).collect(), rows: 0, writer })
    }

    fn end_group(&mut self) -> Result<(), ExportError> {
        self.rows = 0;
        let written = write_group(&mut self.writer, &mut self.columns);
        written.map_err(|error| unwritten(self.writer.inner().path(), &error))
    }
}

impl TableFile for ParquetTable {
    fn row(&mut self, row: &TableRow<'_>) -> Result<(), ExportError> {
        self.columns.iter_mut().zip(row.cells).for_each(|(values, cell)| values.add(cell));
        self.rows += 1;
        if self.rows == GROUP_ROWS { self.end_group() } else { Ok(()) }
    }

    fn finish(mut self: Box<Self>) -> Result<(), ExportError> {
        if self.rows > 0 {
            self.end_group()?;
        }
        let path = self.writer.inner().path().to_owned();
        let file = self.writer.into_inner().map_err(|error| unwritten(&path, &error))?;
        Ok(file.finish()?)
    }
}

impl Values {
    /// An empty text is a text, and not a missing value.
    fn add(&mut self, cell: &Cell) {
        let present = match (self.kind, cell) {
            (CellKind::Integer, Cell::Integer(value)) => {
                self.integers.push(*value);
                true
            }
            (CellKind::Real, cell) => {
                let value = cell.real();
                self.reals.extend(value);
                value.is_some()
            }
            (CellKind::Text, Cell::Text(text)) => {
                self.texts.push(ByteArray::from(text.as_str()));
                true
            }
            (CellKind::Integer | CellKind::Text, _) => false,
        };
        self.present.push(i16::from(present));
    }
}

fn write_group(writer: &mut SerializedFileWriter<PartFile>, columns: &mut [Values]) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for values in columns {
        let Some(mut column) = group.next_column()? else {
            return Err(ParquetError::General("a column is missing in the schema".to_owned()));
        };
        let present = std::mem::take(&mut values.present);
        match values.kind {
            CellKind::Integer => {
                column.typed::<Int64Type>().write_batch(&values.integers, Some(&present), None)?;
                values.integers.clear();
            }
            CellKind::Real => {
                column.typed::<DoubleType>().write_batch(&values.reals, Some(&present), None)?;
                values.reals.clear();
            }
            CellKind::Text => {
                column.typed::<ByteArrayType>().write_batch(&values.texts, Some(&present), None)?;
                values.texts.clear();
            }
        }
        column.close()?;
    }
    group.close()?;
    Ok(())
}

fn field(column: &TableColumn) -> Result<Arc<Type>, ParquetError> {
    let (physical, converted) = match column.kind {
        CellKind::Integer => (Physical::INT64, ConvertedType::NONE),
        CellKind::Real => (Physical::DOUBLE, ConvertedType::NONE),
        CellKind::Text => (Physical::BYTE_ARRAY, ConvertedType::UTF8),
    };
    let builder = Type::primitive_type_builder(&column.name, physical);
    Ok(Arc::new(builder.with_repetition(Repetition::OPTIONAL).with_converted_type(converted).build()?))
}

fn unwritten(path: &Path, error: &ParquetError) -> ExportError {
    OutputError { path: path.to_owned(), why: error.to_string() }.into()
}

#[cfg(test)]
mod tests {
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;

    use super::*;

    #[test]
    fn a_table_of_several_groups_keeps_types_and_missing_values() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.parquet");
        let column = |name: &'static str, kind| TableColumn { name: name.into(), kind };
        let columns = [column("i", CellKind::Integer), column("t_s", CellKind::Real), column("n", CellKind::Text)];
        let mut table = Box::new(ParquetTable::create(&path, &columns).unwrap());
        let count = GROUP_ROWS + 2;
        for i in 0..count {
            let first = if i == 1 { Cell::Missing } else { Cell::Integer(i64::try_from(i).unwrap()) };
            let cells = [first, Cell::Nanos(1_500_000_000), Cell::Text(String::new())];
            table.row(&TableRow { table: "table", columns: &columns, cells: &cells }).unwrap();
        }
        table.finish().unwrap();
        let reader = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(reader.num_row_groups(), 2);
        let rows: Vec<Vec<Field>> = reader
            .get_row_iter(None)
            .unwrap()
            .map(|row| row.unwrap().get_column_iter().map(|(_, field)| field.clone()).collect())
            .collect();
        assert_eq!(rows.len(), count);
        assert_eq!(rows[0], [Field::Long(0), Field::Double(1.5), Field::Str(String::new())]);
        assert_eq!(rows[1], [Field::Null, Field::Double(1.5), Field::Str(String::new())]);
    }
}
