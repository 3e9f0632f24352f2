//! Differences between runs with the same seed: to a map, or to a value of a setting. What both runs have in common, such as
//! the places of nodes, cancels out, so that intervals are narrower than those of two means.

use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::path::Path;

use sextant::summary::Unit;
use sextant_figure::Curves;
use sextant_recording::output::{CsvFile, EmptyCell};

use super::groups::{Curve, Groups};
use super::{Drawn, Points, add, averaged, note};
use crate::sweep::error::TableError;
use crate::sweep::finished_table::{FinishedTable, exact_number};
use crate::sweep::setting::SettingName;
use crate::sweep::statistics::Mean;

/// What the others are compared with.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Reference {
    /// A map of the same run.
    Map(String),
    /// A value of a setting, in the runs with the same seed and other settings.
    Value { column: usize, value: String },
}

/// Why there is no such reference.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct NoReference {
    wanted: String,
    known: String,
}

impl NoReference {
    pub(super) fn of(self, path: &Path) -> TableError {
        TableError::NoReference { path: path.to_owned(), wanted: self.wanted, known: self.known }
    }
}

impl Reference {
    /// Reads `MAP` or `KEY=VALUE`; a key may be written by its end.
    pub(super) fn parse(table: &FinishedTable, text: &str) -> Result<Self, NoReference> {
        let no = |known: Vec<&str>| NoReference { wanted: text.to_owned(), known: known.join(", ") };
        if table.maps().iter().any(|map| map == text) {
            return Ok(Self::Map(text.to_owned()));
        }
        let maps = table.maps().iter().map(String::as_str);
        let keys = table.settings().map(|column| table.columns()[column].as_str());
        let Some((key, value)) = text.split_once('=') else { return Err(no(maps.chain(keys).collect())) };
        let is_called = |name: &str| name == key || name.strip_suffix(key).is_some_and(|rest| rest.ends_with('.'));
        let found: Vec<usize> = table.settings().filter(|&column| is_called(&table.columns()[column])).collect();
        let [column] = found[..] else { return Err(no(keys.collect())) };
        let mut values: Vec<&str> = Vec::new();
        for &row in table.runs() {
            let other = table.cell(row, column);
            if is_same(other, value) {
                return Ok(Self::Value { column, value: other.to_owned() });
            }
            if !values.contains(&other) {
                values.push(other);
            }
        }
        Err(no(values))
    }

    /// Whether a row is one that others are compared with.
    fn has(&self, table: &FinishedTable, row: usize) -> bool {
        match self {
            Self::Map(map) => table.map(row) == map,
            Self::Value { column, value } => is_same(table.cell(row, *column), value),
        }
    }

    /// How many rows others are compared with, and how many others there are.
    pub(super) fn counts(&self, table: &FinishedTable) -> (usize, usize) {
        let rows = match self {
            Self::Map(_) => (0..table.row_count()).collect(),
            Self::Value { .. } => table.runs().to_vec(),
        };
        let of_reference = rows.iter().filter(|&&row| self.has(table, row)).count();
        (of_reference, rows.len() - of_reference)
    }

    /// As in a sentence.
    fn words(&self, table: &FinishedTable) -> String {
        match self {
            Self::Map(map) => map.clone(),
            Self::Value { column, value } => SettingName::of(&table.columns()[*column]).with(value),
        }
    }
}

/// The differences of a measure.
pub(super) struct Differences<'a> {
    table: &'a FinishedTable,
    pub(super) drawn: &'a Drawn,
    reference: &'a Reference,
    /// Each row with a number that is compared, and its difference to that of its partner, if it has one, in the unit of the axis.
    rows: Vec<(usize, Option<f64>)>,
}

