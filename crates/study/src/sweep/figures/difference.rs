//! Differences between runs with the same seed: to a map, or to a value of a setting. What both runs have in common, such as
//! the places of nodes, cancels out, so that intervals are narrower than those of two means.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_figure::{Curves, Series};
use sextant_recording::output::{CsvFile, EmptyCell};

use super::groups::{Curve, Groups};
use super::{Drawn, Points, add, averaged, note};
use crate::sweep::error::TableError;
use crate::sweep::finished_table::FinishedTable;
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
        let number = |text: &str| text.parse::<f64>().ok();
        let is_same = |other: &str| {
            other == value || number(other).zip(number(value)).is_some_and(|(a, b)| a.total_cmp(&b).is_eq())
        };
        let mut values: Vec<&str> = Vec::new();
        for &row in table.runs() {
            let other = table.cell(row, column);
            if is_same(other) {
                return Ok(Self::Value { column, value: other.to_owned() });
            }
            if !values.contains(&other) {
                values.push(other);
            }
        }
        Err(no(values))
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
    /// Each row that has a partner, with its number minus that of the partner, in the unit of the axis.
    pairs: Vec<(usize, f64)>,
}

impl<'a> Differences<'a> {
    /// Those of a measure; nothing if no two runs can be compared, as those of whole runs between maps.
    pub(super) fn of(table: &'a FinishedTable, drawn: &'a Drawn, reference: &'a Reference) -> Option<Self> {
        let is_reference = |row: usize| match reference {
            Reference::Map(map) => table.map(row) == map,
            Reference::Value { column, value } => table.cell(row, *column) == value,
        };
        if matches!(reference, Reference::Map(_)) && !table.is_of_maps(drawn.column) {
            return None;
        }
        // What two rows have in common: the number of the run, its seed, settings and map, without that which is compared.
        let key = |row: usize| -> Vec<&str> {
            let settings = table.settings().map(|setting| match reference {
                Reference::Value { column, .. } if *column == setting => "",
                _ => table.cell(row, setting),
            });
            let map = match reference {
                Reference::Value { .. } if table.is_of_maps(drawn.column) => table.map(row),
                _ => "",
            };
            [table.cell(row, 1), table.cell(row, 2), map].into_iter().chain(settings).collect()
        };
        let rows = table.rows_of(drawn.column);
        let numbers = || rows.iter().filter_map(|&row| Some((row, drawn.number(table, row)?)));
        let references: BTreeMap<_, _> =
            numbers().filter(|(row, _)| is_reference(*row)).map(|(row, number)| (key(row), number)).collect();
        let pair = |(row, number): (usize, f64)| Some((row, number - references.get(&key(row))?));
        let pairs: Vec<_> = numbers().filter(|(row, _)| !is_reference(*row)).filter_map(pair).collect();
        (!pairs.is_empty()).then_some(Self { table, drawn, reference, pairs })
    }

    /// The curves of differences; nothing if there is no numeric setting.
    pub(super) fn curves(&self, title: &str) -> Option<Curves> {
        let (table, across) = (self.table, self.table.across()?);
        let groups = Groups::new(table, self.drawn.column, &[across]);
        let mut curves: BTreeMap<Curve, Points> = BTreeMap::new();
        for &(row, difference) in &self.pairs {
            if let Some(x) = table.number(row, across) {
                add(curves.entry(groups.of(row)).or_default(), x, difference);
            }
        }
        let runs = curves.values().flatten().map(|(_, values)| values.len()).max();
        let series = curves.into_iter().map(|(curve, points)| {
            let (points, half_widths) = averaged(points);
            Series { name: curve.name("difference"), points, half_widths }
        });
        let against = self.reference.words(table);
        Some(Curves {
            title: format!("{title}: against {against}"),
            note: note("difference between runs with the same seed, mean", runs.unwrap_or(0)),
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
    for Differences { drawn, reference, pairs, .. } in of {
        let has_maps = table.is_of_maps(drawn.column);
        let mut cells: Vec<(usize, Vec<f64>)> = Vec::new();
        let mut places: BTreeMap<(&str, &str), usize> = BTreeMap::new();
        let map_of = |row: usize| if has_maps { table.map(row) } else { "" };
        for &(row, difference) in pairs {
            let place = *places.entry((table.cell(row, 0), map_of(row))).or_insert_with(|| {
                cells.push((row, Vec::new()));
                cells.len() - 1
            });
            cells[place].1.push(difference / drawn.factor);
        }
        for (row, values) in cells {
            let Some(mean) = Mean::of(&values) else { continue };
            let settings = table.settings().map(|column| table.cell(row, column).to_owned());
            let against = match reference {
                Reference::Map(map) => map.clone(),
                Reference::Value { column, value } => format!("{}={value}", table.columns()[*column]),
            };
            let half_width = mean.half_width_95.map_or_else(String::new, |half_width| format!("{half_width:?}"));
            let numbers = [against, mean.runs.to_string(), format!("{:?}", mean.mean), half_width];
            let head = [table.columns()[drawn.column].clone(), table.cell(row, 0).to_owned(), map_of(row).to_owned()];
            file.row(head.into_iter().chain(settings).chain(numbers));
        }
    }
    file
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
    fn an_unknown_reference_is_refused_with_those_that_there_are() {
        let table = FinishedTable::parse(TABLE).unwrap();
        for (against, known) in [("c", "a, b, power_dbm"), ("power_dbm=1", "-50, -40.0"), ("rate=1", "power_dbm")] {
            assert_eq!(Reference::parse(&table, against).unwrap_err().known, known);
        }
    }
}
