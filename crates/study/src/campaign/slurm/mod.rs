//! Plans on a cluster that runs Slurm: arrays of jobs, each of whose tasks does a part.
//!
//! A submission is a folder with the job script, which a person can read and submit, and with the parts that its tasks do.
//! What is done is told by the parts in the folder of the plan, never by the queue. The queue is only asked which tasks still
//! wait or run, so that nothing is submitted twice.

mod chunks;
mod scheduler;
mod script;
mod settings;
mod slurm_option;
mod submission;
mod tiles;
mod value;

pub use settings::{Chunk, SlurmSettings};
pub use slurm_option::SlurmOption;
pub use submission::{Attempts, Submitted};
pub use tiles::{SubmittedMap, submit_map};
pub use value::{Grammar, JobId, Memory, SlurmName, TimeLimit, Value};

use std::path::{Path, PathBuf};

use sextant::NumberRange;
use sextant_kernel::text::counted;
use sextant_recording::disk;

use super::error::CampaignError;
use super::{Campaign, Progress};
use scheduler::ArrayTask;
use script::{EACH_TASK, Script, ScriptFolder, each_chunk, line_word};
use submission::{Array, Record, Submission};

/// The folder of submissions in that of a plan.
pub(super) const FOLDER: &str = "slurm";

impl Campaign {
    /// Submits all runs that are not done, as arrays of tasks that call `program`, and returns what was submitted.
    ///
    /// # Errors
    /// If it was submitted before, nothing is missing, a file cannot be written, or Slurm refuses.
    pub fn submit(&self, program: &Path, settings: &SlurmSettings) -> Result<Submitted, CampaignError> {
        let before = self.submissions()?;
        let jobs: Vec<String> = before.iter().flat_map(Submission::jobs).map(|job| job.to_string()).collect();
        if !jobs.is_empty() {
            return Err(CampaignError::Submitted { jobs });
        }
        self.submit_open(program, settings, &before, Attempts::ANY)
    }

    /// Submits all runs that are missing or failed, that no task of an earlier submission still waits for or does, and that
    /// were submitted fewer than `attempts` times before. What `settings` lack is that of the last submission: of its options
    /// only those that ask for resources, because somebody else may have written the file that has them.
    ///
    /// # Errors
    /// If it was never submitted, the last submission has other options and `settings` have none, another process submits it at this moment, nothing is left to submit, a file cannot be
    /// written, or Slurm refuses.
    pub fn resume(
        &self,
        program: &Path,
        settings: &SlurmSettings,
        attempts: Attempts,
    ) -> Result<Submitted, CampaignError> {
        let before = self.submissions()?;
        let Some(last) = before.last() else {
            return Err(CampaignError::NeverSubmitted { folder: self.folder.clone() });
        };
        if settings.options.is_empty() {
            last.check_options()?;
        }
        self.submit_open(program, &settings.or(&last.record.settings), &before, attempts)
    }

    /// Cancels all tasks that wait or run, and returns their jobs.
    ///
    /// # Errors
    /// If it was never submitted, or Slurm refuses.
    pub fn cancel(&self) -> Result<Vec<JobId>, CampaignError> {
        let submissions = self.submissions()?;
        let jobs: Vec<JobId> = submissions.iter().flat_map(Submission::jobs).collect();
        if jobs.is_empty() {
            return Err(CampaignError::NeverSubmitted { folder: self.folder.clone() });
        }
        scheduler::cancel(&jobs)?;
        Ok(jobs)
    }

    /// The submissions, the first one first: their jobs and number of runs. One that has no job yet has none here either.
    ///
    /// # Errors
    /// If their files cannot be read.
    pub fn submitted(&self) -> Result<Vec<Submitted>, CampaignError> {
        let (made, begun) = self.all_submissions()?;
        Ok(made
            .iter()
            .map(Submission::submitted)
            .chain(begun.iter().map(|folder| Submitted::begun(folder)))
            .collect())
    }

    /// The submissions, and the folders of those that have no job yet.
    fn all_submissions(&self) -> Result<(Vec<Submission>, Vec<PathBuf>), CampaignError> {
        Submission::all(&self.foreign(), &self.folder.join(FOLDER), self.sweep.work().len())
    }

    /// The submissions, if none is under way.
    fn submissions(&self) -> Result<Vec<Submission>, CampaignError> {
        let (made, begun) = self.all_submissions()?;
        match begun.into_iter().next() {
            None => Ok(made),
            Some(folder) => Err(CampaignError::Submitting { folder }),
        }
    }

