//! The plan of a sweep, checked before anything runs.

use std::collections::{BTreeMap, BTreeSet};
use std::num::NonZeroU32;
use std::path::Path;

use sextant::summary::Measure;
use sextant::summary::measures::{self, Subjects};
use sextant_kernel::text::hexadecimal;
use sextant_scenario::{
    NamedFile, Scenario, ScenarioError, ScenarioErrors, ScenarioFile, Setting, SurveyIdentity, SweepAxes, check_given,
};
use sha2::{Digest, Sha256};

use super::column::{Column, ColumnKind, ValueKinds};
use super::effects::{check_effects, check_set};
use super::facts::{self, CellFacts, Contents, flags};
use super::row::RunRow;
use super::work_list::WorkList;

/// The cells and runs of a sweep.
#[derive(Clone, Debug)]
pub struct Sweep {
    file: ScenarioFile,
    set: Vec<String>,
    seed: u64,
    runs: u32,
    cells: Vec<Cell>,
    work: WorkList,
    keys: Vec<Column>,
    subjects: Subjects,
    measures: Vec<Measure>,
    named_files: Vec<NamedFile>,
    identity: String,
    fingerprint: String,
}

/// One combination of settings.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// The settings that differ from the scenario.
    pub settings: Vec<Setting>,
    /// The values of the settings that other cells set, in the order of the keys; empty where there is none.
    pub others: Vec<String>,
    /// Number of its survey. Cells with the same number share their surveys.
    pub survey: usize,
    /// Hash of its scenario and of the files that this names, as 64 hexadecimal digits.
    pub sha256: String,
}

/// What is known of a sweep whose cells were all checked before.
#[derive(Clone, Debug)]
pub(crate) struct Checked {
    pub(crate) set: Vec<String>,
    pub(crate) seed: u64,
    pub(crate) runs: u32,
    pub(crate) cells: Vec<CheckedCell>,
    pub(crate) subjects: Subjects,
    /// The files that any cell names.
    pub(crate) named_files: Vec<NamedFile>,
}

/// What is known of a cell that was checked: what [`Cell`] has besides its settings.
#[derive(Clone, Debug)]
pub(crate) struct CheckedCell {
    pub(crate) others: Vec<String>,
    pub(crate) survey: usize,
    pub(crate) sha256: String,
}

/// Maximum number of runs of a sweep; more are surely a mistake.
const MOST_RUNS: u64 = 10_000_000;

/// Refuses more runs of all `cells` together than a sweep can have.
pub(crate) fn check_runs(cells: usize, runs: u32) -> Result<(), ScenarioError> {
    let all = (cells as u64).saturating_mul(runs.into());
    if all <= MOST_RUNS {
        return Ok(());
    }
    Err(ScenarioError::new(format!(
        "{cells} cells with `runs` = {runs} each are {all} runs; allowed: at most {MOST_RUNS}"
    )))
}

