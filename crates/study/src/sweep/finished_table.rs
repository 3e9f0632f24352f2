//! The table of a sweep that is finished, read from its file.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

use sextant::summary::Measure;

use super::error::TableError;
#[cfg(test)]
use super::table_file::parsed;
use super::table_file::{Texts, read_texts};
use super::tidy::{ERROR, IDENTITY, MAP, SWEEP};

/// The measures that are drawn if nothing is asked for, as ends of the names of their columns.
const USUAL: [&str; 20] = [
    "mac.prr",
    "mac.throughput_bit_per_s",
    "mac.delay_s.mean",
    "mac.delay_s.p99",
    "mac.retries",
    "routing.delivery",
    "routing.delay_s.mean",
    "routing.hops.mean",
    "routing.transmissions_per_delivery",
    "routing.depth",
    "battery.lifetime_d.min",
    "slots.duty_cycle",
    "sleep.duty_cycle",
    "position_error_m.mean",
    "connectivity_error",
    "energy_j.rx",
    "captured",
    "arrived",
    "time_s",
    "prediction_error_m.mean",
];

/// The table of a sweep, as texts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FinishedTable {
    texts: Texts,
    /// Number of the column of the map: the first one after the settings.
    map_column: usize,
    /// The first row of each run.
    runs: Vec<usize>,
    /// The maps, in the order of their first rows.
    maps: Vec<String>,
}

impl FinishedTable {
    /// Reads the CSV or Parquet file at `path`.
    ///
    /// # Errors
    /// If it cannot be read, or is not the table of a sweep.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        Self::of(read_texts(path)?).map_err(|why| TableError::Other { path: path.to_owned(), why })
    }

    #[cfg(test)]
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        Self::of(parsed(text)?)
    }

    fn of(texts: Texts) -> Result<Self, String> {
        let columns = &texts.columns;
        if columns.iter().zip(IDENTITY).filter(|(column, expected)| *column == expected).count() < IDENTITY.len() {
            return Err(format!("it does not begin with the columns {}", IDENTITY.join(", ")));
        }
        let Some(map_column) = columns.iter().position(|column| column == MAP) else {
            return Err(format!("it has no column {MAP}"));
        };
        if columns.get(map_column + 1).is_none_or(|column| column != ERROR) {
            return Err(format!("it has no column {ERROR} after the column {MAP}"));
        }
        let mut known = BTreeSet::new();
        let is_first = |row: &Vec<String>| known.insert((row[0].clone(), row[1].clone()));
        let runs = texts.rows.iter().map(is_first).enumerate().filter(|(_, is_first)| *is_first).map(|(row, _)| row);
        let runs = runs.collect();
        let mut maps: Vec<String> = Vec::new();
        for row in &texts.rows {
            let map = &row[map_column];
            if !map.is_empty() && !maps.contains(map) {
                maps.push(map.clone());
            }
        }
        Ok(Self { texts, map_column, runs, maps })
    }

    /// The names of the columns.
    #[must_use]
    pub fn columns(&self) -> &[String] {
        &self.texts.columns
    }

    /// The columns of the settings.
    #[must_use]
    pub fn settings(&self) -> Range<usize> {
        IDENTITY.len()..self.map_column
    }

    /// The column that says why a run failed.
    #[must_use]
    pub fn error_column(&self) -> usize {
        self.map_column + 1
    }

    /// The columns of the results.
    #[must_use]
    pub fn measures(&self) -> Range<usize> {
        let columns = self.columns();
        let has_mark = columns.last().is_some_and(|column| column == SWEEP);
        self.map_column + 2..columns.len() - usize::from(has_mark)
    }

    /// The first row of each run, in the order of the file. Numbers of a whole run stand in each of its rows, and are
    /// counted here.
    #[must_use]
    pub fn runs(&self) -> &[usize] {
        &self.runs
    }

    /// Number of rows.
    pub(super) fn row_count(&self) -> usize {
        self.texts.rows.len()
    }

    /// The names of the maps, in the order of their first rows.
    #[must_use]
    pub fn maps(&self) -> &[String] {
        &self.maps
    }

    /// The row of a map in the run that begins at row `run`.
    #[must_use]
    pub fn row_of(&self, run: usize, map: &str) -> Option<usize> {
        let rows = &self.texts.rows;
        let of_run = (run..rows.len()).take_while(|&row| rows[row][..2] == rows[run][..2]);
        of_run.into_iter().find(|&row| self.cell(row, self.map_column) == map)
    }

    /// The name of the map of a row; empty if it is of none.
    #[must_use]
    pub fn map(&self, row: usize) -> &str {
        self.cell(row, self.map_column)
    }

    /// Whether the numbers of a column are of maps, not of whole runs. A column that this program does not know is of maps
    /// if two rows of a run differ in it.
    #[must_use]
    pub fn is_of_maps(&self, column: usize) -> bool {
        if let Some(measure) = self.known(column) {
            return measure.map().is_some();
        }
        let rows = &self.texts.rows;
        rows.windows(2).any(|pair| pair[0][..2] == pair[1][..2] && pair[0][column] != pair[1][column])
    }

    /// The rows whose numbers in a column count: each that has a map, or the first of each run.
    #[must_use]
    pub fn rows_of(&self, column: usize) -> Vec<usize> {
        if self.is_of_maps(column) {
            (0..self.texts.rows.len()).filter(|&row| !self.map(row).is_empty()).collect()
        } else {
            self.runs.clone()
        }
    }

    /// The measure of a column, of any map, if this program knows it.
    #[must_use]
    pub fn known(&self, column: usize) -> Option<Measure> {
        Measure::of_column(self.columns().get(column)?, MAP)
    }

    /// Whether a column is one of the usual measures.
    #[must_use]
    pub fn is_usual(&self, column: usize) -> bool {
        let Some(name) = self.columns().get(column) else { return false };
        let is_called = |end: &str| name == end || name.strip_suffix(end).is_some_and(|rest| rest.ends_with('.'));
        USUAL.into_iter().any(is_called)
    }

    /// The text in a cell; empty if there is none.
    #[must_use]
    pub fn cell(&self, row: usize, column: usize) -> &str {
        self.texts.rows[row].get(column).map_or("", String::as_str)
    }

    /// The number in a cell, if it has one that a `f64` has exactly.
    #[must_use]
    pub fn number(&self, row: usize, column: usize) -> Option<f64> {
        exact_number(self.cell(row, column))
    }

    /// The numeric setting with the most values, and the last one of several, as its column.
    #[must_use]
    pub fn across(&self) -> Option<usize> {
        let values = |column: usize| -> Option<usize> {
            let mut numbers = self.runs.iter().map(|&row| self.number(row, column)).collect::<Option<Vec<_>>>()?;
            numbers.sort_by(f64::total_cmp);
            numbers.dedup();
            (numbers.len() > 1).then_some(numbers.len())
        };
        self.settings().filter_map(|column| Some((values(column)?, column))).max().map(|(_, column)| column)
    }

    /// Whether a column is drawn if nothing is asked for: it is one of the usual measures, and has at least one number.
    pub(super) fn is_drawn(&self, column: usize) -> bool {
        self.is_usual(column) && (0..self.texts.rows.len()).any(|row| self.number(row, column).is_some())
    }

    /// The column of the measure `name`.
    pub(super) fn measure(&self, name: &str) -> Result<usize, TableError> {
        self.measures().find(|&column| self.columns()[column] == name).ok_or_else(|| {
            let known = self.columns()[self.measures()].join(", ");
            TableError::NoMeasure { measure: name.to_owned(), known }
        })
    }
}

