//! `--submit slurm`, `--resume` and `--cancel` of a plan.

use std::io::{self, Write};
use std::num::NonZeroU32;
use std::path::Path;

use crate::diagnostic::Failure;
use crate::terminal::stdout;
use sextant_kernel::text::counted;
use sextant_study::campaign::Campaign;
use sextant_study::campaign::slurm::{Attempts, SlurmSettings, Submitted};

pub(super) fn submit(campaign: &Campaign, program: &Path, settings: &SlurmSettings) -> Result<(), Failure> {
    Ok(tell(campaign, &campaign.submit(program, settings)?)?)
}

pub(super) fn resume(
    campaign: &Campaign,
    program: &Path,
    settings: &SlurmSettings,
    attempts: NonZeroU32,
) -> Result<(), Failure> {
    Ok(tell(campaign, &campaign.resume(program, settings, Attempts::at_most(attempts))?)?)
}

pub(super) fn cancel(campaign: &Campaign) -> Result<(), Failure> {
    let jobs = campaign.cancel()?;
    Ok(writeln!(stdout(), "cancelled: {}", jobs.join(", "))?)
}

fn tell(campaign: &Campaign, submitted: &Submitted) -> io::Result<()> {
    let mut stdout = stdout();
    let Submitted { name, jobs, tasks, runs, left_to_queue, given_up, refused } = submitted;
    writeln!(stdout, "submitted {} in {}: job {}", counted(*runs, "run"), counted(*tasks, "task"), jobs.join(", "))?;
    if *left_to_queue > 0 {
        writeln!(stdout, "{} left to tasks that still wait or run", counted(*left_to_queue, "run"))?;
    }
    if *given_up > 0 {
        writeln!(
            stdout,
            "{} not submitted again: submitted too often already (--attempts)",
            counted(*given_up, "run")
        )?;
    }
    if let Some(why) = refused {
        writeln!(stdout, "the other runs were refused, and can be resumed later: {why}")?;
    }
    writeln!(stdout, "job script: {}", campaign.folder().join("slurm").join(name).join("job.sh").display())
}