/// Refuses runs whose seeds would go beyond the greatest one.
pub(crate) fn check_seeds(seed: u64, runs: u32) -> Result<(), ScenarioError> {
    let others = u64::from(runs) - 1;
    if seed.checked_add(others).is_some() {
        return Ok(());
    }
    let greatest = u64::MAX;
    Err(ScenarioError::new(format!(
        "the seed {seed} with {runs} runs: the runs have the seeds {seed}, {seed} + 1, ..; allowed: a seed of at most {}, so \
         that no seed is above {greatest}",
        greatest - others
    )))
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
        Self::of(ScenarioFile::read(path)?, set, seed, runs)
    }

    /// The sweep of a scenario file that is read, as [`read`](Self::read).
    ///
    /// # Errors
    /// If a cell is not a valid scenario: all errors of the first such cell.
    pub fn of(
        file: ScenarioFile,
        set: &[String],
        seed: Option<u64>,
        runs: Option<NonZeroU32>,
    ) -> Result<Self, ScenarioErrors> {
        check_given(set, "seed", seed)?;
        check_given(set, "sweep.runs", runs)?;
        let axes = file.axes_of_sweep(set)?;
        Self::of_axes(file, axes, set, seed, runs, |facts| check_set(set, facts))
    }

    /// The sweep of the scenario at `path`, whose cells may replace settings of `set`: for a check of a scenario that may also
    /// be run without its sweep.
    ///
    /// # Errors
    /// If a cell is not a valid scenario: all errors of the first such cell.
    pub fn read_replacing(path: &Path, set: &[String]) -> Result<Self, ScenarioErrors> {
        let file = ScenarioFile::read(path)?;
        let axes = file.axes(set)?;
        Self::of_axes(file, axes, set, None, None, |_| Ok(()))
    }

    fn of_axes(
        file: ScenarioFile,
        axes: SweepAxes,
        set: &[String],
        seed: Option<u64>,
        runs: Option<NonZeroU32>,
        check: impl FnOnce(&[CellFacts]) -> Result<(), ScenarioError>,
    ) -> Result<Self, ScenarioErrors> {
        check_runs(axes.cells.len(), runs.unwrap_or(axes.runs).get())?;
        let facts = facts::of_cells(&file, set, seed, &keys(&axes.cells), &axes.cells)?;
        check(&facts)?;
        check_effects(set, &axes.cells, &facts)?;
        let mut surveys: BTreeMap<SurveyIdentity, usize> = BTreeMap::new();
        let mut subjects = Subjects::default();
        let mut contents = Contents::default();
        let mut named_files = Vec::new();
        let mut cells = Vec::with_capacity(facts.len());
        for cell in &facts {
            let next = surveys.len();
            let survey = *surveys.entry(cell.survey).or_insert(next);
            let sha256 = contents.sha256(cell)?;
            subjects.extend(&cell.subjects);
            for file in &cell.files {
                if !named_files.contains(file) {
                    named_files.push(file.clone());
                }
            }
            cells.push(CheckedCell { others: cell.others.clone(), survey, sha256 });
        }
        let seed = facts.first().map(|cell| cell.seed).unwrap_or_default();
        let runs = runs.unwrap_or(axes.runs).get();
        check_seeds(seed, runs)?;
        let checked = Checked { set: set.to_vec(), seed, runs, cells, subjects, named_files };
        Ok(Self::checked(file, axes, checked))
    }

    /// The sweep of a scenario file whose `axes` have as many cells as were `checked`.
    pub(crate) fn checked(file: ScenarioFile, axes: SweepAxes, checked: Checked) -> Self {
        let Checked { set, seed, runs, cells, subjects, named_files } = checked;
        let measures = measures::all(&subjects);
        let identity = identity(cells.iter().map(|cell| cell.sha256.as_str()), seed, &measures);
        let fingerprint = hexadecimal(&Sha256::digest(format!("{identity} {runs} runs")));
        let mut keys = keys(&axes.cells);
        let cells = axes.cells.into_iter().zip(cells);
        let cells: Vec<Cell> = cells
            .map(|(settings, CheckedCell { others, survey, sha256 })| Cell { settings, others, survey, sha256 })
            .collect();
        let mut values = vec![ValueKinds::default(); keys.len()];
        for cell in &cells {
            for (values, value) in values.iter_mut().zip(cell.values(&keys)) {
                values.add(value);
            }
        }
        keys.iter_mut().zip(values).for_each(|(key, values)| key.kind = values.kind());
        let surveys: Vec<usize> = cells.iter().map(|cell| cell.survey).collect();
        let work = WorkList::of(&surveys, runs);
        Self { file, set, seed, runs, cells, work, keys, subjects, measures, named_files, identity, fingerprint }
    }

    /// The scenario file.
    #[must_use]
    pub fn file(&self) -> &ScenarioFile {
        &self.file
    }

    /// The settings of all cells, each `path.to.key=value`.
    #[must_use]
    pub fn set(&self) -> &[String] {
        &self.set
    }

    /// What is simulated, mapped and applied in any cell.
    pub(crate) fn subjects(&self) -> &Subjects {
        &self.subjects
    }

    /// The files that any cell names.
    #[must_use]
    pub fn named_files(&self) -> &[NamedFile] {
        &self.named_files
    }

    /// What its settings leave out of the file, where they replace a whole table: a sentence for each of them.
    ///
    /// # Errors
    /// None for a sweep whose cells were checked.
    pub fn left_out(&self) -> Result<Vec<String>, ScenarioErrors> {
        let mut sentences = self.file().left_out(self.set())?;
        let of_set = sentences.len();
        let settings = self.cells().iter().flat_map(|cell| &cell.settings);
        let tables: BTreeSet<_> =
            settings.filter(|setting| setting.value.starts_with('{')).map(Setting::line).collect();
        for table in tables {
            let lines: Vec<_> = self.set().iter().cloned().chain([table]).collect();
            sentences.extend(self.file().left_out(&lines)?.into_iter().skip(of_set));
        }
        Ok(sentences)
    }

    /// The order of the runs.
    #[must_use]
    pub fn work(&self) -> &WorkList {
        &self.work
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
        self.work.unit_count()
    }

    /// Names of the networks of cells that have several.
    #[must_use]
    pub fn networks(&self) -> &[String] {
        &self.subjects.networks
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

    /// The values of a measure in the successful runs of a cell, each with the number of the run. The rows are in the order
    /// of their cells.
    #[must_use]
    pub fn values_of(&self, rows: &[RunRow], cell: usize, measure: &Measure) -> Vec<(u32, f64)> {
        let Some(at) = self.measures.iter().position(|other| other == measure) else { return Vec::new() };
        let value = |row: &RunRow| Some((row.replicate, row.outcome.as_ref().ok()?[at]?));
        rows_of(rows, cell).iter().filter_map(value).collect()
    }

    /// Hash of everything that decides a row: the scenario of each cell, the files that it names, the seed, the measures and
    /// the version. It does not depend on the number of runs.
    pub(crate) fn identity(&self) -> &str {
        &self.identity
    }

    /// Hash of everything that decides the rows: the [`identity`](Self::identity) and the number of runs.
    pub(crate) fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// The scenario of a cell with the seed of a replicate.
    pub(super) fn scenario(&self, cell: usize, replicate: u32) -> Result<Scenario, ScenarioErrors> {
        self.file.scenario(&flags(&self.set, &self.cells[cell].settings), Some(self.seed_of(replicate)))
    }

    /// The seed of a replicate.
    #[must_use]
    pub fn seed_of(&self, replicate: u32) -> u64 {
        self.seed.saturating_add(u64::from(replicate))
    }

    /// The value of each of the [`keys`](Self::keys) in a cell, also where it is that of the file or a default; empty where there
    /// is none, because the cell has another choice.
    ///
    /// # Panics
    /// If there is no such cell.
    #[must_use]
    pub fn values(&self, cell: usize) -> Vec<String> {
        self.cells[cell].values(&self.keys).map(plain).collect()
    }
}

