//! `--status` of a plan.

use std::collections::BTreeMap;
use std::io::{self, Write};

use serde_json::{Value, json};

use super::super::options::Printing;
use super::plan::duration;
use crate::diagnostic::Failure;
use sextant::NumberRange;
use sextant_kernel::text::{counted, listed};
use sextant_study::campaign::slurm::Submitted;
use sextant_study::campaign::{Campaign, FailedRun, Progress};

pub(super) fn print(campaign: &Campaign, printing: Printing) -> Result<(), Failure> {
    let progress = campaign.progress()?;
    let submitted = campaign.submitted()?;
    Ok(printing
        .print(&json(campaign, &progress, &submitted), |stdout| text(campaign, &progress, &submitted, stdout))?)
}

fn text(
    campaign: &Campaign,
    progress: &Progress,
    submitted: &[Submitted],
    stdout: &mut impl Write,
) -> io::Result<()> {
    let percent = 100.0 * progress.done() as f64 / progress.runs() as f64;
    writeln!(
        stdout,
        "{}: {}, {} done ({percent:.1} %), {} failed, {} missing",
        campaign.folder().display(),
        counted(progress.runs(), "run"),
        progress.done(),
        progress.failed().len(),
        progress.missing(),
    )?;
    if let Some(pace) = progress.pace() {
        let left = if progress.missing() > 0 {
            format!("; the rest takes {} at this rate", duration(pace.left_s))
        } else {
            String::new()
        };
        let rate = 60.0 * pace.runs_per_s;
        writeln!(stdout, "{rate:.1} runs a minute over {}{left}", duration(pace.over_s))?;
    }
    if progress.missing() > 0 {
        writeln!(stdout, "missing: {}", listed(&texts(&progress.missing_ranges())))?;
    }
    for (reason, runs) in by_reason(progress.failed()) {
        let first = runs[0];
        let (cell, replicate) = (first.run.cell, first.run.replicate);
        let others = if runs.len() > 1 { format!(" and {} more", runs.len() - 1) } else { String::new() };
        writeln!(stdout, "failed: run {} (cell {cell}, replicate {replicate}){others}: {reason}", first.number)?;
    }
    for Submitted { name, jobs, tasks, runs, .. } in submitted {
        if jobs.is_empty() {
            writeln!(stdout, "submission {name}: no job yet; if it was cut off, remove slurm/{name}")?;
            continue;
        }
        let (runs, tasks) = (counted(*runs, "run"), counted(*tasks, "task"));
        writeln!(stdout, "submission {name}: {runs} in {tasks}, job {}", jobs.join(", "))?;
    }
    Ok(())
}

/// The failed runs, by why they failed.
fn by_reason(failed: &[FailedRun]) -> BTreeMap<&str, Vec<&FailedRun>> {
    let mut reasons: BTreeMap<&str, Vec<&FailedRun>> = BTreeMap::new();
    for run in failed {
        reasons.entry(&run.reason).or_default().push(run);
    }
    reasons
}

fn texts(ranges: &[NumberRange]) -> Vec<String> {
    ranges.iter().map(ToString::to_string).collect()
}

fn json(campaign: &Campaign, progress: &Progress, submitted: &[Submitted]) -> Value {
    let failed = progress.failed().iter().map(|failed| {
        let (cell, replicate) = (failed.run.cell, failed.run.replicate);
        let seed = campaign.sweep().seed_of(replicate);
        json!({"run": failed.number, "cell": cell, "replicate": replicate, "seed": seed, "reason": failed.reason})
    });
    let submissions = submitted.iter().map(|submitted| {
        let Submitted { name, jobs, tasks, runs, .. } = submitted;
        json!({"name": name, "jobs": jobs, "tasks": tasks, "runs": runs})
    });
    let mut status = json!({
        "runs": progress.runs(),
        "done": progress.done(),
        "missing": progress.missing(),
        "missing_runs": texts(&progress.missing_ranges()),
        "failed": failed.collect::<Vec<_>>(),
        "submissions": submissions.collect::<Vec<_>>(),
    });
    if let (Some(pace), Some(status)) = (progress.pace(), status.as_object_mut()) {
        let pace = json!({"runs_per_s": pace.runs_per_s, "over_s": pace.over_s, "left_s": pace.left_s});
        status.insert("pace".to_owned(), pace);
    }
    json!({"plan": status})
}
