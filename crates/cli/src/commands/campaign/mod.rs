//! `sextant sweep --plan` and the commands on the folder of a plan.

mod cluster;
mod part;
mod plan;
mod status;

use std::path::{Path, PathBuf};

use super::outputs::{admit, keep_logs};
use super::slurm_flags::own_program;
use super::sweep::{self, Results};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::invocation::Invocation;
use crate::terminal::stdout;
use sextant_recording::admission::{OutputKind, Outputs, Replace};
use sextant_study::campaign::Campaign;
use sextant_study::sweep::{TableFormat, write_table};

/// Whether a sweep is planned, or a plan is named instead of a scenario.
pub(super) fn is_asked_for(arguments: &sweep::Arguments) -> bool {
    let action = &arguments.campaign.action;
    let is_folder = arguments.scenario.as_ref().is_some_and(|scenario| scenario.is_dir());
    arguments.scenario.is_some() && (action.plan.is_some() || action.of_plan().is_some() || is_folder)
}

pub(super) fn execute(
    arguments: &sweep::Arguments,
    invocation: &Invocation,
    interrupt: &Interrupt,
) -> Result<(), Failure> {
    arguments.work.start_threads()?;
    let flags = &arguments.campaign;
    let (action, source) = (&flags.action, arguments.scenario.as_deref().unwrap_or(Path::new("")));
    if let Some(folder) = &action.plan {
        return plan::execute(arguments, source, folder, interrupt);
    }
    if !source.is_dir() {
        let flag = action.of_plan().unwrap_or_default();
        return Err(Failure::bad_input_with_help(
            format!("`{}` is not a folder; `{flag}` needs that of a plan", source.display()),
            "`sextant sweep SCENARIO.toml --plan DIR` makes one",
        ));
    }
    refuse_flags_of_scenarios(arguments)?;
    if let Some(range) = action.cells {
        return part::execute(&Campaign::open_part(source, range)?, range, arguments, interrupt);
    }
    let campaign = Campaign::open(source)?;
    if action.submit.is_some() {
        cluster::submit(&campaign, &own_program(invocation)?, &flags.slurm.settings())
    } else if arguments.resume {
        cluster::resume(&campaign, &own_program(invocation)?, &flags.slurm.settings(), flags.attempts)
    } else if action.cancel {
        cluster::cancel(&campaign)
    } else if action.collect {
        collect(&campaign, arguments)
    } else if action.status {
        Ok(status::print(&campaign, arguments.printing)?)
    } else {
        Err(Failure::bad_input_with_help(
            format!("`{}` is a plan; say what is to be done with it", source.display()),
            "--cells A..B, --submit slurm, --status, --resume, --collect or --cancel",
        ))
    }
}

/// What decides the rows is fixed by the plan.
fn refuse_flags_of_scenarios(arguments: &sweep::Arguments) -> Result<(), Failure> {
    let flags = [
        (arguments.seed.is_some(), "--seed"),
        (!arguments.overrides.set.is_empty(), "--set"),
        (arguments.runs.is_some(), "--runs"),
    ];
    match flags.into_iter().find(|(is_given, _)| *is_given) {
        None => Ok(()),
        Some((_, flag)) => Err(Failure::bad_input_with_help(
            format!("`{flag}` cannot change a plan"),
            "give it with --plan, which makes another plan",
        )),
    }
}

fn collect(campaign: &Campaign, arguments: &sweep::Arguments) -> Result<(), Failure> {
    let out = arguments.out.clone().unwrap_or_else(|| default_table(campaign));
    TableFormat::of(&out)?;
    let mut outputs = Outputs::new(if arguments.force { Replace::Any } else { Replace::Ours });
    outputs.reads_closed(campaign.folder()).writes("--out", &out, OutputKind::Table);
    admit(&outputs, Some(arguments.work))?;
    keep_logs(None, [("--out", out.as_path())])?;
    let rows = campaign.collect()?;
    write_table(&out, campaign.sweep(), &rows)?;
    Results { plan: campaign.sweep(), rows: &rows }.tell(&out, arguments.printing.format, &mut stdout())
}

/// SCENARIO.csv in the working folder.
fn default_table(campaign: &Campaign) -> PathBuf {
    let scenario = campaign.sweep().file().path();
    Path::new(scenario.file_name().unwrap_or_default()).with_extension("csv")
}