    fn submit_open(
        &self,
        program: &Path,
        settings: &SlurmSettings,
        before: &[Submission],
        attempts: Attempts,
    ) -> Result<Submitted, CampaignError> {
        let progress = self.progress()?;
        let tried = self.tried(before);
        let queued = self.queued(before)?;
        let (mut exhausted, mut waiting) = (0, 0);
        let open: Vec<usize> = progress
            .open()
            .filter(|&number| {
                let (is_queued, is_exhausted) = (queued[number], attempts.are_used_up(tried[number]));
                waiting += usize::from(is_queued);
                exhausted += usize::from(is_exhausted && !is_queued);
                !is_queued && !is_exhausted
            })
            .collect();
        if open.is_empty() {
            return Err(CampaignError::NothingToSubmit { why: why_nothing(&progress, waiting, exhausted) });
        }
        let greatest_array = scheduler::greatest_array();
        let chunks = chunks::of(self, &open, settings.chunk.unwrap_or_default(), greatest_array);
        let folder = submission::claim(&self.folder.join(FOLDER), before.len() + 1)?;
        let refused = self.send(program, settings, &folder, &chunks, greatest_array).inspect_err(|_| {
            // A submission without a job would stand in the way of the next one.
            let _ = disk::remove_folder(&folder);
        })?;
        let submission = Submission::read(&self.foreign(), &folder, self.sweep.work().len())?
            .ok_or(CampaignError::Submitting { folder })?;
        let refused = refused.map(|error| error.to_string());
        Ok(Submitted { left_to_queue: waiting, given_up: exhausted, refused, ..submission.submitted() })
    }

    /// Writes a submission to `folder`, and submits it as few arrays as Slurm allows. Returns why a later array was refused, if
    /// one was.
    fn send(
        &self,
        program: &Path,
        settings: &SlurmSettings,
        folder: &Path,
        chunks: &[NumberRange],
        greatest_array: usize,
    ) -> Result<Option<CampaignError>, CampaignError> {
        let plan =
            std::path::absolute(&self.folder).map_err(|error| CampaignError::unreadable(&self.folder, &error))?;
        let own = ScriptFolder::new(&plan.join(FOLDER).join(folder.file_name().unwrap_or_default()))?;
        let program = line_word("the path of this program", program.as_os_str())?;
        let call = line_word("the path of the plan", plan.as_os_str())?;
        let call = format!("{program} sweep {call} --cells \"$part\" --threads \"$SLURM_CPUS_PER_TASK\" --quiet");
        submission::write_chunks(folder, chunks)?;
        let name = plan.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let script = Script { name: &name, folder: &own, settings, output: EACH_TASK };
        let path = own.file(submission::SCRIPT);
        submission::write_script(&path, &script.text(&each_chunk(&own, &call)))?;
        let (jobs, refused) = submit_chunks(&path, chunks.len(), settings, greatest_array);
        let refused = match refused {
            Some(error) if jobs.is_empty() => return Err(error),
            other => other,
        };
        let submitted = jobs.last().map_or(0, |last| last.first + last.tasks);
        let runs = chunks[..submitted].iter().map(|chunk| chunk.len()).sum();
        let record = Record { settings: settings.clone(), arrays: jobs, runs };
        record.write(folder).inspect_err(|_| {
            // A job that nobody knows of would be submitted again. The error of the file is the one that is told.
            let _ = scheduler::cancel(&record.jobs().collect::<Vec<_>>());
        })?;
        Ok(refused)
    }

    /// How often each run was submitted.
    fn tried(&self, before: &[Submission]) -> Vec<u32> {
        let mut tried = vec![0; self.sweep.work().len()];
        for chunk in before.iter().flat_map(Submission::submitted_chunks) {
            tried.iter_mut().take(chunk.end).skip(chunk.start).for_each(|count| *count += 1);
        }
        tried
    }

    /// Which runs a task still waits for or does.
    fn queued(&self, before: &[Submission]) -> Result<Vec<bool>, CampaignError> {
        let mut queued = vec![false; self.sweep.work().len()];
        let jobs: Vec<JobId> = before.iter().flat_map(Submission::jobs).collect();
        for ArrayTask { job, index } in scheduler::queued(&jobs)? {
            for submission in before {
                if let Some(chunk) = submission.chunk_of(&job, index) {
                    queued.iter_mut().take(chunk.end).skip(chunk.start).for_each(|queued| *queued = true);
                }
            }
        }
        Ok(queued)
    }
}

/// Submits so many chunks as few arrays as Slurm allows. What was submitted goes on if a later array is refused; the error is
/// returned too.
fn submit_chunks(
    script: &Path,
    chunks: usize,
    settings: &SlurmSettings,
    greatest_array: usize,
) -> (Vec<Array>, Option<CampaignError>) {
    let mut jobs = Vec::new();
    for first in (0..chunks).step_by(greatest_array) {
        let tasks = greatest_array.min(chunks - first);
        match scheduler::submit(script, tasks, settings.max_running, first) {
            Ok(job) => jobs.push(Array { job, first, tasks }),
            Err(error) => return (jobs, Some(error)),
        }
    }
    (jobs, None)
}

fn why_nothing(progress: &Progress, waiting: usize, exhausted: usize) -> String {
    let open = progress.missing() + progress.failed().len();
    if open == 0 {
        return "all runs are done".to_owned();
    }
    let waiting = (waiting > 0).then(|| format!("{} still wait or run in the queue", counted(waiting, "run")));
    let exhausted =
        (exhausted > 0).then(|| format!("{} were submitted too often already", counted(exhausted, "run")));
    [waiting, exhausted].into_iter().flatten().collect::<Vec<_>>().join(", ")
}
