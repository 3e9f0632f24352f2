//! The table of a sweep.

use std::path::Path;

use serde::Serialize;
use sextant::sweep::{FinishedTable, students_t_975};

use super::column::Column;
use super::error::ReportError;

/// The table of a sweep, by columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SweepTable {
    /// Number of rows.
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
    pub label: Option<&'static str>,
    /// The values.
    pub values: SweepValues,
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
    fn of(cells: &[&str]) -> Self {
        let numbers: Vec<Option<f64>> = cells.iter().map(|cell| cell.parse().ok()).collect();
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
        let column = |column: usize| SweepColumn {
            name: table.columns()[column].clone(),
            label: table.label(column),
            values: SweepValues::of(&table.cells(column).collect::<Vec<_>>()),
        };
        let is_filled = |column: &usize| table.cells(*column).any(|cell| !cell.is_empty());
        let failures: Vec<&str> = table.cells(table.error_column()).filter(|cell| !cell.is_empty()).collect();
        let rows = table.rows();
        Ok(Self {
            rows,
            settings: table.settings().map(column).collect(),
            measures: table.measures().filter(is_filled).map(column).collect(),
            failed: failures.len(),
            failure: failures.first().map(|&failure| failure.to_owned()),
            students_t_975: Column::reals((1..rows.max(2)).map(students_t_975)),
            across: table.across().map(|across| across - table.settings().start),
        })
    }
}
