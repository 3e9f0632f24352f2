//! The programs of Slurm.

use std::num::NonZeroU32;
use std::path::Path;
use std::process::Command;

use sextant_scenario::shell;

use super::super::error::CampaignError;
use super::value::JobId;

/// Tasks of an array, if the cluster does not tell: what Slurm allows unless it is told otherwise.
const USUAL_GREATEST_ARRAY: usize = 1001;

/// A task of an array.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ArrayTask {
    pub(super) job: JobId,
    pub(super) index: usize,
}

/// Submits `tasks` tasks of the script, of which the first does the line `first` of the file of chunks, and returns the
/// identity of the job.
pub(super) fn submit(
    script: &Path,
    tasks: usize,
    max_running: Option<NonZeroU32>,
    first: usize,
) -> Result<JobId, CampaignError> {
    let at_once = max_running.map_or_else(String::new, |count| format!("%{count}"));
    let array = format!("--array=0-{}{at_once}", tasks - 1);
    let mut command = Command::new("sbatch");
    command.args(["--parsable", &array, "--"]).arg(script).arg(first.to_string());
    job(&mut command)
}

/// Submits a script that runs when all of `jobs` have ended, however they ended, and returns the identity of the job.
pub(super) fn submit_after(script: &Path, jobs: &[JobId]) -> Result<JobId, CampaignError> {
    let mut command = Command::new("sbatch");
    command.args(["--parsable", &format!("--dependency=afterany:{}", jobs.join(":")), "--"]).arg(script);
    job(&mut command)
}

/// The identity of the job that a call of `sbatch` made.
fn job(command: &mut Command) -> Result<JobId, CampaignError> {
    let answer = answer(command)?;
    // With several clusters: JOB;CLUSTER.
    let job = answer.trim().split(';').next().unwrap_or_default();
    job.parse().map_err(|_| failed(command, format!("its answer is no job: `{}`", answer.trim())))
}

/// The tasks of `jobs` that wait or run.
pub(super) fn queued(jobs: &[JobId]) -> Result<Vec<ArrayTask>, CampaignError> {
    if jobs.is_empty() {
        return Ok(Vec::new());
    }
    let mut command = Command::new("squeue");
    // All of the user's jobs: a job that ended long ago is an unknown one, and an error, if it is asked for.
    command.args(["--noheader", "--array", "--me", "--states=all", "--format=%F %K %T"]);
    Ok(answer(&mut command)?.lines().filter_map(task).filter(|task| jobs.contains(&task.job)).collect())
}

/// A line `JOB INDEX STATE`, unless the task has ended.
fn task(line: &str) -> Option<ArrayTask> {
    let mut words = line.split_whitespace();
    let (job, index, state) = (words.next()?, words.next()?, words.next()?);
    let is_queued =
        ["PENDING", "RUNNING", "SUSPENDED", "CONFIGURING", "REQUEUED", "REQUEUE_HOLD", "RESIZING", "SIGNALING"]
            .contains(&state);
    if !is_queued {
        return None;
    }
    Some(ArrayTask { job: job.parse().ok()?, index: index.parse().ok()? })
}

/// Cancels jobs.
pub(super) fn cancel(jobs: &[JobId]) -> Result<(), CampaignError> {
    answer(Command::new("scancel").arg("--").args(jobs.iter().map(JobId::as_ref))).map(|_| ())
}

/// Tasks of an array, at most.
pub(super) fn greatest_array() -> usize {
    let answer = answer(Command::new("scontrol").args(["show", "config"])).unwrap_or_default();
    greatest_array_in(&answer).unwrap_or(USUAL_GREATEST_ARRAY)
}

fn greatest_array_in(config: &str) -> Option<usize> {
    let line = config.lines().find(|line| line.trim_start().starts_with("MaxArraySize"))?;
    line.split('=').nth(1)?.trim().parse().ok().filter(|&tasks| tasks > 0)
}

fn answer(command: &mut Command) -> Result<String, CampaignError> {
    let output = command.output().map_err(|error| match error.kind() {
        std::io::ErrorKind::NotFound => {
            failed(command, "there is no such program; is this a machine of the cluster?")
        }
        _ => failed(command, error.to_string()),
    })?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(failed(command, String::from_utf8_lossy(&output.stderr).trim().to_owned()))
    }
}

fn failed(command: &Command, why: impl Into<String>) -> CampaignError {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    let words: Vec<_> = words.map(|word| shell::word(&word.to_string_lossy()).into_owned()).collect();
    CampaignError::Scheduler { command: words.join(" "), why: why.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_tasks_that_wait_or_run_are_queued() {
        let running = Some(ArrayTask { job: "12".parse().unwrap(), index: 3 });
        assert_eq!(task("12 3 RUNNING"), running);
        assert_eq!(task("12 3 PENDING"), running);
        for other in ["12 3 COMPLETED", "12 3 TIMEOUT", "12 3 NODE_FAIL", "12 N/A RUNNING", ""] {
            assert_eq!(task(other), None, "{other}");
        }
    }

    #[test]
    fn the_greatest_array_is_that_of_the_cluster() {
        assert_eq!(greatest_array_in("LaunchType = x\nMaxArraySize            = 16\nMaxDBDMsgs = 4\n"), Some(16));
        assert_eq!(greatest_array_in("nothing"), None);
    }
}
