//! The reports of tables: sweeps and reproductions.

use std::collections::BTreeMap;
use std::path::Path;

use sextant_study::sweep::TableError;

use super::document::{DocumentKind, Report};
use super::error::ReportError;
use super::reproduction::{self, Reproduction};
use super::sweep::SweepTable;

impl Report {
    /// A report of a reproduction: a folder of its tables, or one of them. `titles` says what the experiments are about,
    /// by their numbers.
    ///
    /// # Errors
    /// If it cannot be read, or there is no such table.
    pub fn of_reproduction(path: &Path, titles: &BTreeMap<String, String>) -> Result<Self, ReportError> {
        let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
        let name = whole.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let title = if path.is_dir() { name.clone() } else { stem(&whole) };
        let reproduction = Some(Reproduction::read(path, titles)?);
        Ok(Self { reproduction, ..Self::new(DocumentKind::Reproduction, &title, &name) })
    }

    /// A report of the CSV table of a sweep.
    ///
    /// # Errors
    /// If it cannot be read, or is another table.
    pub fn of_sweep(path: &Path) -> Result<Self, ReportError> {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let sweep = Some(SweepTable::read(path)?);
        Ok(Self { sweep, ..Self::new(DocumentKind::Sweep, &stem(path), &name) })
    }

    /// A report of a CSV table: that of a sweep, or one of a reproduction.
    ///
    /// # Errors
    /// If it cannot be read, or is another table.
    pub fn of_table(path: &Path, titles: &BTreeMap<String, String>) -> Result<Self, ReportError> {
        match Self::of_reproduction(path, titles) {
            Err(ReportError::NotATable { columns, path }) => match Self::of_sweep(&path) {
                Err(ReportError::Table(TableError::Other { .. })) => Err(ReportError::NotATable { columns, path }),
                other => other,
            },
            other => other,
        }
    }

    /// Whether `path` is a folder with tables of a reproduction.
    #[must_use]
    pub fn is_reproduction(path: &Path) -> bool {
        path.is_dir() && reproduction::is_reproduction(path)
    }
}

/// The name of a file without its extension.
fn stem(path: &Path) -> String {
    path.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}
