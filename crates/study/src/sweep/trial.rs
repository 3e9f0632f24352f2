//! One run of a sweep, to know how long all take.

use sextant::run::{RunError, run_on, survey};
use sextant::summary::Stopwatch;
use sextant_kernel::{Interrupted, Unreported, Watch};
use sextant_scenario::ScenarioErrors;

use super::plan::Sweep;
use super::work_list::CellRun;

/// How long one run took on one core.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Its number in the work list.
    pub run: usize,
    /// Time of the survey, which cells share (s).
    pub survey_s: f64,
    /// Time of the rest (s).
    pub rest_s: f64,
}

/// Why a trial has no result.
#[derive(Clone, Debug, thiserror::Error)]
pub enum TrialError {
    /// The run is invalid with its seed.
    #[error(transparent)]
    Scenario(#[from] ScenarioErrors),
    /// The run failed.
    #[error(transparent)]
    Run(#[from] RunError),
    /// There is no thread for it.
    #[error("no thread can be started: {0}")]
    Thread(String),
    /// The work was stopped.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
}

/// Does the run in the middle of the work list on one core.
///
/// # Errors
/// If it fails, or `watch` stops it.
pub fn trial(plan: &Sweep, watch: &dyn Watch) -> Result<Trial, TrialError> {
    let run = plan.work().len() / 2;
    let CellRun { cell, replicate } = plan.work().get(run);
    let scenario = plan.scenario(cell, replicate)?;
    let one_core = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let one_core = one_core.map_err(|error| TrialError::Thread(error.to_string()))?;
    one_core.install(|| {
        let watch = &Unreported(watch);
        let whole = Stopwatch::start();
        let surveyed = survey(&scenario, &mut (), watch)?;
        let survey_s = whole.elapsed_s();
        run_on(&scenario, surveyed.as_ref(), &mut (), watch)?;
        (watch as &dyn Watch).check()?;
        Ok(Trial { run, survey_s, rest_s: whole.elapsed_s() - survey_s })
    })
}
