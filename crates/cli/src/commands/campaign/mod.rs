//! `sextant sweep --plan` and the commands on the folder of a plan.

mod cluster;
mod part;
mod plan;
mod status;

use std::num::NonZeroU32;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};

use super::sweep::{self, Results};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use sextant::campaign::slurm::{Chunk, SlurmSettings};
use sextant::campaign::{Campaign, RunRange};
use sextant::sweep::{TableFormat, write_table};

/// Flags of plans.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Plans (a sweep on several machines)")]
pub(crate) struct Flags {
    /// What is to be done.
    #[command(flatten)]
    action: Action,
    /// With --plan: do not try one run to estimate how long all take
    #[arg(long, requires = "plan")]
    no_trial: bool,
    /// What a submission asks of Slurm.
    #[command(flatten)]
    slurm: SlurmFlags,
    /// With --resume: submit no run more often than this
    #[arg(long, value_name = "N", default_value = "3", requires = "resume")]
    attempts: NonZeroU32,
}

/// What is to be done with a plan.
#[derive(Clone, Debug, Args)]
#[group(multiple = false)]
struct Action {
    /// Write a plan of the sweep and all that its runs need to this folder, and run nothing but a trial
    #[arg(long, value_name = "DIR", conflicts_with_all = ["resume", "out", "shard", "dry_run"])]
    plan: Option<PathBuf>,
    /// Of a plan: do the runs A to B - 1 of its work list, which is numbered from 0. Ends with exit code 75 on SIGTERM, and
    /// keeps what is done
    #[arg(long, value_name = "A..B", conflicts_with = "resume")]
    cells: Option<RunRange>,
    /// Of a plan: submit all of it to this scheduler
    #[arg(long, value_name = "SCHEDULER", conflicts_with = "resume")]
    submit: Option<Scheduler>,
    /// Of a plan: print what is done, failed and missing
    #[arg(long, conflicts_with = "resume")]
    status: bool,
    /// Of a plan: join all parts into one table
    #[arg(long, conflicts_with = "resume")]
    collect: bool,
    /// Of a plan: cancel what still waits or runs
    #[arg(long, conflicts_with = "resume")]
    cancel: bool,
}

/// A scheduler of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Scheduler {
    /// Slurm
    Slurm,
}

/// What a submission asks of Slurm.
#[derive(Clone, Debug, Args)]
struct SlurmFlags {
    /// Runs of a task, rounded up to those that share a survey [default: auto, a quarter of an hour or less]
    #[arg(long, value_name = "N|auto")]
    chunk: Option<Chunk>,
    /// Time limit of a task, for example 1:00:00
    #[arg(long, value_name = "TIME")]
    time: Option<String>,
    /// Partition
    #[arg(long, value_name = "NAME")]
    partition: Option<String>,
    /// Account that pays
    #[arg(long, value_name = "NAME")]
    account: Option<String>,
    /// Tasks that run at the same time, at most
    #[arg(long, value_name = "N")]
    max_running: Option<NonZeroU32>,
    /// Cores of a task [default: 1]
    #[arg(long, value_name = "N")]
    cpus: Option<NonZeroU32>,
    /// Memory of a task, for example 4G
    #[arg(long, value_name = "SIZE")]
    memory: Option<String>,
    /// Another option of sbatch, for example --option=--qos=long. May be repeated
    #[arg(long = "option", value_name = "OPTION", allow_hyphen_values = true)]
    options: Vec<String>,
}

impl SlurmFlags {
    fn settings(&self) -> SlurmSettings {
        let Self { chunk, time, partition, account, max_running, cpus, memory, options } = self.clone();
        SlurmSettings { chunk, time, partition, account, max_running, cpus, memory, options }
    }
}

impl Action {
    /// The flag that needs the folder of a plan, if one is given.
    fn of_plan(&self) -> Option<&'static str> {
        let flags = [
            (self.cells.is_some(), "--cells"),
            (self.submit.is_some(), "--submit"),
            (self.status, "--status"),
            (self.collect, "--collect"),
            (self.cancel, "--cancel"),
        ];
        flags.into_iter().find_map(|(is_given, flag)| is_given.then_some(flag))
    }
}

/// Whether a sweep is planned, or a plan is named instead of a scenario.
pub(super) fn is_asked_for(arguments: &sweep::Arguments) -> bool {
    let action = &arguments.campaign.action;
    action.plan.is_some() || action.of_plan().is_some() || arguments.source.scenario.is_dir()
}

pub(super) fn execute(arguments: &sweep::Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let flags = &arguments.campaign;
    let (action, source) = (&flags.action, &arguments.source.scenario);
    if let Some(folder) = &action.plan {
        return plan::execute(arguments, folder, interrupt);
    }
    if !source.is_dir() {
        let flag = action.of_plan().unwrap_or_default();
        return Err(Failure::bad_input_with_help(
            format!("`{}` is not a folder; `{flag}` needs that of a plan", source.display()),
            "`sextant sweep SCENARIO.toml --plan DIR` makes one",
        ));
    }
    refuse_flags_of_scenarios(arguments)?;
    let campaign = Campaign::open(source)?;
    if let Some(range) = action.cells {
        part::execute(&campaign, range, arguments, interrupt)
    } else if action.submit.is_some() {
        cluster::submit(&campaign, &flags.slurm.settings())
    } else if arguments.resume {
        cluster::resume(&campaign, &flags.slurm.settings(), flags.attempts)
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
    let source = &arguments.source;
    let flags = [
        (source.seed.is_some(), "--seed"),
        (!source.overrides.set.is_empty(), "--set"),
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
    let rows = campaign.collect()?;
    write_table(&out, campaign.sweep(), &rows)?;
    let results = Results { plan: campaign.sweep(), rows: &rows };
    Ok(results.tell(&out, arguments.printing.format, &mut std::io::stdout().lock())?)
}

/// SCENARIO.csv in the working folder.
fn default_table(campaign: &Campaign) -> PathBuf {
    let scenario = campaign.sweep().file().path();
    Path::new(scenario.file_name().unwrap_or_default()).with_extension("csv")
}
