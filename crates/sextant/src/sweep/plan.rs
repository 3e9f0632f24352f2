//! The plan of a sweep, checked before anything runs.

use std::collections::BTreeMap;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::column::{Column, Kind};
use super::row::Row;
use super::statistics::Mean;
use crate::scenario::{Scenario, ScenarioError, ScenarioErrors, Setting, SurveyIdentity, SweepAxes};
use crate::summary::Measure;
use crate::summary::measures::{self, Subjects};

/// The cells and runs of a sweep.
#[derive(Clone, Debug)]
pub struct Sweep {
    path: PathBuf,
    set: Vec<String>,
    seed: u64,
    runs: u32,
    cells: Vec<Cell>,
    surveys: usize,
    keys: Vec<Column>,
    subjects: Subjects,
    measures: Vec<Measure>,
    identity: String,
    fingerprint: String,
}

/// One combination of settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The settings that differ from the scenario.
    pub settings: Vec<Setting>,
    /// Number of its survey. Cells with the same number share their surveys.
    pub survey: usize,
}

/// The smallest part of a sweep: one survey and the cells that share it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Unit {
    pub(super) index: usize,
    pub(super) replicate: u32,
    pub(super) cells: Vec<usize>,
}

impl Sweep {
    /// Reads the scenario at `path` with its `[sweep]` and the flags `set`; `seed` and `runs` override those of the
    /// file. Every cell is checked.
    ///
    /// # Errors
    /// If a cell is not a valid scenario: all errors of the first such cell.
    pub fn read(
        path: &Path,
        set: &[String],
        seed: Option<u64>,
        runs: Option<NonZeroU32>,
    ) -> Result<Self, ScenarioErrors> {
        let sweep = SweepAxes::read(path, set)?;
        let mut keys: Vec<(String, Vec<&str>)> = Vec::new();
        for setting in sweep.cells.iter().flatten() {
            let i = keys.iter().position(|(key, _)| *key == setting.key).unwrap_or_else(|| {
                keys.push((setting.key.clone(), Vec::new()));
                keys.len() - 1
            });
            keys[i].1.push(&setting.value);
        }
        let keys = keys.iter().map(|(key, values)| Column::new(key, kind(values))).collect();
        let mut surveys: Vec<SurveyIdentity> = Vec::new();
        let mut subjects = Subjects::default();
        let mut cells = Vec::with_capacity(sweep.cells.len());
        let mut digest = Sha256::new();
        let mut contents = Contents::default();
        let mut first_seed = None;
        for settings in &sweep.cells {
            let flags = flags(set, settings);
            let scenario = Scenario::load_with(path, &flags, seed)?;
            first_seed.get_or_insert(scenario.seed().0);
            digest.update(scenario.text());
            for file in scenario.named_files() {
                digest.update(contents.of(&file.path)?);
            }
            let by_nodes = scenario.distributed().map(|map| &map.name);
            let maps = by_nodes.into_iter().chain(scenario.maps().iter().map(|named| &named.name));
            let applications = scenario.applications().iter().map(|application| &application.name);
            let searches = scenario.applications().iter().filter(|application| application.algorithm.is_search());
            extend(&mut subjects.by_nodes, by_nodes.into_iter());
            extend(&mut subjects.maps, maps);
            extend(&mut subjects.applications, applications);
            extend(&mut subjects.searches, searches.map(|application| &application.name));
            let survey = scenario.survey_identity();
            let known = surveys.iter().position(|other| *other == survey);
            let survey = known.unwrap_or_else(|| {
                surveys.push(survey);
                surveys.len() - 1
            });
            cells.push(Cell { settings: settings.clone(), survey });
        }
        let (seed, runs) = (first_seed.unwrap_or_default(), runs.unwrap_or(sweep.runs).get());
        digest.update(format!("{seed} {}", env!("CARGO_PKG_VERSION")));
        let measures = measures::all(&subjects);
        for measure in &measures {
            digest.update(measure.path() + "\n");
        }
        let identity = hexadecimal(&digest.clone().finalize());
        digest.update(format!("{runs} runs"));
        let fingerprint = hexadecimal(&digest.finalize());
        Ok(Self {
            path: path.to_owned(),
            set: set.to_vec(),
            seed,
            runs,
            cells,
            surveys: surveys.len(),
            keys,
            subjects,
            measures,
            identity,
            fingerprint,
        })
    }

    /// The cells.
    #[must_use]
    pub fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Runs of each cell.
    #[must_use]
    pub fn runs(&self) -> u32 {
        self.runs
    }

    /// Seed of the first run of each cell.
    #[must_use]
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Number of surveys to simulate; a survey that cells share counts once.
    #[must_use]
    pub fn survey_count(&self) -> usize {
        self.surveys * self.runs as usize
    }

    /// Names of the maps that any cell computes.
    #[must_use]
    pub fn maps(&self) -> &[String] {
        &self.subjects.maps
    }

    /// Names of the applications that any cell runs.
    #[must_use]
    pub fn applications(&self) -> &[String] {
        &self.subjects.applications
    }

