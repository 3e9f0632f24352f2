//! Rows of CSV files, for errors: their lines, and what is wrong with them.

use sextant_kernel::text::shortened;

/// The line of a row, from 1. The reader's own count stops at the blank lines and comments before the row.
#[must_use]
pub fn line_of(text: &str, position: Option<&csv::Position>) -> u64 {
    let byte = position.and_then(|position| usize::try_from(position.byte()).ok()).unwrap_or(0);
    let (before, after) = text.split_at_checked(byte).unwrap_or((text, ""));
    let skipped = after.lines().take_while(|line| line.is_empty() || line.starts_with('#')).count();
    (before.matches('\n').count() + skipped + 1) as u64
}

/// What is wrong with a row that cannot be read.
#[must_use]
pub fn row_fault(error: &csv::Error) -> String {
    match error.kind() {
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
            format!("{len} cells for {expected_len} columns")
        }
        _ => error.to_string(),
    }
}

/// What is wrong with a cell: its column and its text.
#[must_use]
pub fn cell_fault(error: &csv::Error, header: &csv::StringRecord, record: &csv::StringRecord) -> String {
    let csv::ErrorKind::Deserialize { err, .. } = error.kind() else { return error.to_string() };
    let Some(field) = err.field().and_then(|field| usize::try_from(field).ok()) else { return err.to_string() };
    match (header.get(field), record.get(field)) {
        (Some(column), Some(cell)) => format!("`{}` in the column `{}`", shortened(cell), shortened(column)),
        _ => err.to_string(),
    }
}
