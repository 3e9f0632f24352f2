//! A file of a table: the only one, or one of several that are one table, each with cells that its name gives.

use std::path::{Path, PathBuf};

/// A file of a table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct TableFile {
    pub(crate) path: PathBuf,
    /// Cells of each of its rows that are not in the file: the column and the text.
    pub(crate) cells: Vec<(String, String)>,
}

impl TableFile {
    /// A table of one file.
    pub(crate) fn alone(path: &Path) -> Self {
        Self { path: path.to_owned(), cells: Vec::new() }
    }

    /// The cell that the name of the file gives for a column; empty if it gives none.
    pub(crate) fn cell(&self, column: &str) -> &str {
        self.cells.iter().find(|(name, _)| name == column).map_or("", |(_, text)| text)
    }
}