impl<'a> Differences<'a> {
    /// Those of a measure; nothing if no two rows can be compared, as those of whole runs between maps. A partner has the same
    /// seed, number of the run, map and settings, but what is compared.
    pub(super) fn of(table: &'a FinishedTable, drawn: &'a Drawn, reference: &'a Reference) -> Option<Self> {
        if matches!(reference, Reference::Map(_)) && !table.is_of_maps(drawn.column) {
            return None;
        }
        let key = |row: usize| -> Vec<Exact<'_>> {
            let settings = table.settings().map(|setting| match reference {
                Reference::Value { column, .. } if *column == setting => "",
                _ => table.cell(row, setting),
            });
            let map = match reference {
                Reference::Value { .. } if table.is_of_maps(drawn.column) => table.map(row),
                _ => "",
            };
            [table.cell(row, 1), table.cell(row, 2), map].into_iter().chain(settings).map(Exact::of).collect()
        };
        let rows = table.rows_of(drawn.column);
        let numbers = || rows.iter().filter_map(|&row| Some((row, drawn.number(table, row)?)));
        let references: BTreeMap<_, _> =
            numbers().filter(|(row, _)| reference.has(table, *row)).map(|(row, number)| (key(row), number)).collect();
        let difference = |(row, number): (usize, f64)| (row, references.get(&key(row)).map(|other| number - other));
        let rows: Vec<_> = numbers().filter(|(row, _)| !reference.has(table, *row)).map(difference).collect();
        (!rows.is_empty()).then_some(Self { table, drawn, reference, rows })
    }

    /// Number of the rows that have a partner.
    pub(super) fn pairs(&self) -> usize {
        self.rows.iter().filter(|(_, difference)| difference.is_some()).count()
    }

    /// The curves of differences; nothing if there is no numeric setting.
    pub(super) fn curves(&self, title: &str) -> Option<Curves> {
        let (table, across) = (self.table, self.table.across()?);
        let groups = Groups::new(table, self.drawn.column, &[across]);
        let mut curves: BTreeMap<Curve, Points> = BTreeMap::new();
        for &(row, difference) in &self.rows {
            if let (Some(x), Some(difference)) = (table.number(row, across), difference) {
                add(curves.entry(groups.of(row)).or_default(), x, difference);
            }
        }
        let counts = curves.values().flatten().map(|(_, values)| values.len());
        let note = note("difference between runs with the same seed, mean", counts);
        // The difference of two outcomes is no outcome: -1, 0 or 1.
        let series =
            curves.into_iter().map(|(curve, points)| averaged(curve.name("difference"), points, Unit::Plain));
        let against = self.reference.words(table);
        Some(Curves {
            title: format!("{title}: against {against}"),
            note,
            across: SettingName::of(&table.columns()[across]).axis(),
            up: format!("difference of {}", self.drawn.label),
            series: series.collect(),
        })
    }
}

/// Differences as a table: one row for each measure, cell and map, in the unit of the column.
pub(super) fn table(table: &FinishedTable, of: &[Differences]) -> CsvFile {
    let settings = || table.settings().map(|column| table.columns()[column].clone());
    let head = ["measure", "cell", "map"].map(str::to_owned).into_iter().chain(settings());
    let tail = ["against", "pairs", "mean_difference", "half_width_95"].map(str::to_owned);
    let mut file = CsvFile::new(head.chain(tail), EmptyCell::Bare);
    for Differences { drawn, reference, rows, .. } in of {
        let has_maps = table.is_of_maps(drawn.column);
        let mut cells: Vec<(usize, Vec<f64>)> = Vec::new();
        let mut places: BTreeMap<(&str, &str), usize> = BTreeMap::new();
        let map_of = |row: usize| if has_maps { table.map(row) } else { "" };
        for &(row, difference) in rows {
            let place = *places.entry((table.cell(row, 0), map_of(row))).or_insert_with(|| {
                cells.push((row, Vec::new()));
                cells.len() - 1
            });
            cells[place].1.extend(difference.map(|difference| difference / drawn.factor));
        }
        for (row, values) in cells {
            let mean = Mean::of(&values);
            let settings = table.settings().map(|column| table.cell(row, column).to_owned());
            let against = match reference {
                Reference::Map(map) => map.clone(),
                Reference::Value { column, value } => format!("{}={value}", table.columns()[*column]),
            };
            let text = |number: Option<f64>| number.map_or_else(String::new, |number| format!("{number:?}"));
            let numbers = [mean.map(|mean| mean.mean), mean.and_then(|mean| mean.half_width_95)].map(text);
            let numbers = [against, values.len().to_string()].into_iter().chain(numbers);
            let head = [table.columns()[drawn.column].clone(), table.cell(row, 0).to_owned(), map_of(row).to_owned()];
            file.row(head.into_iter().chain(settings).chain(numbers));
        }
    }
    file
}

/// A text of a table by its value: `-50` and `-50.0` are the same.
#[derive(Debug)]
enum Exact<'a> {
    Number(f64),
    Text(&'a str),
}

impl<'a> Exact<'a> {
    fn of(text: &'a str) -> Self {
        exact_number(text).map_or(Self::Text(text), Self::Number)
    }
}

