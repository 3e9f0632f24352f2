//! The tidy form of the rows of a sweep: one row for each cell, seed and map. A run without maps, and one that failed, has
//! one row without a map.

use super::column::{Column, ColumnKind};
use super::error::TableError;
use super::plan::Sweep;
use super::row::{RunRow, written};
use super::rows::{Overview, Rows};

/// The columns before the settings.
pub(super) const IDENTITY: [&str; 3] = ["cell", "replicate", "seed"];
/// The column of the name of the map; it follows the settings.
pub(super) const MAP: &str = "map";
/// The column that says why a run failed; it follows the map.
pub(super) const ERROR: &str = "error";
/// The last column: which sweep the row is of.
pub(super) const SWEEP: &str = "sweep";

/// How many letters of the identity of a sweep are written in each row.
const IDENTITY_LETTERS: usize = 16;

impl Sweep {
    /// The columns that its table may have: cell, replicate, seed, the settings that vary, map, error, the measures of the
    /// run and of its applications, those of the map, and the mark of the sweep. Measures without any value have no column
    /// in the file.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        framed(self, measured(self).into_iter().map(|measured| measured.column))
    }

    /// What the last column of its rows says: which sweep they are of. It is the same for any number of runs.
    #[must_use]
    pub fn mark(&self) -> &str {
        let identity = self.identity();
        identity.get(..IDENTITY_LETTERS).unwrap_or(identity)
    }
}

/// A column of measures: one measure of the run, or one of each map that has it.
pub(super) struct Measured {
    pub(super) column: Column,
    /// By name of the map, or nothing for a measure of the run: its number among the measures of the plan.
    of: Vec<(Option<String>, usize)>,
}

impl Measured {
    /// The number of the measure in a row of a map.
    pub(super) fn measure(&self, map: &str) -> Option<usize> {
        let is_of = |of: &Option<String>| of.as_deref().is_none_or(|of| of == map);
        self.of.iter().find(|(of, _)| is_of(of)).map(|(_, measure)| *measure)
    }

    /// The number of one of its measures.
    pub(super) fn any(&self) -> Option<usize> {
        self.of.first().map(|(_, measure)| *measure)
    }

    /// Whether it has one measure of the whole run.
    pub(super) fn is_of_run(&self) -> bool {
        self.of.iter().any(|(of, _)| of.is_none())
    }
}

/// The columns of all measures of a plan: those of the run and of its applications before those of maps.
pub(super) fn measured(plan: &Sweep) -> Vec<Measured> {
    let mut columns: Vec<Measured> = Vec::new();
    let (of_maps, of_runs): (Vec<_>, Vec<_>) =
        plan.measures().iter().enumerate().partition(|(_, measure)| measure.map().is_some());
    for (i, measure) in of_runs.into_iter().chain(of_maps) {
        let of = (measure.map().map(str::to_owned), i);
        let column = Column::from(measure);
        match columns.iter_mut().find(|known| known.column == column && !known.is_of_run()) {
            Some(known) => known.of.push(of),
            None => columns.push(Measured { column, of: vec![of] }),
        }
    }
    columns
}

/// The columns of measures with those before and after them.
fn framed(plan: &Sweep, measures: impl Iterator<Item = Column>) -> Vec<Column> {
    let [cell, replicate] = [IDENTITY[0], IDENTITY[1]].map(|name| Column::new(name, ColumnKind::Integer));
    let identity = [cell, replicate, Column::new(IDENTITY[2], ColumnKind::Unsigned)];
    let [map, error, mark] = [MAP, ERROR, SWEEP].map(|name| Column::new(name, ColumnKind::Text));
    identity.into_iter().chain(plan.keys().to_vec()).chain([map, error]).chain(measures).chain([mark]).collect()
}

/// The table of `rows`, one row for each cell, run and map: its columns, without measures that have no value, and its texts, which
/// are made one row after the other. A cell without a value is empty.
pub(super) fn table(
    plan: &Sweep,
    rows: &dyn Rows,
) -> (Vec<Column>, impl Iterator<Item = Result<Vec<String>, TableError>>) {
    let Overview { has_value, .. } = rows.overview();
    let is_there = |measured: &Measured| measured.of.iter().any(|(_, i)| has_value.get(*i) == Some(&true));
    let measured: Vec<_> = measured(plan).into_iter().filter(is_there).collect();
    let columns = framed(plan, measured.iter().map(|measured| measured.column.clone()));
    let texts = move |row: Result<RunRow, TableError>| match row {
        Ok(row) => texts(plan, &measured, &row).into_iter().map(Ok).collect(),
        Err(error) => vec![Err(error)],
    };
    (columns, rows.read().flat_map(texts))
}

/// The rows of a run in the table.
fn texts(plan: &Sweep, measured: &[Measured], row: &RunRow) -> Vec<Vec<String>> {
    let head = [row.cell.to_string(), row.replicate.to_string(), plan.seed_of(row.replicate).to_string()];
    let head: Vec<String> = head.into_iter().chain(plan.values(row.cell)).collect();
    let (error, values) = match &row.outcome {
        Ok(values) => ("", values.as_slice()),
        Err(error) => (error.as_str(), [].as_slice()),
    };
    let of_map = |map: &str| {
        let value = |measured: &Measured| {
            let value = measured.measure(map).and_then(|measure| values.get(measure).copied().flatten());
            value.map_or_else(String::new, |value| written(value, measured.column.kind))
        };
        let names = [map.to_owned(), error.to_owned()];
        head.iter().cloned().chain(names).chain(measured.iter().map(value)).chain([plan.mark().to_owned()]).collect()
    };
    maps(plan, values).into_iter().map(of_map).collect()
}

/// The maps of a run with these values; one without a name if it has none.
fn maps<'a>(plan: &'a Sweep, values: &[Option<f64>]) -> Vec<&'a str> {
    let has = |map: &str| {
        let mut measures = plan.measures().iter().zip(values);
        measures.any(|(measure, value)| value.is_some() && measure.map() == Some(map))
    };
    let maps: Vec<_> = plan.maps().iter().map(String::as_str).filter(|map| has(map)).collect();
    if maps.is_empty() { vec![""] } else { maps }
}
