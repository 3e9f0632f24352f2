//! The table of a sweep that is finished, read from its file.

use std::ops::Range;
use std::path::Path;

use super::error::TableError;

/// The usual measures, as ends of the names of their columns, and what they are called on an axis.
const USUAL: [(&str, &str); 12] = [
    ("mac.prr", "packet reception ratio"),
    ("mac.throughput_bit_per_s", "throughput (bit/s)"),
    ("mac.delay_s.mean", "mean delay (s)"),
    ("mac.delay_s.p99", "99th percentile of the delay (s)"),
    ("mac.retries", "retries"),
    ("position_error_m.mean", "mean position error (m)"),
    ("connectivity_error", "connectivity error"),
    ("energy_j.rx", "energy for receiving (J)"),
    ("captured", "share of runs that captured all targets"),
    ("arrived", "share of runs that arrived"),
    ("time_s", "time to the capture or arrival (s)"),
    ("prediction_error_m.mean", "mean error of predicted places (m)"),
];

/// The columns before the settings, and the one after them.
const BEFORE_SETTINGS: [&str; 3] = ["cell", "replicate", "seed"];
const AFTER_SETTINGS: &str = "error";

/// The table of a sweep, as texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FinishedTable {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Number of the first column after the settings.
    settings_end: usize,
}

impl FinishedTable {
    /// Reads the CSV file at `path`.
    ///
    /// # Errors
    /// If it cannot be read, or is not the table of a sweep.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| TableError::Read { path: path.to_owned(), why: error.to_string() })?;
        Self::parse(&text).map_err(|why| TableError::Other { path: path.to_owned(), why })
    }

    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().map_err(|error| error.to_string())?;
        let columns: Vec<String> = header.iter().map(str::to_owned).collect();
        if columns.iter().zip(BEFORE_SETTINGS).filter(|(column, expected)| *column == expected).count() < 3 {
            return Err(format!("it does not begin with the columns {}", BEFORE_SETTINGS.join(", ")));
        }
        let Some(settings_end) = columns.iter().position(|column| column == AFTER_SETTINGS) else {
            return Err(format!("it has no column {AFTER_SETTINGS}"));
        };
        let rows = reader.records().map(|row| Ok(row?.iter().map(str::to_owned).collect()));
        let rows: Vec<Vec<String>> = rows.collect::<Result<_, csv::Error>>().map_err(|error| error.to_string())?;
        Ok(Self { columns, rows, settings_end })
    }

    /// The names of the columns.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// How many rows it has: one a cell and run.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The columns of the settings.
    #[must_use]
    pub fn settings(&self) -> Range<usize> {
        BEFORE_SETTINGS.len()..self.settings_end
    }

    /// The column that says why a run failed.
    #[must_use]
    pub fn error_column(&self) -> usize {
        self.settings_end
    }

    /// The columns of the results.
    #[must_use]
    pub fn measures(&self) -> Range<usize> {
        self.settings_end + 1..self.columns.len()
    }

    /// The texts in a column, by row; empty where a row has none.
    pub fn cells(&self, column: usize) -> impl Iterator<Item = &str> {
        self.rows.iter().map(move |row| row.get(column).map_or("", String::as_str))
    }

    /// What a column is called on an axis, if it is one of the usual measures.
    #[must_use]
    pub fn label(&self, column: usize) -> Option<&'static str> {
        let name = self.columns.get(column)?;
        let is_called = |end: &str| name == end || name.strip_suffix(end).is_some_and(|rest| rest.ends_with('.'));
        USUAL.iter().find(|(end, _)| is_called(end)).map(|(_, words)| *words)
    }

    /// The text in a cell; empty if there is none.
    pub(super) fn cell(&self, row: usize, column: usize) -> &str {
        self.rows[row].get(column).map_or("", String::as_str)
    }

    /// The number in a cell, if it has one.
    pub(super) fn number(&self, row: usize, column: usize) -> Option<f64> {
        self.rows[row].get(column)?.parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// The numeric setting with the most values, and the last one of several, as its column.
    #[must_use]
    pub fn across(&self) -> Option<usize> {
        let values = |column: usize| -> Option<usize> {
            let mut numbers = (0..self.rows.len()).map(|row| self.number(row, column)).collect::<Option<Vec<_>>>()?;
            numbers.sort_by(f64::total_cmp);
            numbers.dedup();
            (numbers.len() > 1).then_some(numbers.len())
        };
        self.settings().filter_map(|column| Some((values(column)?, column))).max().map(|(_, column)| column)
    }

    /// Whether a column is drawn if nothing is asked for: it is one of the usual measures, and has at least one number.
    pub(super) fn is_drawn(&self, column: usize) -> bool {
        self.label(column).is_some() && (0..self.rows.len()).any(|row| self.number(row, column).is_some())
    }

    /// The column of the measure `name`.
    pub(super) fn measure(&self, name: &str) -> Result<usize, TableError> {
        self.measures().find(|&column| self.columns[column] == name).ok_or_else(|| {
            let known = self.columns[self.measures()].join(", ");
            TableError::NoMeasure { measure: name.to_owned(), known }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_tables_are_rejected() {
        assert!(FinishedTable::parse("a,b\n1,2\n").unwrap_err().contains("cell, replicate, seed"));
        assert!(FinishedTable::parse("cell,replicate,seed,x\n").unwrap_err().contains("error"));
    }

    #[test]
    fn columns_are_settings_or_measures() {
        let table = FinishedTable::parse("cell,replicate,seed,a.rate,error,mac.prr\n0,0,7,2.5,,0.5\n").unwrap();
        assert_eq!((table.settings(), table.measures()), (3..4, 5..6));
        assert_eq!(table.label(5), Some("packet reception ratio"));
        assert_eq!(table.cells(3).collect::<Vec<_>>(), ["2.5"]);
    }
}
