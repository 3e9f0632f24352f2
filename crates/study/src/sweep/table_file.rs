//! A table as a CSV file, or as a Parquet file if the feature `parquet` is on.

#[cfg(feature = "parquet")]
mod parquet;

use std::ffi::OsStr;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::Path;

use sextant_kernel::read_text_at_most;
use sextant_kernel::text::of_cell;
use sextant_recording::output::{CsvFile, EmptyCell, OutputError, WholeFile};

use super::column::Column;
use super::error::TableError;

/// The file format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TableFormat {
    /// Comma-separated values (RFC 4180) with a header.
    Csv,
    /// Apache Parquet, uncompressed.
    #[cfg(feature = "parquet")]
    Parquet,
}

impl TableFormat {
    /// The format for the extension of `path`.
    ///
    /// # Errors
    /// If it is neither `.csv` nor `.parquet`, or if it is `.parquet` and the feature `parquet` is off.
    pub fn of(path: &Path) -> Result<Self, TableError> {
        match path.extension().and_then(OsStr::to_str) {
            Some("csv") => Ok(Self::Csv),
            #[cfg(feature = "parquet")]
            Some("parquet") => Ok(Self::Parquet),
            #[cfg(not(feature = "parquet"))]
            Some("parquet") => Err(TableError::NoParquet { path: path.to_owned() }),
            Some(other) => Err(TableError::Extension { path: path.to_owned(), extension: other.to_owned() }),
            None => Err(TableError::NoExtension { path: path.to_owned() }),
        }
    }
}

/// Writes `rows` of texts under `columns` to the file at `path`, completely or not at all.
///
/// # Errors
/// If the extension is unknown or the file cannot be written.
pub(crate) fn write_table(
    path: &Path,
    columns: &[Column],
    rows: impl Iterator<Item = Result<Vec<String>, TableError>>,
) -> Result<(), TableError> {
    let format = TableFormat::of(path)?;
    let mut file = WholeFile::create(path)?;
    match format {
        TableFormat::Csv => {
            csv(columns, rows, |text| file.write_all(text).map_err(|error| OutputError::new(path, &error).into()))?
        }
        #[cfg(feature = "parquet")]
        TableFormat::Parquet => parquet::encode(columns, rows, &mut file).map_err(|error| match error {
            parquet::EncodeError::Rows(error) => error,
            parquet::EncodeError::File(error) => {
                OutputError::new(path, &std::io::Error::other(error.to_string())).into()
            }
        })?,
    }
    Ok(file.finish()?)
}

/// The most that is read of a table (octets).
const LARGEST_TABLE: u64 = 1 << 30;

/// The texts of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Texts {
    /// The names of its columns.
    pub(super) columns: Vec<String>,
    /// Its rows, each with a text for each column; empty where there is no value.
    pub(super) rows: Vec<Vec<String>>,
}

/// Reads the table at `path`: Parquet if its name ends so, and CSV otherwise.
///
/// # Errors
/// If it cannot be read, or is no such table.
pub(super) fn read_texts(path: &Path) -> Result<Texts, TableError> {
    let unreadable = |error: std::io::Error| TableError::Read { path: path.to_owned(), why: error.to_string() };
    let other = |why: String| TableError::Other { path: path.to_owned(), why };
    if path.extension().is_some_and(|extension| extension == "parquet") {
        #[cfg(feature = "parquet")]
        return parquet::decode(std::fs::File::open(path).map_err(unreadable)?).map_err(other);
        #[cfg(not(feature = "parquet"))]
        return Err(TableError::NoParquet { path: path.to_owned() });
    }
    parsed(&read_text_at_most(path, LARGEST_TABLE).map_err(unreadable)?).map_err(other)
}

/// The rows of a table that are read one after the other.
pub(super) struct TextRows {
    /// The names of its columns.
    pub(super) columns: Vec<String>,
    /// Its rows, as those of [`Texts`].
    pub(super) rows: TextIter,
}

/// Rows of texts that are read one after the other.
pub(super) type TextIter = Box<dyn Iterator<Item = Result<Vec<String>, TableError>>>;

/// As [`read_texts`], but the rows are read when they are asked for: those of a CSV table up to `end` (octets), or all.
///
/// # Errors
/// If the file cannot be read, or is no such table.
pub(super) fn stream_texts(path: &Path, end: Option<u64>) -> Result<TextRows, TableError> {
    if path.extension().is_some_and(|extension| extension == "parquet") {
        #[cfg(feature = "parquet")]
        return parquet::stream(path);
        #[cfg(not(feature = "parquet"))]
        return Err(TableError::NoParquet { path: path.to_owned() });
    }
    let file = path.to_owned();
    let wrong = move |error: csv::Error| wrong(&file, &error);
    let octets = File::open(path).map_err(|error| wrong(error.into()))?.take(end.unwrap_or(u64::MAX));
    let mut reader = csv::Reader::from_reader(octets);
    let columns = texts(reader.headers().map_err(&wrong)?);
    let rows = reader.into_records().map(move |record| Ok(texts(&record.map_err(&wrong)?)));
    Ok(TextRows { columns, rows: Box::new(rows) })
}

