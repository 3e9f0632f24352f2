//! What is done of a plan: files of finished runs.
//!
//! A part `A-B.csv` has the rows of the runs A to B - 1. What is done of a part that is not finished is in
//! `A-B.unfinished-N.csv`; N is another one for each process that does the part, so that no file has two writers.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use sextant::NumberRange;
use sextant_recording::ForeignFolder;
use sextant_recording::disk::{self, DiskFile};
use sextant_recording::output::{CsvFile, EmptyCell, OutputError, PartFile};

use super::error::CampaignError;
use crate::sweep::{CellRun, Row, Sweep};

/// Begins the first line of a part.
const MARK: &str = "sextant-part-1";

/// The most that is read of a part (octets): that of a table.
const LARGEST_PART: u64 = 1 << 30;

/// The folder of the parts of a plan.
#[derive(Debug)]
pub(super) struct Parts<'a> {
    sweep: &'a Sweep,
    /// The plan, whose files somebody else may have written.
    plan: ForeignFolder,
    folder: PathBuf,
}

/// The name of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Name {
    range: NumberRange,
    /// The number of the process, unless the part is finished.
    unfinished: Option<u32>,
}

/// When a part was written, and how long the work on it took.
#[derive(Clone, Copy, Debug)]
pub(super) struct Written {
    pub(super) at: SystemTime,
    pub(super) wall_s: f64,
}

/// The rows of some parts.
#[derive(Debug)]
pub(super) struct Done {
    /// By number in the work list. A run that succeeded in any part has succeeded.
    rows: BTreeMap<usize, Row>,
    whole: Vec<NumberRange>,
    unfinished: Vec<PathBuf>,
    pub(super) written: Vec<Written>,
}

/// A part that is being done.
#[derive(Debug)]
pub(super) struct Part<'a> {
    sweep: &'a Sweep,
    range: NumberRange,
    rows: BTreeMap<usize, Row>,
    /// The file of this process.
    own: PathBuf,
    whole: PathBuf,
}

impl Name {
    /// Numbers are padded, so that a listing is in their order.
    fn text(self) -> String {
        let NumberRange { start, end } = self.range;
        let unfinished = self.unfinished.map_or_else(String::new, |number| format!(".unfinished-{number:03}"));
        format!("{start:09}-{end:09}{unfinished}.csv")
    }

    fn parse(text: &str) -> Option<Self> {
        let stem = text.strip_suffix(".csv")?;
        let (numbers, unfinished) = match stem.split_once(".unfinished-") {
            Some((numbers, number)) => (numbers, Some(number.parse().ok()?)),
            None => (stem, None),
        };
        let (start, end) = numbers.split_once('-')?;
        let range = NumberRange { start: start.parse().ok()?, end: end.parse().ok()? };
        (!range.is_empty()).then_some(Self { range, unfinished })
    }
}

impl<'a> Parts<'a> {
    pub(super) fn of(sweep: &'a Sweep, plan: ForeignFolder, folder: PathBuf) -> Self {
        Self { sweep, plan, folder }
    }

    /// All that is done.
    pub(super) fn read(&self) -> Result<Done, CampaignError> {
        self.read_where(|_| true)
    }

    /// What is done of the runs in `range`.
    pub(super) fn read_within(&self, range: NumberRange) -> Result<Done, CampaignError> {
        let mut done = self.read_where(|other| other.start < range.end && range.start < other.end)?;
        done.rows.retain(|number, _| range.has(*number));
        done.unfinished.retain(|path| name_of(path).is_some_and(|name| name.range == range));
        Ok(done)
    }

    fn read_where(&self, wanted: impl Fn(NumberRange) -> bool) -> Result<Done, CampaignError> {
        let unreadable = |error: io::Error| CampaignError::unreadable(&self.folder, &error);
        let mut done = Done { rows: BTreeMap::new(), whole: Vec::new(), unfinished: Vec::new(), written: Vec::new() };
        for path in self.plan.entries(&self.folder).map_err(unreadable)? {
            match name_of(&path) {
                Some(name) if wanted(name.range) => self.read_part(&path, name, &mut done)?,
                // Another process writes it now.
                None if path.extension().is_some_and(|extension| extension == "part") => {}
                None => {
                    let why = "parts are called A-B.csv".to_owned();
                    return Err(CampaignError::Part { path, why });
                }
                Some(_) => {}
            }
        }
        Ok(done)
    }

