//! Figures of the table of a sweep: measures against a setting.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use super::error::TableError;
use super::finished_table::FinishedTable;
use super::statistics::Mean;
use super::theory::{self, Theory};
use crate::scenario::Scenario;
use sextant_figure::{Curves, Figure, Series};

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
    let table = FinishedTable::read(path)?;
    let Some(across) = table.across() else {
        return Err(TableError::NoAxis { path: path.to_owned() });
    };
    let drawn: Vec<usize> = if wanted.is_empty() {
        table.measures().filter(|&column| table.is_drawn(column)).collect()
    } else {
        wanted.iter().map(|name| table.measure(name)).collect::<Result<_, _>>()?
    };
    let title = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let figures = drawn.into_iter().map(|column| {
        let name = &table.columns()[column];
        let mut curves = curves(&table, &title, across, column);
        curves.series.extend(scenario.map(|scenario| theory(&table, scenario, across, column)).unwrap_or_default());
        curves.figure(&format!("{title}-{}", name.replace(['.', '/'], "-")))
    });
    Ok(figures.collect())
}

/// What theory says of a measure in the cells of `scenario`, as curves.
fn theory(table: &FinishedTable, scenario: &Scenario, across: usize, column: usize) -> Vec<Series> {
    let mut curves: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    let mut known = BTreeSet::new();
    for row in 0..table.rows() {
        let settings: Vec<String> = table.settings().map(|setting| table.cell(row, setting).to_owned()).collect();
        if !known.insert(settings) {
            continue;
        }
        let cell = table.settings().try_fold(scenario.clone(), |cell, setting| {
            cell.with(&table.columns()[setting], table.cell(row, setting)).ok()
        });
        let found = cell.and_then(|cell| theory::of(&cell, &table.columns()[column]));
        if let (Some(x), Some(Theory { source, value })) = (table.number(row, across), found) {
            let others = others(table, row, across);
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
fn others(table: &FinishedTable, row: usize, across: usize) -> String {
    let others = table.settings().filter(|&other| other != across);
    let others = others.map(|other| format!("{} {}", short(&table.columns()[other]), table.cell(row, other)));
    others.collect::<Vec<_>>().join(", ")
}

/// The curves of a measure.
fn curves(table: &FinishedTable, title: &str, across: usize, column: usize) -> Curves {
    // By the other settings: each number on the axis, and the measures there.
    let mut curves: BTreeMap<String, Vec<(f64, Vec<f64>)>> = BTreeMap::new();
    for row in 0..table.rows() {
        let (Some(x), Some(y)) = (table.number(row, across), table.number(row, column)) else { continue };
        let points = curves.entry(others(table, row, across)).or_default();
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
    let name = &table.columns()[column];
    let up = table.label(column).unwrap_or(name);
    Curves {
        title: title.to_owned(),
        note: format!("mean of up to {} runs, with 95 % intervals", runs.unwrap_or(0)),
        across: table.columns()[across].clone(),
        up: up.to_owned(),
        series: series.collect(),
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
        let table = FinishedTable::parse(TABLE).unwrap();
        assert_eq!(table.across().map(|column| table.columns()[column].as_str()), Some("b.rate"));
        let column = table.measure("mac.prr").unwrap();
        let curves = curves(&table, "t", table.across().unwrap(), column);
        let points: Vec<_> = curves.series.iter().map(|series| (&*series.name, series.points.clone())).collect();
        assert_eq!(points, [("kind x", vec![(2.5, 0.9), (10.0, 0.6)]), ("kind y", vec![(10.0, 0.25)])]);
        // Two runs: t(0.975; 1) = 12.706 times 0.1414 / sqrt(2).
        assert!((curves.series[0].half_widths[1] - 1.2706).abs() < 1e-3);
        assert!(table.measure("mac.nothing").is_err());
    }
}