/// The error of a CSV table.
fn wrong(path: &Path, error: &csv::Error) -> TableError {
    let path = path.to_owned();
    match error.kind() {
        csv::ErrorKind::Io(why) => TableError::Read { path, why: why.to_string() },
        csv::ErrorKind::Utf8 { err, .. } => TableError::Read { path, why: err.to_string() },
        _ => TableError::Other { path, why: error.to_string() },
    }
}

/// Where the runs end that are whole in the CSV table at `path` (octets), if its last row was cut off: it has too few cells, or
/// ends with the file in the midst of `mark`, the last cell. `None` if no row was cut off. Other rows of a run that was cut off
/// are not whole.
///
/// # Errors
/// If the file cannot be read.
pub(super) fn end_of_whole_runs(path: &Path, mark: &str) -> Result<Option<u64>, TableError> {
    if path.extension().is_some_and(|extension| extension == "parquet") {
        return Ok(None);
    }
    let wrong = |error: csv::Error| wrong(path, &error);
    let mut reader = csv::ReaderBuilder::new().flexible(true).from_path(path).map_err(wrong)?;
    let columns = reader.byte_headers().map_err(wrong)?.len();
    let (mut row, mut next) = (csv::ByteRecord::new(), csv::ByteRecord::new());
    // Where the run of the row begins.
    let mut start = reader.position().byte();
    loop {
        let next_start = reader.position().byte();
        if !reader.read_byte_record(&mut next).map_err(wrong)? {
            break;
        }
        // A row that ends before its run is known may be of the run before it.
        let is_same = !row.is_empty() && (next.len() < 3 || (0..2).all(|cell| next.get(cell) == row.get(cell)));
        if !is_same {
            start = next_start;
        }
        std::mem::swap(&mut row, &mut next);
    }
    let is_whole = row.is_empty()
        || row.len() > columns
        || (row.len() == columns
            && (row.iter().next_back() == Some(mark.as_bytes())
                || ends_a_line(path).map_err(|why| wrong(why.into()))?));
    Ok((!is_whole).then_some(start))
}

/// Whether a file ends with the end of a line.
fn ends_a_line(path: &Path) -> std::io::Result<bool> {
    let mut file = File::open(path)?;
    file.seek(SeekFrom::End(-1))?;
    let mut last = [0];
    file.read_exact(&mut last)?;
    Ok(last == *b"\n")
}

/// The cells of a row.
fn texts(record: &csv::StringRecord) -> Vec<String> {
    record.iter().map(|cell| of_cell(cell).to_owned()).collect()
}

/// The texts of a CSV table.
pub(super) fn parsed(text: &str) -> Result<Texts, String> {
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let columns = texts(reader.headers().map_err(|error| error.to_string())?);
    let rows = reader.records().map(|record| Ok(texts(&record?))).collect::<Result<_, csv::Error>>();
    Ok(Texts { columns, rows: rows.map_err(|error| error.to_string())? })
}

/// Gives `write` the table as text, some rows at a time.
fn csv(
    columns: &[Column],
    rows: impl Iterator<Item = Result<Vec<String>, TableError>>,
    mut write: impl FnMut(&[u8]) -> Result<(), TableError>,
) -> Result<(), TableError> {
    let mut file = CsvFile::new(columns.iter().map(|column| &column.name), EmptyCell::Bare);
    for row in rows {
        file.row(row?);
        if file.bytes().len() >= AT_ONCE {
            write(&file.take())?;
        }
    }
    write(file.bytes())
}

/// A table is written when there are so many octets of it.
const AT_ONCE: usize = 1 << 18;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sweep::column::ColumnKind;

    pub(super) fn table() -> (Vec<Column>, Vec<Vec<String>>) {
        let columns = vec![
            Column::new("cell", ColumnKind::Integer),
            Column::new("error", ColumnKind::Text),
            Column::new("ml-tm.connectivity_error", ColumnKind::Real),
        ];
        let row = |texts: [&str; 3]| texts.map(str::to_owned).to_vec();
        (columns, vec![row(["0", "", "0.1"]), row(["1", "no, \"never\"", ""])])
    }

    #[test]
    fn a_csv_table_quotes_cells_where_needed() {
        let (columns, rows) = table();
        let mut text = Vec::new();
        let write = |rows: &[u8]| {
            text.extend_from_slice(rows);
            Ok(())
        };
        csv(&columns, rows.into_iter().map(Ok), write).unwrap();
        assert_eq!(
            String::from_utf8(text).unwrap(),
            "cell,error,ml-tm.connectivity_error\n0,,0.1\n1,\"no, \"\"never\"\"\",\n"
        );
    }

    #[test]
    #[cfg(not(feature = "parquet"))]
    fn the_error_without_parquet_names_the_feature() {
        let error = TableFormat::of(Path::new("table.parquet")).unwrap_err();
        assert!(error.advice().is_some_and(|advice| advice.contains("--features parquet")), "{error:?}");
    }

    #[test]
    fn other_extensions_are_rejected() {
        let refused = |name: &str| TableFormat::of(Path::new(name)).unwrap_err();
        assert!(matches!(refused("table"), TableError::NoExtension { .. }));
        assert!(matches!(refused("table.xlsx"), TableError::Extension { extension, .. } if extension == "xlsx"));
    }
}