    fn read_part(&self, path: &Path, name: Name, done: &mut Done) -> Result<(), CampaignError> {
        let invalid = |why: String| CampaignError::Part { path: path.to_owned(), why };
        let text = match self.plan.read_text(path, LARGEST_PART) {
            // Its process has just finished it.
            Err(error) if error.kind() == io::ErrorKind::NotFound && name.unfinished.is_some() => return Ok(()),
            other => other.map_err(|error| CampaignError::unreadable(path, &error))?,
        };
        if name.unfinished.is_some() {
            done.unfinished.push(path.to_owned());
            if text.is_empty() {
                return Ok(());
            }
        }
        let mut reader = csv::ReaderBuilder::new().has_headers(false).flexible(true).from_reader(text.as_bytes());
        let mut records = reader.records();
        let mark = records.next().and_then(Result::ok).unwrap_or_default();
        let (Some(MARK), Some(fingerprint), Some(wall_s)) = (mark.get(0), mark.get(1), mark.get(2)) else {
            return Err(invalid(format!("its first line is not `{MARK}` and the plan")));
        };
        if fingerprint != self.sweep.fingerprint() {
            return Err(CampaignError::OtherPart { path: path.to_owned() });
        }
        let measures = self.sweep.measures().len();
        let mut numbers = BTreeSet::new();
        for record in records {
            let row = record.ok().and_then(|record| Row::parse(&record, measures));
            let row = row.ok_or_else(|| invalid(format!("line {} is no row of the plan", numbers.len() + 2)))?;
            let run = CellRun { cell: row.cell, replicate: row.replicate };
            let number = self.sweep.work().number_of(run).filter(|number| name.range.has(*number));
            let number =
                number.ok_or_else(|| invalid(format!("line {} is of a run outside it", numbers.len() + 2)))?;
            if !numbers.insert(number) {
                return Err(invalid(format!("line {} is of a run that it has before", numbers.len() + 2)));
            }
            done.add(number, row);
        }
        if name.unfinished.is_none() {
            if numbers.len() != name.range.len() {
                return Err(invalid(format!("it has {} rows, not {}", numbers.len(), name.range.len())));
            }
            done.whole.push(name.range);
        }
        if let Ok(at) = fs::metadata(path).and_then(|data| data.modified()) {
            done.written.push(Written {
                at,
                wall_s: wall_s
                    .parse()
                    .ok()
                    .filter(|wall_s: &f64| wall_s.is_finite() && *wall_s >= 0.0)
                    .unwrap_or(0.0),
            });
        }
        Ok(())
    }

    /// Begins the part `range`, of which the rows `before` are finished.
    pub(super) fn begin(&self, range: NumberRange, before: BTreeMap<usize, Row>) -> Result<Part<'a>, CampaignError> {
        let mut number = 1;
        let own = loop {
            let path = self.folder.join(Name { range, unfinished: Some(number) }.text());
            match DiskFile::create_new(&path) {
                Ok(_) => break path,
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => number += 1,
                Err(error) => return Err(OutputError::new(&path, &error).into()),
            }
        };
        let whole = self.folder.join(Name { range, unfinished: None }.text());
        Ok(Part { sweep: self.sweep, range, rows: before, own, whole })
    }
}

fn name_of(path: &Path) -> Option<Name> {
    Name::parse(path.file_name()?.to_str()?)
}

impl Done {
    fn add(&mut self, number: usize, row: Row) {
        let known = self.rows.entry(number).or_insert_with(|| row.clone());
        if known.outcome.is_err() && row.outcome.is_ok() {
            *known = row;
        }
    }

    /// Whether a run succeeded.
    pub(super) fn is_done(&self, number: usize) -> bool {
        self.rows.get(&number).is_some_and(|row| row.outcome.is_ok())
    }

    /// Whether there is a finished part of just these runs.
    pub(super) fn has_whole(&self, range: NumberRange) -> bool {
        self.whole.contains(&range)
    }

    /// The rows of the runs that succeeded.
    pub(super) fn finished(&self) -> BTreeMap<usize, Row> {
        self.rows.iter().filter(|(_, row)| row.outcome.is_ok()).map(|(number, row)| (*number, row.clone())).collect()
    }

    /// All rows by number.
    pub(super) fn rows(&self) -> &BTreeMap<usize, Row> {
        &self.rows
    }

    pub(super) fn into_rows(self) -> Vec<Row> {
        self.rows.into_values().collect()
    }

    /// Removes the unfinished parts that were read, once all that they have is in a finished one.
    pub(super) fn remove_unfinished(&self) {
        for path in &self.unfinished {
            // One that stays does no harm: its rows are those of the finished part.
            let _ = disk::remove_file(path);
        }
    }
}

impl Part<'_> {
    /// Adds rows that are finished.
    pub(super) fn extend(&mut self, rows: Vec<Row>) {
        let work = self.sweep.work();
        for row in rows {
            if let Some(number) = work.number_of(CellRun { cell: row.cell, replicate: row.replicate }) {
                self.rows.insert(number, row);
            }
        }
    }

    /// Writes what is done until now; it took `wall_s` seconds.
    pub(super) fn save(&self, wall_s: f64) -> Result<(), CampaignError> {
        let mut file = CsvFile::headless(EmptyCell::Bare);
        file.row([MARK, self.sweep.fingerprint(), &format!("{wall_s:.3}")]);
        self.rows.values().for_each(|row| file.row(row.record()));
        let mut own = PartFile::create(&self.own)?;
        own.write_all(file.bytes()).map_err(|error| OutputError::new(&self.own, &error))?;
        // Synced, so that it is there for the others also if this machine loses its power.
        Ok(own.finish()?)
    }

    /// Writes the part, which is whole, and gives it its final name.
    pub(super) fn finish(self, wall_s: f64) -> Result<(), CampaignError> {
        debug_assert_eq!(self.rows.len(), self.range.len(), "all runs of the part have a row");
        self.save(wall_s)?;
        match disk::rename(&self.own, &self.whole) {
            // Another process did the same part, gave it its final name, and removed what was not finished.
            Err(error) if error.kind() == io::ErrorKind::NotFound && self.whole.is_file() => Ok(()),
            other => Ok(other
                .and_then(|()| disk::sync_folder_of(&self.whole))
                .map_err(|error| OutputError::new(&self.whole, &error))?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_read_as_it_is_written() {
        let range = NumberRange { start: 64, end: 1000 };
        for (unfinished, text) in
            [(None, "000000064-000001000.csv"), (Some(2), "000000064-000001000.unfinished-002.csv")]
        {
            let name = Name { range, unfinished };
            assert_eq!(name.text(), text);
            assert_eq!(Name::parse(text), Some(name));
        }
        for other in ["a.csv", "1-2.txt", "2-1.csv", "1-2.unfinished-x.csv"] {
            assert_eq!(Name::parse(other), None, "{other}");
        }
    }
}
