//! The table of a sweep.

use std::path::Path;

use serde::Serialize;
use sextant::summary::Unit;
use sextant_study::sweep::{FinishedTable, exact_number, students_t_975};

use super::column::Column;
use super::error::ReportError;

/// The table of a sweep, by columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepTable {
    /// Number of runs: each is a row.
    pub rows: usize,
    /// The settings that vary.
    pub settings: Vec<SweepColumn>,
    /// The results.
    pub measures: Vec<SweepColumn>,
    /// Rows whose run failed.
    pub failed: usize,
    /// Why the first of them failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failure: Option<String>,
    /// 97.5 % quantiles of Student's t distribution with 1, 2, .. degrees of freedom.
    pub students_t_975: Column,
    /// The setting that is drawn across at first, as its number among the settings.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub across: Option<usize>,
}

/// A column of the table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepColumn {
    /// Its name.
    pub name: String,
    /// What it is called on an axis, if it is one of the usual measures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// The map and the measure of it, if it is one of several maps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub of_map: Option<MeasureOfMap>,
    /// Whether it is 1 or 0 a run: its interval is that of a share.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub is_outcome: bool,
    /// The values.
    pub values: SweepValues,
}

/// A measure that several maps have.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasureOfMap {
    /// The map.
    pub map: String,
    /// The measure, by its name in the table.
    pub measure: String,
    /// What the measure is called on an axis, if it is one of the usual ones.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
}

/// The values of a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum SweepValues {
    /// Numbers; NaN where there is none.
    Numbers(Column),
    /// Texts: the different ones, and which of them each row has.
    Texts {
        /// The different ones, in the order of their first row.
        words: Vec<String>,
        /// The text of each row.
        rows: Column,
    },
}

impl SweepValues {
    /// Whether no row has a value.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Numbers(numbers) => numbers.to_vec().iter().all(|number| number.is_nan()),
            Self::Texts { words, .. } => words.iter().all(String::is_empty),
        }
    }

    fn of(cells: &[&str]) -> Self {
        let numbers: Vec<Option<f64>> = cells.iter().map(|cell| exact_number(cell)).collect();
        let are_numbers = cells.iter().zip(&numbers).all(|(cell, number)| cell.is_empty() || number.is_some());
        if are_numbers {
            return Self::Numbers(Column::F64(numbers.into_iter().map(|cell| cell.unwrap_or(f64::NAN)).collect()));
        }
        let mut words: Vec<String> = Vec::new();
        let mut rows = Vec::new();
        for cell in cells {
            let word = words.iter().position(|word| word == cell).unwrap_or_else(|| {
                words.push((*cell).to_owned());
                words.len() - 1
            });
            rows.push(u32::try_from(word).unwrap_or(u32::MAX));
        }
        Self::Texts { words, rows: Column::U32(rows) }
    }
}

impl SweepTable {
    /// Reads the CSV table of a sweep.
    ///
    /// # Errors
    /// If it cannot be read, or is another table.
    pub(super) fn read(path: &Path) -> Result<Self, ReportError> {
        let table = FinishedTable::read(path)?;
        let runs = table.runs();
        let values = |cells: Vec<&str>| SweepValues::of(&cells);
        let setting = |column: usize| SweepColumn {
            name: table.columns()[column].clone(),
            label: None,
            of_map: None,
            is_outcome: false,
            values: values(runs.iter().map(|&run| table.cell(run, column)).collect()),
        };
        let mut measures = Vec::new();
        for column in table.measures() {
            let name = &table.columns()[column];
            let is_outcome = table.known(column).is_some_and(|measure| measure.unit() == Unit::Outcome);
            let label = table.known(column).filter(|_| table.is_usual(column)).map(|measure| measure.label());
            if !table.is_of_maps(column) {
                let cells = runs.iter().map(|&run| table.cell(run, column)).collect();
                measures.push(SweepColumn {
                    name: name.clone(),
                    label,
                    of_map: None,
                    is_outcome,
                    values: values(cells),
                });
                continue;
            }
            // A row of the report is a run, so that a measure of maps has a column for each of them.
            for map in table.maps() {
                let cell = |&run: &usize| table.row_of(run, map).map_or("", |row| table.cell(row, column));
                let own = label.as_ref().map(|label| match table.maps() {
                    [_] => label.clone(),
                    _ => format!("{map}: {label}"),
                });
                let of_map = (table.maps().len() > 1).then(|| MeasureOfMap {
                    map: map.to_string(),
                    measure: name.clone(),
                    label: label.clone(),
                });
                let cells = runs.iter().map(cell).collect();
                let name = format!("{map}.{name}");
                measures.push(SweepColumn { name, label: own, of_map, is_outcome, values: values(cells) });
            }
        }
        measures.retain(|column| !column.values.is_empty());
        let errors = runs.iter().map(|&run| table.cell(run, table.error_column()));
        let failures: Vec<&str> = errors.filter(|error| !error.is_empty()).collect();
        Ok(Self {
            rows: runs.len(),
            settings: table.settings().map(setting).collect(),
            measures,
            failed: failures.len(),
            failure: failures.first().map(|&failure| failure.to_owned()),
            students_t_975: Column::reals((1..runs.len().max(2)).map(students_t_975)),
            across: table.across().map(|across| across - table.settings().start),
        })
    }
}
