//! Tables of a reproduction: published values and ours.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::error::ReportError;

/// The first columns of the table of an experiment.
const FIRST_COLUMNS: [&str; 2] = ["what", "published"];

/// The experiments of a reproduction.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Reproduction {
    /// The experiments, by number.
    pub experiments: Vec<Claims>,
}

/// The table of an experiment.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Claims {
    /// Its number: that of a table or figure of the thesis.
    pub id: String,
    /// What it is about, if that is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The columns.
    pub columns: Vec<String>,
    /// The rows, with one text a column.
    pub rows: Vec<Vec<String>>,
}

/// Whether the file or folder `path` holds tables of a reproduction.
pub(super) fn is_reproduction(path: &Path) -> bool {
    tables(path).is_ok_and(|tables| tables.iter().any(|table| Claims::read(table).is_ok()))
}

/// The CSV files of a folder, by name, or the file alone.
fn tables(path: &Path) -> Result<Vec<PathBuf>, ReportError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let unreadable = |error: std::io::Error| ReportError::Read { path: path.to_owned(), why: error.to_string() };
    let mut files = Vec::new();
    for entry in std::fs::read_dir(path).map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        if file.extension().is_some_and(|extension| extension == "csv") {
            files.push(file);
        }
    }
    files.sort();
    Ok(files)
}

impl Claims {
    /// Reads the table of an experiment.
    fn read(path: &Path) -> Result<Self, ReportError> {
        let unreadable = |why: String| ReportError::Read { path: path.to_owned(), why };
        let text = sextant_kernel::read_text_at_most(path, sextant_kernel::LARGEST_FILE)
            .map_err(|error| unreadable(error.to_string()))?;
        let mut reader = csv::ReaderBuilder::new().flexible(true).from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| unreadable(error.to_string()))?;
        let columns: Vec<String> = header.iter().map(str::to_owned).collect();
        if !columns.iter().map(String::as_str).take(2).eq(FIRST_COLUMNS) {
            return Err(ReportError::NotATable { path: path.to_owned(), columns });
        }
        let row = |row: Result<csv::StringRecord, csv::Error>| Ok(row?.iter().map(str::to_owned).collect());
        let rows = reader.records().map(row).collect::<Result<_, csv::Error>>();
        let rows = rows.map_err(|error| unreadable(error.to_string()))?;
        let id = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        Ok(Self { id, title: None, columns, rows })
    }
}

impl Reproduction {
    /// Reads a folder of tables, or one table. `titles` says what the experiments are about, by their numbers.
    ///
    /// # Errors
    /// If it cannot be read, or there is no such table.
    pub(super) fn read(path: &Path, titles: &BTreeMap<String, String>) -> Result<Self, ReportError> {
        let mut experiments = Vec::new();
        for table in tables(path)? {
            match Claims::read(&table) {
                Ok(claims) => experiments.push(Claims { title: titles.get(&claims.id).cloned(), ..claims }),
                // A folder has other tables too: those of the runs.
                Err(ReportError::NotATable { .. }) if path.is_dir() => {}
                Err(error) => return Err(error),
            }
        }
        experiments.sort_by_key(|claims| numbers(&claims.id));
        Ok(Self { experiments })
    }
}

/// A key that puts 3.10 behind 3.9, and names without a number at the end: the numbers in `id`, and the text.
fn numbers(id: &str) -> (bool, Vec<u64>, String) {
    let parts = id.split(|letter: char| !letter.is_ascii_digit());
    let numbers: Vec<u64> = parts.filter_map(|part| part.parse().ok()).collect();
    (numbers.is_empty(), numbers, id.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn experiments_are_sorted_by_their_numbers() {
        let mut ids = ["energy", "3.10", "3.9", "6.maps", "10.1"];
        ids.sort_by_key(|id| numbers(id));
        assert_eq!(ids, ["3.9", "3.10", "6.maps", "10.1", "energy"]);
    }
}
