//! Figures of the table of a sweep: measures against a setting.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::error::TableError;
use super::statistics::Mean;
use super::theory::{self, Theory};
use crate::scenario::Scenario;
use sextant_figure::{Curves, Figure, Series};

/// Measures that are drawn unless others are asked for, as ends of the names of their columns, and what they are called
/// on an axis.
const DRAWN: [(&str, &str); 12] = [
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
#[derive(Debug)]
struct Table {
    columns: Vec<String>,
    rows: Vec<Vec<String>>,
    /// Number of the first column after the settings.
    settings_end: usize,
}

/// A figure for each of `wanted`, or of the usual measures if it is empty: the mean of the measure with its 95 % interval,
/// against the numeric setting with the most values. Each combination of the other settings is a curve.
///
/// # Errors
/// If the file cannot be read, is not the table of a sweep, has no numeric setting or no such column.
pub fn figures(path: &Path, wanted: &[String]) -> Result<Vec<Figure>, TableError> {
    figures_with_theory(path, wanted, None)
}

/// The same with what theory says, where its assumptions hold for the cells of `scenario`, of which the table is.
///
/// # Errors
/// As [`figures`].
pub fn figures_with_theory(
    path: &Path,
    wanted: &[String],
    scenario: Option<&Scenario>,
) -> Result<Vec<Figure>, TableError> {
    let text = std::fs::read_to_string(path)
        .map_err(|error| TableError::Read { path: path.to_owned(), why: error.to_string() })?;
    let table =
        Table::parse(&text).map_err(|why| TableError::Other { path: path.to_owned(), why: why.to_string() })?;
    let Some(across) = table.across() else {
        return Err(TableError::NoAxis { path: path.to_owned() });
    };
    let drawn: Vec<usize> = if wanted.is_empty() {
        (table.settings_end..table.columns.len()).filter(|&column| table.is_drawn(column)).collect()
    } else {
        wanted.iter().map(|name| table.measure(name)).collect::<Result<_, _>>()?
    };
    let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let figures = drawn.into_iter().map(|column| {
        let name = &table.columns[column];
        let mut curves = table.curves(&title, across, column);
        curves.series.extend(scenario.map(|scenario| table.theory(scenario, across, column)).unwrap_or_default());
        curves.figure(&format!("{title}-{}", name.replace(['.', '/'], "-")))
    });
    Ok(figures.collect())
}

impl Table {
    fn parse(text: &str) -> Result<Self, String> {
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

    fn settings(&self) -> std::ops::Range<usize> {
        BEFORE_SETTINGS.len()..self.settings_end
    }

    fn number(&self, row: usize, column: usize) -> Option<f64> {
        self.rows[row].get(column)?.parse().ok().filter(|number: &f64| number.is_finite())
    }

    /// The numeric setting with the most values, and the last one of several.
    fn across(&self) -> Option<usize> {
        let values = |column: usize| -> Option<usize> {
            let mut numbers = (0..self.rows.len()).map(|row| self.number(row, column)).collect::<Option<Vec<_>>>()?;
            numbers.sort_by(f64::total_cmp);
            numbers.dedup();
            (numbers.len() > 1).then_some(numbers.len())
        };
        self.settings().filter_map(|column| Some((values(column)?, column))).max().map(|(_, column)| column)
    }

    /// Whether a column is drawn if nothing is asked for: it is one of the usual measures, and has at least one number.
    fn is_drawn(&self, column: usize) -> bool {
        let name = &self.columns[column];
        let is_usual = DRAWN.iter().any(|(end, _)| name == end || name.ends_with(&format!(".{end}")));
        is_usual && (0..self.rows.len()).any(|row| self.number(row, column).is_some())
    }

    fn measure(&self, name: &str) -> Result<usize, TableError> {
        let found = self.columns.iter().skip(self.settings_end + 1).position(|column| column == name);
        found.map(|column| self.settings_end + 1 + column).ok_or_else(|| {
            let known = self.columns[self.settings_end + 1..].join(", ");
            TableError::NoMeasure { measure: name.to_owned(), known }
        })
    }

    /// What theory says of a measure in the cells of `scenario`, as curves.
    fn theory(&self, scenario: &Scenario, across: usize, column: usize) -> Vec<Series> {
        let mut curves: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
        let mut known = BTreeSet::new();
        for (row, cells) in self.rows.iter().enumerate() {
            let settings: Vec<&String> = self.settings().filter_map(|setting| cells.get(setting)).collect();
            if !known.insert(settings) {
                continue;
            }
            let cell = self.settings().try_fold(scenario.clone(), |cell, setting| {
                cell.with(&self.columns[setting], cells.get(setting).map_or("", String::as_str)).ok()
            });
            let found = cell.and_then(|cell| theory::of(&cell, &self.columns[column]));
            if let (Some(x), Some(Theory { source, value })) = (self.number(row, across), found) {
                let others = self.others(row, across);
                let name = if others.is_empty() { source.to_owned() } else { format!("{others}: {source}") };
                curves.entry(name).or_default().push((x, value));
            }
        }
        let series = |(name, mut points): (String, Vec<(f64, f64)>)| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            Series { name, points, half_widths: Vec::new() }
        };
        curves.into_iter().map(series).collect()
    }

    /// The settings of a row but the one on the axis.
    fn others(&self, row: usize, across: usize) -> String {
        let others = self.settings().filter(|&other| other != across);
        let others = others.map(|other| format!("{} {}", short(&self.columns[other]), self.rows[row][other]));
        others.collect::<Vec<_>>().join(", ")
    }

    /// The curves of a measure.
    fn curves(&self, title: &str, across: usize, column: usize) -> Curves {
        // By the other settings: each number on the axis, and the measures there.
        let mut curves: BTreeMap<String, Vec<(f64, Vec<f64>)>> = BTreeMap::new();
        for row in 0..self.rows.len() {
            let (Some(x), Some(y)) = (self.number(row, across), self.number(row, column)) else { continue };
            let points = curves.entry(self.others(row, across)).or_default();
            match points.iter_mut().find(|(known, _)| known.total_cmp(&x).is_eq()) {
                Some((_, values)) => values.push(y),
                None => points.push((x, vec![y])),
            }
        }
        let runs = curves.values().flatten().map(|(_, values)| values.len()).max();
        let series = curves.into_iter().map(|(name, mut points)| {
            points.sort_by(|a, b| a.0.total_cmp(&b.0));
            let means: Vec<_> = points.iter().filter_map(|(x, values)| Some((*x, Mean::of(values)?))).collect();
            Series {
                name: if name.is_empty() { "mean".to_owned() } else { name },
                points: means.iter().map(|(x, mean)| (*x, mean.mean)).collect(),
                half_widths: means.iter().map(|(_, mean)| mean.half_width_95.unwrap_or(0.0)).collect(),
            }
        });
        let name = &self.columns[column];
        let up = DRAWN.iter().find(|(end, _)| name.ends_with(end)).map_or(name.as_str(), |(_, words)| words);
        Curves {
            title: title.to_owned(),
            note: format!("mean of up to {} runs, with 95 % intervals", runs.unwrap_or(0)),
            across: self.columns[across].clone(),
            up: up.to_owned(),
            series: series.collect(),
        }
    }
}

/// The last part of the name of a setting.
fn short(setting: &str) -> &str {
    setting.rsplit('.').next().unwrap_or(setting)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TABLE: &str = "cell,replicate,seed,a.kind,b.rate,error,mac.prr,other\n\
                         0,0,1,x,10,,0.5,1\n0,1,2,x,10,,0.7,\n1,0,1,x,2.5,,0.9,3\n2,0,1,y,10,,0.25,4\n3,0,1,y,2.5,boom,,\n";

    #[test]
    fn each_combination_of_other_settings_is_a_curve_of_means() {
        let table = Table::parse(TABLE).unwrap();
        assert_eq!(table.across().map(|column| table.columns[column].as_str()), Some("b.rate"));
        let column = table.measure("mac.prr").unwrap();
        let curves = table.curves("t", table.across().unwrap(), column);
        let points: Vec<_> = curves.series.iter().map(|series| (&*series.name, series.points.clone())).collect();
        assert_eq!(points, [("kind x", vec![(2.5, 0.9), (10.0, 0.6)]), ("kind y", vec![(10.0, 0.25)])]);
        // Two runs: t(0.975; 1) = 12.706 times 0.1414 / sqrt(2).
        assert!((curves.series[0].half_widths[1] - 1.2706).abs() < 1e-3);
        assert!(table.measure("mac.nothing").is_err());
    }

    #[test]
    fn other_tables_are_rejected() {
        assert!(Table::parse("a,b\n1,2\n").unwrap_err().contains("cell, replicate, seed"));
        assert!(Table::parse("cell,replicate,seed,x\n").unwrap_err().contains("error"));
    }
}
