//! The tables of a recording.

use sextant::recording::{Cell, CellKind, TableColumn, TablePiece, TableRow};

use crate::table::{Columns, Table};
use pyo3::PyResult;

/// A table that gets rows.
pub(crate) struct Growing {
    columns: Vec<TableColumn>,
    cells: Vec<Vec<Cell>>,
}

impl Growing {
    fn new(columns: &[TableColumn]) -> Self {
        Self { columns: columns.to_vec(), cells: vec![Vec::new(); columns.len()] }
    }

    fn push(&mut self, row: &TableRow<'_>) {
        for (column, cell) in self.cells.iter_mut().zip(row.cells) {
            column.push(cell.clone());
        }
    }

    /// The whole table.
    pub(crate) fn finish(self) -> PyResult<Table> {
        let mut made = Columns::default();
        for (TableColumn { name, kind }, cells) in self.columns.into_iter().zip(self.cells) {
            made = match kind {
                CellKind::Integer => made.optional_whole(&name, cells.iter().map(whole)),
                CellKind::Real => made.optional_numbers(&name, cells.iter().map(Cell::real)),
                CellKind::Text => made.optional_texts(&name, cells.into_iter().map(text)),
            };
        }
        made.table()
    }
}

fn whole(cell: &Cell) -> Option<i64> {
    match cell {
        Cell::Integer(number) => Some(*number),
        Cell::Nanos(nanos) => i64::try_from(*nanos).ok(),
        Cell::Missing | Cell::Real(_) | Cell::Text(_) => None,
    }
}

fn text(cell: Cell) -> Option<String> {
    match cell {
        Cell::Text(text) => Some(text),
        Cell::Missing => None,
        other => Some(other.to_string()),
    }
}

/// Adds a row to its table. Files within the recording are no tables.
pub(crate) fn take(tables: &mut Vec<(String, Growing)>, piece: &TablePiece<'_>) {
    let TablePiece::Row(row) = piece else { return };
    let at = tables.iter().rposition(|(name, _)| name == row.table).unwrap_or_else(|| {
        tables.push((row.table.to_owned(), Growing::new(row.columns)));
        tables.len() - 1
    });
    tables[at].1.push(row);
}