    /// The measures of each run, in the order of the columns.
    #[must_use]
    pub fn measures(&self) -> &[Measure] {
        &self.measures
    }

    /// The settings that vary.
    #[must_use]
    pub fn keys(&self) -> &[Column] {
        &self.keys
    }

    /// The values of a measure in the successful runs of a cell, each with the number of the run.
    #[must_use]
    pub fn values_of(&self, rows: &[Row], cell: usize, measure: &Measure) -> Vec<(u32, f64)> {
        let Some(at) = self.measures.iter().position(|other| other == measure) else { return Vec::new() };
        let value = |row: &Row| Some((row.replicate, row.outcome.as_ref().ok()?[at]?));
        rows.iter().filter(|row| row.cell == cell).filter_map(value).collect()
    }

    /// The mean of a measure over the successful runs of a cell; `None` if there are none, or it does not apply.
    #[must_use]
    pub fn mean(&self, rows: &[Row], cell: usize, measure: &Measure) -> Option<Mean> {
        let values: Vec<f64> = self.values_of(rows, cell, measure).into_iter().map(|(_, value)| value).collect();
        Mean::of(&values)
    }

    /// Hash of everything that decides a row: the scenario of each cell, the files that it names, the seed, the measures and
    /// the version. It does not depend on the number of runs.
    pub(super) fn identity(&self) -> &str {
        &self.identity
    }

    /// Hash of everything that decides the rows: the [`identity`](Self::identity) and the number of runs.
    pub(super) fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// The scenario of a cell with the seed of a replicate.
    pub(super) fn scenario(&self, cell: usize, replicate: u32) -> Result<Scenario, ScenarioErrors> {
        Scenario::load_with(&self.path, &flags(&self.set, &self.cells[cell].settings), Some(self.seed_of(replicate)))
    }

    /// The seed of a replicate.
    #[must_use]
    pub fn seed_of(&self, replicate: u32) -> u64 {
        self.seed.wrapping_add(u64::from(replicate))
    }

    /// The value of each of the [`keys`](Self::keys) in a cell; empty where the cell does not set it.
    ///
    /// # Panics
    /// If there is no such cell.
    #[must_use]
    pub fn values(&self, cell: usize) -> Vec<String> {
        let settings = &self.cells[cell].settings;
        let value = |column: &Column| {
            let setting = settings.iter().find(|setting| setting.key == column.name);
            setting.map_or_else(String::new, |setting| plain(&setting.value))
        };
        self.keys.iter().map(value).collect()
    }

    /// The units: each survey with all cells that share it, once per replicate.
    pub(super) fn units(&self) -> Vec<Unit> {
        let mut units = Vec::new();
        for survey in 0..self.surveys {
            let cells: Vec<_> = (0..self.cells.len()).filter(|&cell| self.cells[cell].survey == survey).collect();
            for replicate in 0..self.runs {
                units.push(Unit { index: units.len(), replicate, cells: cells.clone() });
            }
        }
        units
    }
}

/// Hashes of the contents of files, each of which is read once.
#[derive(Default)]
struct Contents(BTreeMap<PathBuf, [u8; 32]>);

impl Contents {
    fn of(&mut self, file: &Path) -> Result<[u8; 32], ScenarioError> {
        if let Some(&hash) = self.0.get(file) {
            return Ok(hash);
        }
        let bytes = std::fs::read(file).map_err(|error| ScenarioError::unreadable(file, &error))?;
        let hash = Sha256::digest(bytes).into();
        self.0.insert(file.to_owned(), hash);
        Ok(hash)
    }
}

/// Adds the names that are not in the list.
fn extend<'a>(list: &mut Vec<String>, names: impl Iterator<Item = &'a String>) {
    for name in names {
        if !list.contains(name) {
            list.push(name.clone());
        }
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

fn flags(set: &[String], settings: &[Setting]) -> Vec<String> {
    set.iter().cloned().chain(settings.iter().map(Setting::line)).collect()
}

/// The kind of a column with these TOML values.
fn kind(values: &[&str]) -> Kind {
    if values.iter().all(|value| value.parse::<i64>().is_ok()) {
        Kind::Integer
    } else if values.iter().all(|value| value.parse::<f64>().is_ok()) {
        Kind::Real
    } else {
        Kind::Text
    }
}

/// A TOML value as written in the table: a text loses its quotes.
fn plain(value: &str) -> String {
    let quoted = value.strip_prefix('"').and_then(|value| value.strip_suffix('"'));
    quoted.filter(|text| !text.contains(['"', '\\'])).unwrap_or(value).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_kind_of_a_column_is_the_narrowest_that_fits() {
        assert_eq!(kind(&["1", "2"]), Kind::Integer);
        assert_eq!(kind(&["1", "2.5"]), Kind::Real);
        assert_eq!(kind(&["1", "\"suburban\""]), Kind::Text);
    }

    #[test]
    fn texts_lose_only_their_quotes() {
        assert_eq!(plain("\"suburban\""), "suburban");
        assert_eq!(plain("[1, 2]"), "[1, 2]");
        assert_eq!(plain("\"a\\\"b\""), "\"a\\\"b\"");
    }
}
