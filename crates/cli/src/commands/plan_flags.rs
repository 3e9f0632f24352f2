//! The flags of plans: of `sextant sweep SCENARIO --plan` and of the commands on the folder of a plan.

use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::Args;

use super::slurm_flags::{Scheduler, SlurmFlags};
use sextant::NumberRange;

/// Flags of plans.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Plans (a sweep on several machines)")]
pub(crate) struct PlanFlags {
    /// What is to be done.
    #[command(flatten)]
    pub(super) action: Action,
    /// With --plan: do not try one run to estimate how long all take
    #[arg(long, requires = "plan")]
    pub(super) no_trial: bool,
    /// What a submission asks of Slurm.
    #[command(flatten)]
    pub(super) slurm: SlurmFlags,
    /// With --resume: submit no run more often than this
    #[arg(long, value_name = "N", default_value = "3", requires = "resume")]
    pub(super) attempts: NonZeroU32,
}

/// What is to be done with a plan.
#[derive(Clone, Debug, Args)]
#[group(multiple = false)]
pub(super) struct Action {
    /// Write a plan of the sweep and all that its runs need to this folder, and run nothing but a trial
    #[arg(long, value_name = "DIR", conflicts_with_all = ["resume", "out", "shard", "dry_run"])]
    pub(super) plan: Option<PathBuf>,
    /// Of a plan: do the runs A to B - 1 of its work list, which is numbered from 0. Ends with exit code 75 on SIGTERM, and
    /// keeps what is done
    #[arg(long, value_name = "A..B", conflicts_with = "resume")]
    pub(super) cells: Option<NumberRange>,
    /// Of a plan: submit all of it to this scheduler
    #[arg(long, value_name = "SCHEDULER", conflicts_with = "resume")]
    pub(super) submit: Option<Scheduler>,
    /// Of a plan: print what is done, failed and missing
    #[arg(long, conflicts_with = "resume")]
    pub(super) status: bool,
    /// Of a plan: join all parts into one table
    #[arg(long, conflicts_with = "resume")]
    pub(super) collect: bool,
    /// Of a plan: cancel what still waits or runs
    #[arg(long, conflicts_with = "resume")]
    pub(super) cancel: bool,
}

impl Action {
    /// The flag that needs the folder of a plan, if one is given.
    pub(super) fn of_plan(&self) -> Option<&'static str> {
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
