//! A log of one file a stop, with the place of the stop in the name of the file.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use sextant_kernel::text::{counted, listed};

use super::file_names;
use crate::csv::memory_table::{MemoryColumn, MemoryTable};
use crate::csv::table_file::TableFile;
use crate::error::robot_log_error::RobotLogError;
use crate::options::file_template::{FileTemplate, NameCells};

/// The files of the stops in a folder.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StopFiles {
    /// Each with the cells that its name gives.
    pub(crate) files: Vec<TableFile>,
    /// The stops, in the order of the names of their files; `None` if they are in `stops.csv`.
    places: Option<Vec<Vec<(String, String)>>>,
    /// What the user should know.
    pub(crate) note: String,
}

impl StopFiles {
    /// The files of the folder whose names are those of `template`.
    ///
    /// # Errors
    /// If there are none, or a name can be read in several ways.
    pub(crate) fn of(folder: &Path, template: &FileTemplate) -> Result<Self, RobotLogError> {
        let entries = std::fs::read_dir(folder).and_then(|entries| entries.collect::<Result<Vec<_>, _>>());
        let entries = entries.map_err(|why| RobotLogError::read(folder, why))?;
        let mut paths: Vec<PathBuf> =
            entries.iter().map(std::fs::DirEntry::path).filter(|path| path.is_file()).collect();
        paths.sort();
        let refused = |problem: String| RobotLogError::Form { problem };
        let (mut found, mut others) = (Vec::new(), Vec::new());
        for path in paths {
            let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            let cells = template.read(&name).map_err(|ways| {
                refused(format!(
                    "the name `{name}` fits option `stop_files` in several ways: {ways}; allowed: names that fit in one way, by \
                     a sign between the fields, or by the number of their characters, as {{x:1}}{{y:2}}"
                ))
            })?;
            match cells {
                Some(cells) => found.push((path, cells)),
                None => others.push(name),
            }
        }
        if found.is_empty() {
            let names = if others.is_empty() { "no files".to_owned() } else { listed(&others) };
            return Err(refused(format!(
                "option `stop_files` is `{template}`, but no file of `{}` has such a name; found: {names}",
                folder.display()
            )));
        }
        Ok(Self::made(found, &others, template))
    }

    fn made(mut found: Vec<(PathBuf, NameCells)>, others: &[String], template: &FileTemplate) -> Self {
        let number = |cells: &NameCells, column: &str| -> f64 {
            let text = cells.iter().find(|(name, _)| *name == column).map_or("", |(_, text)| text);
            text.parse().unwrap_or(0.0)
        };
        // In the order of the places, and not of the texts: 10 is after 9.
        let keys = ["x_m", "y_m", "z_m", "lat", "lon"];
        found.sort_by(|(_, a), (_, b)| {
            let orders = keys.map(|key| number(a, key).total_cmp(&number(b, key)));
            orders.into_iter().fold(std::cmp::Ordering::Equal, std::cmp::Ordering::then)
        });
        let mut places: BTreeMap<String, usize> = BTreeMap::new();
        let mut rows: Vec<Vec<(String, String)>> = Vec::new();
        let mut files = Vec::new();
        for (path, cells) in found {
            let mut cells: Vec<(String, String)> =
                cells.into_iter().map(|(column, text)| (column.to_owned(), text)).collect();
            if template.has_places() {
                // Two robots may have stood at one place.
                cells.retain(|(column, _)| column != "stop");
                let name = cells.iter().map(|(_, text)| text.as_str()).collect::<Vec<_>>().join(", ");
                cells.insert(0, ("stop".to_owned(), name));
            }
            let name = cells.iter().find(|(column, _)| column == "stop").map_or("", |(_, text)| text);
            if !places.contains_key(name) {
                places.insert(name.to_owned(), rows.len());
                rows.push(cells.clone());
            }
            files.push(TableFile { path, cells });
        }
        let mut note = format!(
            "{} are those of {}, by their names (option `stop_files`)",
            counted(files.len(), "file"),
            counted(rows.len(), "stop")
        );
        let known = [
            file_names::STOPS,
            file_names::CONTACTS,
            file_names::SECTORS,
            file_names::SECTOR_SNRS,
            file_names::ANTENNA,
            file_names::NODES,
            file_names::NAMES,
        ];
        let unread: Vec<&String> = others.iter().filter(|name| !known.contains(&name.as_str())).collect();
        if !unread.is_empty() {
            note +=
                &format!("; {} with other names are not read: {}", counted(unread.len(), "file"), listed(&unread));
        }
        Self { files, places: template.has_places().then_some(rows), note }
    }

    /// The stops as a table; `None` if they are in `stops.csv`.
    pub(crate) fn stops(&self) -> Result<Option<MemoryTable<'static>>, RobotLogError> {
        let Some(rows) = &self.places else { return Ok(None) };
        let columns = rows.first().map_or(&[][..], Vec::as_slice).iter().enumerate();
        let column = |(at, (name, _)): (usize, &(String, String))| {
            (name.clone(), MemoryColumn::texts(rows.iter().map(|row| Some(row[at].1.as_str()))))
        };
        MemoryTable::new("the names of the files", columns.map(column).collect()).map(Some)
    }

    /// The same files with the cells that receptions have: the stop.
    pub(crate) fn of_receptions(&self) -> Vec<TableFile> {
        self.with_cells(|column| column == "stop")
    }

    /// The same files with the cells that wide tables have: the place.
    pub(crate) fn of_scans(&self) -> Vec<TableFile> {
        self.with_cells(|column| column != "stop")
    }

    fn with_cells(&self, keeps: impl Fn(&str) -> bool) -> Vec<TableFile> {
        let kept = |file: &TableFile| TableFile {
            cells: file.cells.iter().filter(|(column, _)| keeps(column)).cloned().collect(),
            ..file.clone()
        };
        self.files.iter().map(kept).collect()
    }
}