/// The finite number that a text is. A whole number that a `f64` has not exactly, such as a large seed, is none: two of them would
/// be one.
#[must_use]
pub fn exact_number(text: &str) -> Option<f64> {
    let number: f64 = text.parse().ok().filter(|number: &f64| number.is_finite())?;
    // Minus zero is zero.
    let is_exact =
        text.parse::<i128>().map_or(true, |whole| whole == 0 || format!("{number:.0}") == whole.to_string());
    is_exact.then_some(number)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_tables_are_rejected() {
        let why = |text: &str| FinishedTable::parse(text).unwrap_err();
        assert!(why("a,b\n1,2\n").contains("cell, replicate, seed"));
        assert!(why("cell,replicate,seed,x\n").contains("map"));
        assert!(why("cell,replicate,seed,map,x\n").contains("error"));
    }

    #[test]
    fn columns_are_settings_or_measures() {
        let table =
            FinishedTable::parse("cell,replicate,seed,a.rate,map,error,mac.prr,sweep\n0,0,7,2.5,,,0.5,ab\n").unwrap();
        assert_eq!((table.settings(), table.measures(), table.error_column()), (3..4, 6..7, 5));
        assert!(table.is_usual(6) && !table.is_of_maps(6));
    }

    #[test]
    fn large_whole_numbers_are_texts() {
        let found = ["9007199254740992", "9007199254740993", "1e300", "-7", "inf", ""].map(exact_number);
        assert_eq!(found, [Some(9_007_199_254_740_992.0), None, Some(1e300), Some(-7.0), None, None]);
    }

    #[test]
    fn a_number_of_a_run_counts_once_and_that_of_a_map_in_each_of_its_rows() {
        let text = "cell,replicate,seed,map,error,stops,mapped,mine,ours\n0,0,1,a,,5,7,1,2\n0,0,1,b,,5,7,1,3\n\
                    0,1,2,a,,6,7,1,2\n1,0,1,,boom,,,,\n";
        let table = FinishedTable::parse(text).unwrap();
        assert_eq!((table.runs(), table.maps()), (&[0, 2, 3][..], &["a".to_owned(), "b".to_owned()][..]));
        let rows = |name: &str| table.rows_of(table.measure(name).unwrap());
        assert_eq!((rows("stops"), rows("mapped")), (vec![0, 2, 3], vec![0, 1, 2]));
        assert_eq!((rows("mine"), rows("ours")), (vec![0, 2, 3], vec![0, 1, 2]), "columns that others added");
        assert_eq!((table.row_of(0, "b"), table.row_of(2, "b")), (Some(1), None));
    }
}