impl Ord for Exact<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a.total_cmp(b),
            (Self::Text(a), Self::Text(b)) => a.cmp(b),
            (Self::Number(_), Self::Text(_)) => Ordering::Less,
            (Self::Text(_), Self::Number(_)) => Ordering::Greater,
        }
    }
}

impl PartialOrd for Exact<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Exact<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Exact<'_> {}

/// Whether two texts of a table are the same value.
fn is_same(a: &str, b: &str) -> bool {
    Exact::of(a) == Exact::of(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Three seeds, two maps, two powers.
    const TABLE: &str = "cell,replicate,seed,power_dbm,map,error,stops,mapped\n\
                         0,0,1,-50,a,,5,10\n0,0,1,-50,b,,5,13\n0,1,2,-50,a,,7,20\n0,1,2,-50,b,,7,24\n0,2,3,-50,a,,9,5\n\
                         1,0,1,-40.0,a,,6,11\n1,0,1,-40.0,b,,6,11\n1,1,2,-40.0,,boom,,\n";

    fn differences(against: &str, measure: &str) -> Vec<Vec<String>> {
        let finished = FinishedTable::parse(TABLE).unwrap();
        let drawn = Drawn::of(&finished, finished.measure(measure).unwrap());
        let reference = Reference::parse(&finished, against).unwrap();
        let of: Vec<_> = Differences::of(&finished, &drawn, &reference).into_iter().collect();
        let text = String::from_utf8(table(&finished, &of).bytes().to_vec()).unwrap();
        text.lines().skip(1).map(|line| line.split(',').map(str::to_owned).collect()).collect()
    }

    #[test]
    fn maps_are_compared_within_their_run() {
        let rows = differences("a", "mapped");
        // 3 and 4 with t(0.975; 1) = 12.7062: 3.5 ± 12.7062 · 0.7071 / sqrt(2).
        assert_eq!(rows[0][..7], ["mapped", "0", "b", "-50", "a", "2", "3.5"]);
        assert!((rows[0][7].parse::<f64>().unwrap() - 6.3531).abs() < 1e-3, "{rows:?}");
        assert_eq!(rows[1], ["mapped", "1", "b", "-40.0", "a", "1", "0.0", ""]);
        assert_eq!(differences("a", "stops"), Vec::<Vec<String>>::new(), "maps of one run have one number of stops");
    }

    #[test]
    fn values_of_a_setting_are_compared_between_runs_with_the_same_seed() {
        for against in ["power_dbm=-50", "power_dbm=-50.0"] {
            let rows = differences(against, "mapped");
            assert_eq!(rows[0][..7], ["mapped", "1", "a", "-40.0", "power_dbm=-50", "1", "1.0"]);
            assert_eq!(rows[1][..7], ["mapped", "1", "b", "-40.0", "power_dbm=-50", "1", "-2.0"]);
            assert_eq!(
                differences(against, "stops")[0][..7],
                ["stops", "1", "", "-40.0", "power_dbm=-50", "1", "1.0"]
            );
        }
    }

    #[test]
    fn runs_are_paired_by_seed_and_all_other_settings() {
        // Another text of the same value, another seed, and a setting that changes with the power.
        let text = "cell,replicate,seed,power_dbm,rate,map,error,stops\n0,0,1,-50,2,,,5\n1,0,1,-40,2.0,,,8\n\
                    2,0,18446744073709551615,-40,2,,,9\n3,0,1,-40,3,,,7\n4,0,18446744073709551614,-50.0,2,,,1\n";
        let finished = FinishedTable::parse(text).unwrap();
        let drawn = Drawn::of(&finished, finished.measure("stops").unwrap());
        let reference = Reference::parse(&finished, "power_dbm=-50").unwrap();
        let found = Differences::of(&finished, &drawn, &reference).unwrap();
        assert_eq!((found.rows.clone(), found.pairs()), (vec![(1, Some(3.0)), (2, None), (3, None)], 1));
        assert_eq!(reference.counts(&finished), (2, 3));
        let file = table(&finished, &[found]);
        let file = String::from_utf8(file.bytes().to_vec()).unwrap();
        assert_eq!(file.lines().nth(2), Some("stops,2,,-40,2,power_dbm=-50,0,,"), "{file}");
    }

    #[test]
    fn an_unknown_reference_is_refused_with_those_that_there_are() {
        let table = FinishedTable::parse(TABLE).unwrap();
        for (against, known) in [("c", "a, b, power_dbm"), ("power_dbm=1", "-50, -40.0"), ("rate=1", "power_dbm")] {
            assert_eq!(Reference::parse(&table, against).unwrap_err().known, known);
        }
    }
}
