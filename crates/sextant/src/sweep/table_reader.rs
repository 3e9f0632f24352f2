//! The rows of a sweep, read back from its table.

use std::path::Path;

use super::error::TableError;
use super::plan::Sweep;
use super::row::Row;

/// Reads the rows of the CSV table at `path`, which [`write_table`](super::write_table) wrote for a sweep with the cells and
/// columns of `plan`, with any number of runs.
///
/// # Errors
/// If the file cannot be read, or is the table of another sweep.
pub fn read_table(path: &Path, plan: &Sweep) -> Result<Vec<Row>, TableError> {
    let unreadable =
        |error: &dyn std::fmt::Display| TableError::Read { path: path.to_owned(), why: error.to_string() };
    let other = |why: String| TableError::Other { path: path.to_owned(), why };
    let mut reader = csv::Reader::from_path(path).map_err(|error| unreadable(&error))?;
    let columns = plan.columns();
    let header = reader.headers().map_err(|error| unreadable(&error))?;
    if let Some(column) = columns.iter().zip(header).find_map(|(own, found)| (own.name != found).then_some(own)) {
        return Err(other(format!("it has no column `{}` where this scenario has one", column.name)));
    }
    if header.len() != columns.len() {
        return Err(other(format!("it has {} columns; this scenario has {}", header.len(), columns.len())));
    }
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| unreadable(&error))?;
        let line = record.position().map_or(0, csv::Position::line);
        rows.push(row(&record, plan).ok_or_else(|| other(format!("line {line} is no row of this scenario")))?);
    }
    Ok(rows)
}

/// The row of a record: cell, replicate, seed, settings, error, values.
fn row(record: &csv::StringRecord, plan: &Sweep) -> Option<Row> {
    let (cell, replicate): (usize, u32) = (record.get(0)?.parse().ok()?, record.get(1)?.parse().ok()?);
    let has_settings = cell < plan.cells().len()
        && plan.values(cell).iter().eq(record.iter().skip(IDENTITY).take(plan.keys().len()));
    let has_seed = record.get(2)?.parse() == Ok(plan.seed_of(replicate));
    if !(has_settings && has_seed) {
        return None;
    }
    let error = IDENTITY + plan.keys().len();
    let value = |text: &str| if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) };
    let outcome = match record.get(error)? {
        "" => Ok(record.iter().skip(error + 1).map(value).collect::<Option<Vec<Option<f64>>>>()?),
        error => Err(error.to_owned()),
    };
    Some(Row { cell, replicate, outcome })
}

/// Columns before the settings.
const IDENTITY: usize = 3;

#[cfg(test)]
mod tests {
    use std::num::NonZeroU32;

    use super::*;
    use crate::sweep::write_table;

    #[test]
    fn rows_are_read_back_only_by_a_sweep_with_the_same_cells_and_columns() {
        let folder = tempfile::tempdir().unwrap();
        let scenario = folder.path().join("s.toml");
        let plan = |axis: &str| {
            let smoke = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scenarios/smoke.toml");
            let text = format!("extends = {smoke:?}\n[sweep]\nruns = 2\n[sweep.product]\n{axis}\n");
            std::fs::write(&scenario, text).unwrap();
            Sweep::read(&scenario, &[], None, NonZeroU32::new(2)).unwrap()
        };
        let two = plan("maps.0.algorithm.ml_tm.grid_step_m = [0.5, 1.0]");
        let values =
            |seed: f64| two.measures().iter().enumerate().map(|(i, _)| (i % 2 == 0).then_some(seed)).collect();
        let rows = vec![
            Row { cell: 0, replicate: 0, outcome: Ok(values(3.0)) },
            Row { cell: 1, replicate: 1, outcome: Err("a, \"b\"".into()) },
        ];
        let table = folder.path().join("t.csv");
        write_table(&table, &two, &rows).unwrap();
        assert_eq!(read_table(&table, &two).unwrap(), rows);
        for axis in ["maps.0.algorithm.ml_tm.grid_step_m = [0.5, 2.0]", "channel.max_range_m = [9.0, 10.0]"] {
            assert!(matches!(read_table(&table, &plan(axis)), Err(TableError::Other { .. })), "{axis}");
        }
        assert!(matches!(read_table(&folder.path().join("u.csv"), &two), Err(TableError::Read { .. })));
    }
}
