//! The result of one run of one cell.

use std::ops::Range;

use serde_json::Number;
use sextant_kernel::text::of_cell;
use sextant_recording::output::{CsvFile, EmptyCell};

use super::column::ColumnKind;
use super::work_list::CellRun;

/// One run of one cell.
#[derive(Clone, Debug, PartialEq)]
pub struct RunRow {
    /// Number of the cell, from 0.
    pub cell: usize,
    /// Number of the run, from 0.
    pub replicate: u32,
    /// The values of all measures of the plan, `None` where one does not apply; or why the run failed.
    pub outcome: Result<Vec<Option<f64>>, String>,
}

impl RunRow {
    /// Which run it is of.
    pub(crate) fn run(&self) -> CellRun {
        CellRun { cell: self.cell, replicate: self.replicate }
    }

    /// Whether all its values are finite.
    pub(super) fn is_finite(&self) -> bool {
        self.outcome.as_ref().map_or(true, |values| values.iter().flatten().all(|value| value.is_finite()))
    }

    /// Its fields in a file of finished runs: cell, replicate, error, then the values with all their digits.
    fn record(&self) -> Vec<String> {
        let (error, values) = match &self.outcome {
            Ok(values) => (String::new(), values.as_slice()),
            Err(error) => (error.clone(), [].as_slice()),
        };
        let values = values.iter().map(|value| value.map_or_else(String::new, |value| format!("{value:?}")));
        [self.cell.to_string(), self.replicate.to_string(), error].into_iter().chain(values).collect()
    }

    /// The row of a [`record`](Self::record) with this many `measures`; `None` if the record is invalid.
    fn parse(record: &csv::StringRecord, measures: usize) -> Option<Self> {
        let value = |text: &str| if text.is_empty() { Some(None) } else { text.parse().ok().map(Some) };
        let mut values = Vec::with_capacity(measures);
        for text in record.iter().skip(3) {
            values.push(value(text)?);
        }
        let outcome = match record.get(2)? {
            "" if values.len() == measures => Ok(values),
            "" => return None,
            error => Err(of_cell(error).to_owned()),
        };
        Some(Self { cell: record.get(0)?.parse().ok()?, replicate: record.get(1)?.parse().ok()?, outcome })
    }
}

/// Rows as they stand in a file of finished runs.
pub(super) fn text<'r>(rows: impl IntoIterator<Item = &'r RunRow>) -> Vec<u8> {
    let mut file = CsvFile::headless(EmptyCell::Bare);
    rows.into_iter().for_each(|row| file.row(row.record()));
    file.take()
}

/// The rows in such a text, each with its place there; `None` for what is no row of a plan with so many `measures`.
pub(super) fn parsed(text: &[u8], measures: usize) -> impl Iterator<Item = Option<(RunRow, Range<usize>)>> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .buffer_capacity(text.len().clamp(1, BUFFER))
        .from_reader(text);
    let mut record = csv::StringRecord::new();
    std::iter::from_fn(move || {
        let start = usize::try_from(reader.position().byte()).ok()?;
        match reader.read_record(&mut record) {
            Ok(false) => None,
            Ok(true) => {
                let end = usize::try_from(reader.position().byte()).ok()?;
                Some(RunRow::parse(&record, measures).map(|row| (row, start..end)))
            }
            Err(_) => Some(None),
        }
    })
}

/// What is read at once (octets).
const BUFFER: usize = 1 << 13;

/// A number as written in a table: an integer without a decimal point, any other number with as many digits as it takes
/// to read the same number back.
pub(super) fn written(value: f64, kind: ColumnKind) -> String {
    match (kind, Number::from_f64(value)) {
        (ColumnKind::Real, Some(number)) => number.to_string(),
        _ => value.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_row_of_a_text_has_its_place() {
        let rows = [
            RunRow { cell: 3, replicate: 0, outcome: Ok(vec![Some(0.1), None]) },
            RunRow { cell: 3, replicate: 1, outcome: Err("a \"b\",\nc".into()) },
            RunRow { cell: 4, replicate: 0, outcome: Ok(vec![None, Some(-2e9)]) },
        ];
        let all = text(&rows);
        let found: Vec<(RunRow, Range<usize>)> = parsed(&all, 2).map(Option::unwrap).collect();
        assert_eq!(found.iter().map(|(row, _)| row.clone()).collect::<Vec<_>>(), rows);
        for (row, place) in found {
            assert_eq!(all[place], text([&row]));
        }
        assert_eq!(parsed(b"1,2,,0.5\n", 2).collect::<Vec<_>>(), [None]);
    }

    #[test]
    fn numbers_read_back_equal() {
        assert_eq!(written(12.0, ColumnKind::Integer), "12");
        assert_eq!(written(1e15, ColumnKind::Integer), "1000000000000000");
        assert_eq!(written(1.0, ColumnKind::Real), "1.0");
        for value in [0.1 + 0.2, 1e-7, 2.5e-5, f64::MIN_POSITIVE, 1e300] {
            assert_eq!(written(value, ColumnKind::Real).parse(), Ok(value));
        }
    }
}
