//! `sextant sweep SCENARIO --plan DIR`.

use std::io::{self, Write};
use std::path::Path;

use super::super::outputs::reads_sweep;
use super::super::sweep;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::terminal::{Watcher, stdout, warn};
use sextant::shell;
use sextant_kernel::text::counted;
use sextant_recording::admission::{self, Outputs};
use sextant_study::campaign::{Campaign, Replace};
use sextant_study::sweep::{Trial, TrialError, trial};

pub(super) fn execute(
    arguments: &sweep::Arguments,
    scenario: &Path,
    folder: &Path,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    let sweep = arguments.sweep(scenario)?;
    let replace = if arguments.force { Replace::Plan } else { Replace::Nothing };
    Campaign::check_room(&sweep, folder, replace)?;
    let mut outputs = Outputs::new(admission::Replace::Any);
    reads_sweep(&mut outputs, &sweep);
    outputs.clears("--plan", folder).keep_inputs()?;
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let trial = if arguments.campaign.no_trial { None } else { tried(trial(&sweep, &watcher))? };
    watcher.clear();
    let campaign = Campaign::create(sweep, folder, trial, replace)?;
    Ok(print(&campaign, &mut stdout())?)
}

/// A run that fails does not make the plan a bad one: others may succeed.
fn tried(result: Result<Trial, TrialError>) -> Result<Option<Trial>, Failure> {
    match result {
        Ok(trial) => Ok(Some(trial)),
        Err(TrialError::Interrupted(_)) => Err(Failure::Interrupted),
        Err(error) => {
            warn(&format!("the trial failed, so how long all takes is not known: {error}"));
            Ok(None)
        }
    }
}

fn print(campaign: &Campaign, stdout: &mut impl Write) -> io::Result<()> {
    let sweep = campaign.sweep();
    let (folder, runs) = (campaign.folder().display(), sweep.work().len());
    writeln!(
        stdout,
        "{folder}: {} with {} each: {}, which share {}",
        counted(sweep.cells().len(), "cell"),
        counted(sweep.runs() as usize, "seed"),
        counted(runs, "run"),
        counted(sweep.survey_count(), "survey"),
    )?;
    if let Some(all) = campaign.estimate() {
        writeln!(
            stdout,
            "run {} took {} on one core; all take about {} of CPU time",
            all.trial_run,
            duration(all.trial_s),
            duration(all.total_s)
        )?;
    }
    let folder = shell::path(campaign.folder());
    writeln!(stdout, "do some here:        sextant sweep {folder} --cells 0..{runs}")?;
    writeln!(stdout, "do all on a cluster: sextant sweep {folder} --submit slurm")?;
    writeln!(stdout, "look and join:       sextant sweep {folder} --status; sextant sweep {folder} --collect")
}

/// A time in the unit that people would use.
pub(super) fn duration(s: f64) -> String {
    match s {
        _ if s < 0.01 => format!("{:.2} ms", 1e3 * s),
        _ if s < 1.0 => format!("{:.0} ms", 1e3 * s),
        _ if s < 120.0 => format!("{s:.1} s"),
        _ if s < 7200.0 => format!("{:.1} minutes", s / 60.0),
        _ => format!("{:.1} hours", s / 3600.0),
    }
}
