//! The file of a plan.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sextant_recording::output::{OutputError, write_file};

use super::FILES;
use super::bundle::Bundle;
use super::error::CampaignError;
use crate::scenario::ScenarioFile;
use crate::summary::measures::Subjects;
use crate::sweep::{Checked, Sweep, Trial, check_runs, check_seeds};

/// The version of this program, whose plans it does.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What `plan.json` has.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlanFile {
    /// The version of the program that made it.
    version: String,
    /// Hash of all that decides a row.
    identity: String,
    /// Seed of the first run of each cell.
    seed: u64,
    /// Runs of each cell.
    runs: u32,
    /// Settings of all cells, each `path.to.key=value`.
    set: Vec<String>,
    files: Bundle,
    subjects: Subjects,
    /// How long all takes.
    pub(super) estimate: Option<Estimate>,
    /// Number of the survey of each cell.
    surveys: Vec<usize>,
    /// Hash of the scenario of each cell and of the files that it names.
    sha256: Vec<String>,
}

/// The part of the file that each version understands.
#[derive(Deserialize)]
struct VersionOnly {
    version: String,
}

/// How long all runs of a plan take, by one of them that was tried on one core.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Estimate {
    /// Number of the run that was tried.
    pub trial_run: usize,
    /// How long it took (s).
    pub trial_s: f64,
    /// CPU time of all runs, if each is like this one (s).
    pub total_s: f64,
}

impl Estimate {
    /// Each survey takes as long as that of the trial, and each run as long as the rest of the trial.
    pub(super) fn of(sweep: &Sweep, trial: Trial) -> Self {
        let Trial { run, survey_s, rest_s } = trial;
        let total_s = survey_s * sweep.survey_count() as f64 + rest_s * sweep.work().len() as f64;
        Self { trial_run: run, trial_s: survey_s + rest_s, total_s }
    }
}

impl PlanFile {
    pub(super) const NAME: &str = "plan.json";

    pub(super) fn path(folder: &Path) -> PathBuf {
        folder.join(Self::NAME)
    }

    pub(super) fn of(sweep: &Sweep, files: Bundle, estimate: Option<Estimate>) -> Self {
        Self {
            version: VERSION.to_owned(),
            identity: sweep.identity().to_owned(),
            seed: sweep.seed(),
            runs: sweep.runs(),
            set: sweep.set().to_vec(),
            files,
            subjects: sweep.subjects().clone(),
            estimate,
            surveys: sweep.cells().iter().map(|cell| cell.survey).collect(),
            sha256: sweep.cells().iter().map(|cell| cell.sha256.clone()).collect(),
        }
    }

    pub(super) fn write(&self, folder: &Path) -> Result<(), CampaignError> {
        let path = Self::path(folder);
        let mut json = serde_json::to_vec(self)
            .map_err(|error| OutputError::new(&path, &io::Error::other(error.to_string())))?;
        json.push(b'\n');
        Ok(write_file(&path, &json)?)
    }

    pub(super) fn read(folder: &Path) -> Result<Self, CampaignError> {
        let path = Self::path(folder);
        let no_plan = |why: String| CampaignError::NoPlan { folder: folder.to_owned(), why };
        let bytes = fs::read(&path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => no_plan(format!("there is no file `{}`", Self::NAME)),
            _ => CampaignError::unreadable(&path, &error),
        })?;
        let invalid = |error: serde_json::Error| no_plan(format!("`{}`: {error}", Self::NAME));
        let VersionOnly { version } = serde_json::from_slice(&bytes).map_err(invalid)?;
        if version != VERSION {
            return Err(CampaignError::OtherVersion { folder: folder.to_owned(), found: version, own: VERSION });
        }
        serde_json::from_slice(&bytes).map_err(invalid)
    }

    /// The sweep, with the files in `folder`. Its cells are not checked again: the files are those that were checked.
    pub(super) fn sweep(self, folder: &Path) -> Result<Sweep, CampaignError> {
        let files = folder.join(FILES);
        self.files.check(&files)?;
        let scenario = ScenarioFile::read(files.join(&self.files.scenario))?;
        let axes = scenario.axes_of_sweep(&self.set)?;
        let cells = axes.cells.len();
        let is_own = self.surveys.len() == cells
            && self.sha256.len() == cells
            && are_numbered(&self.surveys)
            && self.runs > 0
            && check_runs(cells, self.runs).is_ok()
            && check_seeds(self.seed, self.runs).is_ok();
        if !is_own {
            return Err(CampaignError::Changed { file: Self::path(folder) });
        }
        let checked = Checked {
            set: self.set,
            seed: self.seed,
            runs: self.runs,
            cells: self.surveys.into_iter().zip(self.sha256).collect(),
            subjects: self.subjects,
            named_files: self.files.named_files(&files),
            identity: self.identity,
        };
        Ok(Sweep::checked(scenario, axes, checked))
    }
}

/// Whether surveys have numbers in the order in which they appear first, as in each plan.
fn are_numbered(surveys: &[usize]) -> bool {
    let mut count = 0;
    surveys.iter().all(|&survey| {
        let is_next = survey == count;
        count += usize::from(is_next);
        survey < count
    })
}