impl Cell {
    /// Its values of the [`keys`](Sweep::keys) of the sweep, in TOML; empty where there is none.
    pub fn values<'c>(&'c self, keys: &'c [Column]) -> impl Iterator<Item = &'c str> {
        let mut others = self.others.iter();
        keys.iter().map(move |key| {
            let own = self.settings.iter().find(|setting| setting.key == key.name).map(|setting| &setting.value);
            own.or_else(|| others.next()).map_or("", String::as_str)
        })
    }
}

/// Hash of all that decides a row: the hash of each cell, the first seed, the version, and what is measured.
fn identity<'a>(cells: impl Iterator<Item = &'a str>, seed: u64, measures: &[Measure]) -> String {
    let mut digest = Sha256::new();
    cells.for_each(|sha256| digest.update(sha256));
    digest.update(format!("{seed} {}", env!("CARGO_PKG_VERSION")));
    for measure in measures {
        digest.update(measure.path() + "\n");
    }
    hexadecimal(&digest.finalize())
}

/// The rows of a cell, of rows in the order of their cells.
fn rows_of(rows: &[RunRow], cell: usize) -> &[RunRow] {
    let start = rows.partition_point(|row| row.cell < cell);
    let end = rows.partition_point(|row| row.cell <= cell);
    &rows[start..end]
}

/// The settings that vary, in the order in which the cells name them.
pub(super) fn keys<'c>(cells: impl IntoIterator<Item = &'c Vec<Setting>>) -> Vec<Column> {
    let mut keys: Vec<Column> = Vec::new();
    for setting in cells.into_iter().flatten() {
        if keys.iter().all(|key| key.name != setting.key) {
            keys.push(Column::new(&setting.key, ColumnKind::Text));
        }
    }
    keys
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
    fn texts_lose_only_their_quotes() {
        assert_eq!(plain("\"suburban\""), "suburban");
        assert_eq!(plain("[1, 2]"), "[1, 2]");
        assert_eq!(plain("\"a\\\"b\""), "\"a\\\"b\"");
    }
}
