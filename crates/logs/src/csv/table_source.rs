//! What a table is read from.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::memory_table::MemoryTable;
use super::table_file::TableFile;
use crate::error::log_part::LogPart;

/// What a table is read from.
#[derive(Clone, Debug)]
pub(crate) enum TableSource<'a> {
    /// A CSV file.
    File(Cow<'a, Path>),
    /// CSV files that are one table.
    Files(Vec<TableFile>),
    /// A table in memory.
    Memory(&'a MemoryTable<'a>),
}

impl TableSource<'_> {
    /// The part of the log that it is.
    pub(crate) fn part(&self) -> LogPart {
        match self {
            Self::File(path) => LogPart::File(path.clone().into_owned()),
            Self::Files(files) => LogPart::File(files.first().map(|file| file.path.clone()).unwrap_or_default()),
            Self::Memory(table) => LogPart::Table(table.name().to_owned()),
        }
    }
}

impl<'a> From<&'a Path> for TableSource<'a> {
    fn from(path: &'a Path) -> Self {
        Self::File(path.into())
    }
}

impl From<PathBuf> for TableSource<'_> {
    fn from(path: PathBuf) -> Self {
        Self::File(path.into())
    }
}

impl<'a> From<&'a MemoryTable<'a>> for TableSource<'a> {
    fn from(table: &'a MemoryTable<'a>) -> Self {
        Self::Memory(table)
    }
}
