//! The file of a plan.

use std::io;
use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sextant::summary::measures::Subjects;
use sextant_kernel::text::{counted, shortened};
use sextant_kernel::{LARGEST_FILE, SettingError};
use sextant_recording::ForeignFolder;
use sextant_recording::output::{OutputError, write_file};
use sextant_scenario::ScenarioFile;

use super::FILES;
use super::bundle::Bundle;
use super::error::CampaignError;
use super::json_object::JsonObject;
use crate::sweep::{Checked, CheckedCell, Sweep, Trial, check_runs, check_seeds};

/// The version of this program, whose plans it does.
const VERSION: &str = env!("CARGO_PKG_VERSION");

/// What `plan.json` has.
#[derive(Clone, Debug, Serialize)]
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
    /// Of each cell, the values of the settings that other cells set.
    others: Vec<Vec<String>>,
    /// Number of the survey of each cell.
    surveys: Vec<usize>,
    /// Hash of the scenario of each cell and of the files that it names.
    sha256: Vec<String>,
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
            others: sweep.cells().iter().map(|cell| cell.others.clone()).collect(),
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

    /// The file in the folder of a plan. Somebody else may have written it.
    pub(super) fn read(plan: &ForeignFolder) -> Result<Self, CampaignError> {
        let path = Self::path(plan.root());
        let no_plan = |why: String| CampaignError::NoPlan { folder: plan.root().to_owned(), why };
        let json = plan.read(&path, LARGEST_FILE).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => no_plan(format!("there is no file `{}`", Self::NAME)),
            _ => CampaignError::unreadable(&path, &error),
        })?;
        let mut object = JsonObject::parse(&json).map_err(|error| no_plan(format!("`{}`: {error}", Self::NAME)))?;
        let invalid = |error: SettingError| CampaignError::invalid(&path, error);
        // Each version understands this key.
        let version: String = object.take("version", "a text").map_err(invalid)?;
        if version != VERSION {
            let found = shortened(&version.escape_debug().to_string()).into_owned();
            return Err(CampaignError::OtherVersion { folder: plan.root().to_owned(), found, own: VERSION });
        }
        Self::parse(version, object).map_err(invalid)
    }

    fn parse(version: String, mut object: JsonObject) -> Result<Self, SettingError> {
        let this = Self {
            version,
            identity: object.take("identity", "64 hexadecimal digits")?,
            seed: object.take("seed", "a whole number, 0 to 18446744073709551615")?,
            runs: object.take::<NonZeroU32>("runs", "a whole number, 1 to 4294967295")?.get(),
            set: object.take("set", "an array of texts path.to.key=value")?,
            files: Bundle::parse(object.object("files")?)?,
            subjects: object.take("subjects", "the names of maps and applications")?,
            estimate: object.take("estimate", "the times of a run and of all, or null")?,
            others: object.take("others", "an array of arrays of texts")?,
            surveys: object.take("surveys", "an array of whole numbers")?,
            sha256: object.take("sha256", "an array of texts")?,
        };
        if let Some(Estimate { trial_run: _, trial_s, total_s }) = this.estimate {
            SettingError::not_negative("estimate.trial_s", trial_s)?;
            SettingError::not_negative("estimate.total_s", total_s)?;
        }
        object.finish()?;
        Ok(this)
    }

    /// The sweep, with the files in the folder `plan`. Its cells are not worked out again.
    pub(super) fn sweep(self, plan: &ForeignFolder) -> Result<Sweep, CampaignError> {
        let path = Self::path(plan.root());
        let invalid = |error: SettingError| CampaignError::invalid(&path, error);
        let files = plan.root().join(FILES);
        self.files.check(plan, &files)?;
        let of_files = ForeignFolder::new(&files);
        let scenario = ScenarioFile::read_foreign(of_files, &files.join(&self.files.scenario))?;
        let axes = scenario.axes_of_sweep(&self.set)?;
        let cells = axes.cells.len();
        check_runs(cells, self.runs)
            .map_err(|error| invalid(SettingError::new("runs", self.runs, format!("fewer, because {error}"))))?;
        check_seeds(self.seed, self.runs)
            .map_err(|error| invalid(SettingError::new("seed", self.seed, format!("another, because {error}"))))?;
        let lengths = [("others", self.others.len()), ("surveys", self.surveys.len()), ("sha256", self.sha256.len())];
        for (key, found) in lengths {
            if found != cells {
                let allowed = format!("{cells}: one for each cell of the scenario");
                return Err(invalid(SettingError::new(key, counted(found, "item"), allowed)));
            }
        }
        if !are_numbered(&self.surveys) {
            let allowed = "numbers from 0 in the order in which they appear first";
            return Err(invalid(SettingError::new("surveys", "a list in another order", allowed)));
        }
        let cells = self.others.into_iter().zip(self.surveys).zip(self.sha256);
        let cells = cells.map(|((others, survey), sha256)| CheckedCell { others, survey, sha256 }).collect();
        let checked = Checked {
            set: self.set,
            seed: self.seed,
            runs: self.runs,
            cells,
            subjects: self.subjects,
            named_files: self.files.named_files(&files),
        };
        let sweep = Sweep::checked(scenario, axes, checked);
        if sweep.identity() != self.identity {
            let found = format!("`{}`", shortened(&self.identity.escape_debug().to_string()));
            let allowed = format!("`{}`, which is that of the cells, the seed and the measures", sweep.identity());
            return Err(invalid(SettingError::new("identity", found, allowed)));
        }
        Ok(sweep)
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
