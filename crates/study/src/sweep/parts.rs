//! Finished units of a sweep on disk, so that an interrupted sweep can be resumed.

use std::fs::{File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};

use sextant_kernel::text::hexadecimal;
use sextant_recording::ForeignFolder;
use sextant_recording::disk;
use sextant_recording::output::{CsvFile, EmptyCell, FileIdentity, OutputError, write_file, write_unsynced};
use sha2::{Digest, Sha256};

use super::error::SweepError;
use super::row::Row;
use super::work_list::Unit;

/// The folder of the finished units, with one CSV file per unit.
#[derive(Debug)]
pub(super) struct Parts {
    folder: PathBuf,
    /// Locked as long as this process does the sweep.
    _mark: File,
}

/// The file in the folder that identifies the sweep.
const FINGERPRINT: &str = "fingerprint";

/// The most that is read of it, and of a unit (octets).
const LARGEST_MARK: u64 = 1 << 20;
const LARGEST_UNIT: u64 = 1 << 28;

impl Parts {
    /// Opens the folder beside `out` for the sweep with this `fingerprint`.
    pub(super) fn open(out: &Path, fingerprint: &str, resume: bool) -> Result<Self, SweepError> {
        let folder = folder(out);
        let mark = folder.join(FINGERPRINT);
        // Somebody else may have made the folder.
        match ForeignFolder::new(&folder).read_text(&mark, LARGEST_MARK) {
            Ok(found) if found != fingerprint => Err(SweepError::OtherParts { folder }),
            Ok(_) => {
                let locked = Self::lock(&mark, folder)?;
                if resume { Ok(locked) } else { Err(SweepError::Unfinished { folder: locked.folder }) }
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                disk::create_folder(&folder)
                    .or_else(|error| match error.kind() {
                        // A sweep that was killed just after it created the folder left no fingerprint.
                        io::ErrorKind::AlreadyExists => Ok(()),
                        _ => Err(error),
                    })
                    .map_err(|error| OutputError::new(&folder, &error))?;
                match write_file(&mark, fingerprint.as_bytes()) {
                    // Another process has just finished the sweep.
                    Err(_) if !folder.exists() => Err(SweepError::Busy { folder }),
                    written => {
                        written?;
                        Self::lock(&mark, folder)
                    }
                }
            }
            Err(error) => Err(SweepError::Read { path: mark, why: error.to_string() }),
        }
    }

    /// The folder with this `mark`, which no other process has.
    fn lock(mark: &Path, folder: PathBuf) -> Result<Self, SweepError> {
        let file = match File::open(mark) {
            // Another process has just finished the sweep.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Err(SweepError::Busy { folder }),
            opened => opened.map_err(|error| SweepError::Read { path: mark.to_owned(), why: error.to_string() })?,
        };
        // Some file systems have no locks.
        let is_taken = matches!(file.try_lock(), Err(TryLockError::WouldBlock));
        if is_taken || !FileIdentity::is_at(&file, mark).unwrap_or(false) {
            return Err(SweepError::Busy { folder });
        }
        Ok(Self { folder, _mark: file })
    }

    fn path(&self, unit: usize) -> PathBuf {
        self.folder.join(format!("{unit:07}.csv"))
    }

    /// The rows of a unit, each with this many `measures`; `None` if the unit is not finished, or the power failed before all of
    /// it was on the disk.
    pub(super) fn read(&self, unit: &Unit, measures: usize) -> Result<Option<Vec<Row>>, SweepError> {
        let path = self.path(unit.index);
        let text = match ForeignFolder::new(&self.folder).read_text(&path, LARGEST_UNIT) {
            Ok(text) => text,
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(SweepError::Read { path, why: error.to_string() }),
        };
        let Some(text) = checked(&text) else { return Ok(None) };
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let rows: Option<Vec<Row>> = reader.records().map(|record| Row::parse(&record.ok()?, measures)).collect();
        let is_of_unit = |rows: &Vec<Row>| {
            rows.iter().map(|row| row.cell).eq(unit.cells.iter().copied())
                && rows.iter().all(|row| row.replicate == unit.replicate)
        };
        rows.filter(is_of_unit).map(Some).ok_or(SweepError::Part { path })
    }

    /// Writes the rows of a finished unit. It does not wait for the disk, which would take longer than many units.
    pub(super) fn write(&self, unit: usize, rows: &[Row]) -> Result<(), SweepError> {
        let mut file = CsvFile::headless(EmptyCell::Bare);
        rows.iter().for_each(|row| file.row(row.record()));
        let rows = file.take();
        let text = [checksum(&rows).as_bytes(), b"\n", &rows].concat();
        Ok(write_unsynced(&self.path(unit), &text)?)
    }
}

/// What the first line of a unit says of the `rows` below it.
fn checksum(rows: &[u8]) -> String {
    hexadecimal(&Sha256::digest(rows))
}

/// The rows of the unit `text`, if all are there.
fn checked(text: &str) -> Option<&str> {
    let (first, rows) = text.split_once('\n')?;
    (first == checksum(rows.as_bytes())).then_some(rows)
}

/// Removes the folder beside `out`. What another process begins there at the same moment stays.
pub(super) fn remove(out: &Path) -> Result<(), SweepError> {
    let folder = folder(out);
    match disk::remove_folder(&folder) {
        Err(error) if error.kind() == io::ErrorKind::DirectoryNotEmpty => Ok(()),
        removed => Ok(removed.map_err(|error| OutputError::new(&folder, &error))?),
    }
}

fn folder(out: &Path) -> PathBuf {
    let mut folder = out.as_os_str().to_owned();
    folder.push(".parts");
    PathBuf::from(folder)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finished_unit_is_read_back_only_by_its_own_sweep() {
        let folder = tempfile::tempdir().unwrap();
        let out = folder.path().join("table.csv");
        let rows = vec![
            Row { cell: 2, replicate: 1, outcome: Ok(vec![Some(0.1 + 0.2), None, Some(12.0)]) },
            Row { cell: 3, replicate: 1, outcome: Err("a \"b\",\nc".into()) },
        ];
        let unit = Unit { index: 7, replicate: 1, cells: vec![2, 3] };
        let parts = Parts::open(&out, "this", false).unwrap();
        assert_eq!(parts.read(&unit, 3).unwrap(), None);
        parts.write(7, &rows).unwrap();
        assert!(matches!(Parts::open(&out, "this", true), Err(SweepError::Busy { .. })), "another process has it");
        assert!(matches!(Parts::open(&out, "other", true), Err(SweepError::OtherParts { .. })));
        assert!(matches!(parts.read(&unit, 4), Err(SweepError::Part { .. })), "a row of another length is invalid");
        for other in [Unit { cells: vec![3, 2], ..unit.clone() }, Unit { replicate: 0, ..unit.clone() }] {
            assert!(
                matches!(parts.read(&other, 3), Err(SweepError::Part { .. })),
                "rows of another unit are invalid"
            );
        }
        drop(parts);
        assert!(matches!(Parts::open(&out, "this", false), Err(SweepError::Unfinished { .. })));
        assert_eq!(Parts::open(&out, "this", true).unwrap().read(&unit, 3).unwrap(), Some(rows));
        remove(&out).unwrap();
        assert!(!super::folder(&out).exists());
    }
}
