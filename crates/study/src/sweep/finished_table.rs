//! The table of a sweep that is finished, read from its file.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;

use sextant::summary::{Measure, Unit};

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
    /// All rows of each of these runs.
    rows_of_runs: Vec<Vec<usize>>,
    /// The maps, in the order of their first rows.
    maps: Vec<String>,
}

impl FinishedTable {
    /// Reads the CSV or Parquet file at `path`.
    ///
    /// # Errors
    /// If it cannot be read, is not the table of a sweep, has a run twice, or has a text where there should be a number.
    pub fn read(path: &Path) -> Result<Self, TableError> {
        let this = Self::of(read_texts(path)?).map_err(|why| TableError::Other { path: path.to_owned(), why })?;
        check(&this).map_err(|why| TableError::Rows { path: path.to_owned(), why })?;
        if this.texts.rows.is_empty() {
            return Err(TableError::NoRows { path: path.to_owned() });
        }
        Ok(this)
    }

    #[cfg(test)]
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let this = Self::of(parsed(text)?)?;
        check(&this)?;
        Ok(this)
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
        let mut known: BTreeMap<(&str, &str), usize> = BTreeMap::new();
        let mut rows_of_runs: Vec<Vec<usize>> = Vec::new();
        for (i, row) in texts.rows.iter().enumerate() {
            let run = *known.entry((&row[0], &row[1])).or_insert(rows_of_runs.len());
            match rows_of_runs.get_mut(run) {
                Some(rows) => rows.push(i),
                None => rows_of_runs.push(vec![i]),
            }
        }
        let runs = rows_of_runs.iter().filter_map(|rows| rows.first().copied()).collect();
        let mut maps: Vec<String> = Vec::new();
        for row in &texts.rows {
            let map = &row[map_column];
            if !map.is_empty() && !maps.contains(map) {
                maps.push(map.clone());
            }
        }
        Ok(Self { texts, map_column, runs, rows_of_runs, maps })
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
        self.map_column + 2..columns.len() - usize::from(self.mark_column().is_some())
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
        let rows = &self.rows_of_runs[self.runs.binary_search(&run).ok()?];
        rows.iter().copied().find(|&row| self.map(row) == map)
    }

    /// The rows of each run, in the order of the file.
    pub(super) fn rows_of_runs(&self) -> &[Vec<usize>] {
        &self.rows_of_runs
    }

    /// Whether a run that is in this row succeeded.
    #[must_use]
    pub fn has_succeeded(&self, row: usize) -> bool {
        self.cell(row, self.error_column()).is_empty()
    }

    /// The column of the mark of the sweep, if there is one.
    pub(super) fn mark_column(&self) -> Option<usize> {
        self.columns().last().filter(|column| *column == SWEEP).map(|_| self.columns().len() - 1)
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
        let differ = |rows: &Vec<usize>| rows.iter().any(|&row| self.cell(row, column) != self.cell(rows[0], column));
        self.rows_of_runs.iter().any(differ)
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
        let name = &self.known(column).map_or_else(|| name.clone(), |measure| measure.column_of_one_network());
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
    ///
    /// # Errors
    /// If there is none.
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

/// Says what is wrong with the rows of `table`, if anything is. Rows are counted from 1 below the header.
fn check(table: &FinishedTable) -> Result<(), String> {
    (0..table.row_count()).try_for_each(|row| check_identity(table, row))?;
    table.rows_of_runs().iter().try_for_each(|rows| check_run(table, rows))?;
    table
        .measures()
        .filter(|&column| table.known(column).is_some())
        .try_for_each(|column| check_numbers(table, column))
}

/// Cell, replicate and seed are whole numbers. Those of a second header are none.
fn check_identity(table: &FinishedTable, row: usize) -> Result<(), String> {
    for column in 0..3 {
        let text = table.cell(row, column);
        let is_whole = text.parse::<u64>().is_ok() || exact_number(text).is_some_and(|number| number.fract() == 0.0);
        if !is_whole {
            let name = &table.columns()[column];
            return Err(format!("row {} has `{text}` in the column `{name}`; allowed: a whole number", row + 1));
        }
    }
    Ok(())
}

/// The rows of a run are of different maps, and have the same seed, settings and mark.
fn check_run(table: &FinishedTable, rows: &[usize]) -> Result<(), String> {
    let Some((&first, others)) = rows.split_first() else { return Ok(()) };
    let both = |row: usize| format!("rows {} and {}", first + 1, row + 1);
    let run = || format!("cell {}, replicate {}", table.cell(first, 0), table.cell(first, 1));
    for &row in others {
        let differs = |column: usize| table.cell(row, column) != table.cell(first, column);
        if let Some(column) = table.mark_column().filter(|&column| differs(column)) {
            let [one, other] = [first, row].map(|row| table.cell(row, column));
            let why = format!("but of two sweeps: their marks are `{one}` and `{other}`");
            return Err(format!("{} are both of {}, {why}", both(row), run()));
        }
        if let Some(column) = [2].into_iter().chain(table.settings()).find(|&column| differs(column)) {
            let name = &table.columns()[column];
            let [one, other] = [first, row].map(|row| table.cell(row, column));
            let why = format!("but `{name}` is `{one}` and `{other}`: are they of two sweeps?");
            return Err(format!("{} are both of {}, {why}", both(row), run()));
        }
    }
    let mut known: Vec<usize> = Vec::new();
    for &row in rows {
        if let Some(&same) = known.iter().find(|&&other| table.map(other) == table.map(row)) {
            let map = table.map(row);
            let of_map = if map.is_empty() { String::new() } else { format!(", map {map}") };
            return Err(format!("rows {} and {} are both of {}{of_map}", same + 1, row + 1, run()));
        }
        known.push(row);
    }
    Ok(())
}

/// Cells of a measure are empty, or have numbers; those of an outcome have 1 or 0.
pub(super) fn check_numbers(table: &FinishedTable, column: usize) -> Result<(), String> {
    let is_outcome = table.known(column).is_some_and(|measure| measure.unit() == Unit::Outcome);
    let is_allowed = |text: &str| {
        let number = exact_number(text);
        let fits = |number: f64| !is_outcome || number.abs() <= 0.0 || (number - 1.0).abs() <= 0.0;
        text.is_empty() || number.is_some_and(fits)
    };
    match (0..table.row_count()).find(|&row| !is_allowed(table.cell(row, column))) {
        None => Ok(()),
        Some(row) => {
            let (text, name) = (table.cell(row, column), &table.columns()[column]);
            let allowed = if is_outcome { "1, 0 or nothing" } else { "a number or nothing" };
            Err(format!("row {} has `{text}` in the column `{name}`; allowed: {allowed}", row + 1))
        }
    }
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

    #[test]
    fn the_rows_of_a_run_need_not_follow_one_another() {
        let text = "cell,replicate,seed,map,error,stops,mapped,ours\n0,0,1,a,,5,7,2\n0,1,2,a,,6,7,2\n\
                    0,0,1,b,,5,8,3\n0,1,2,b,,6,9,3\n";
        let table = FinishedTable::parse(text).unwrap();
        assert_eq!((table.runs(), table.row_of(0, "b"), table.row_of(1, "b")), (&[0, 1][..], Some(2), Some(3)));
        assert_eq!(table.rows_of(table.measure("ours").unwrap()), [0, 1, 2, 3]);
    }

    fn refused(rows: &str) -> String {
        let head = "cell,replicate,seed,rate,map,error,mac.prr,applications.a.captured,mine,sweep\n";
        FinishedTable::parse(&format!("{head}{rows}")).unwrap_err()
    }

    #[test]
    fn a_run_that_stands_twice_is_refused_with_its_rows() {
        let pasted = "0,0,1,5,,,0.5,1,,aa\n0,1,2,5,,,0.6,0,,aa\n0,0,1,5,,,0.5,1,,aa\n";
        assert_eq!(refused(pasted), "rows 1 and 3 are both of cell 0, replicate 0");
        let of_maps = "0,0,1,5,a,,0.5,1,,aa\n0,0,1,5,b,,0.5,1,,aa\n0,0,1,5,b,,0.5,1,,aa\n";
        assert_eq!(refused(of_maps), "rows 2 and 3 are both of cell 0, replicate 0, map b");
    }

    #[test]
    fn rows_of_two_sweeps_are_told_from_those_that_were_pasted_twice() {
        let marks = "0,0,1,5,,,0.5,1,,aa\n0,0,1,5,,,0.5,1,,bb\n";
        let two = "rows 1 and 2 are both of cell 0, replicate 0, but of two sweeps: their marks are `aa` and `bb`";
        assert_eq!(refused(marks), two);
        assert_eq!(refused(&marks.replace("5,,,0.5,1,,bb", "5,b,,0.5,1,,bb")), two, "also with different maps");
        assert!(refused("0,0,1,5,a,,0.5,1,,\n0,0,7,5,b,,0.5,1,,\n").contains("but `seed` is `1` and `7`"));
        assert!(refused("0,0,1,5,a,,0.5,1,,\n0,0,1,6,b,,0.5,1,,\n").contains("but `rate` is `5` and `6`"));
    }

    #[test]
    fn a_text_where_there_are_numbers_is_refused() {
        for text in ["abc", "nan", "inf", "NaN", "-"] {
            let expected = format!("row 2 has `{text}` in the column `mac.prr`; allowed: a number or nothing");
            assert_eq!(refused(&format!("0,0,1,5,,,0.5,1,,\n0,1,2,5,,,{text},1,,\n")), expected);
        }
        assert!(refused("0,0,1,5,,,0.5,0.5,,\n").contains("allowed: 1, 0 or nothing"));
        assert!(
            refused(
                "0,0,1,5,,,0.5,1,,\ncell,replicate,seed,rate,map,error,mac.prr,applications.a.captured,mine,sweep\n"
            )
            .starts_with("row 2 has `cell` in the column `cell`")
        );
        let head = "cell,replicate,seed,map,error,mac.prr,mine\n";
        assert!(FinishedTable::parse(&format!("{head}0,0,1,,,1e-3,good\n0,1,2.0,,,,7\n1,0,1,,boom,,\n")).is_ok());
    }
}
