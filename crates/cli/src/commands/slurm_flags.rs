//! The flags of submissions to a cluster.

use std::num::NonZeroU32;
use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::diagnostic::Failure;
use crate::invocation::Invocation;
use sextant_study::campaign::slurm::{Chunk, Memory, SlurmName, SlurmOption, SlurmSettings, TimeLimit};

/// A scheduler of a cluster.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Scheduler {
    /// Slurm
    Slurm,
}

/// What a submission asks of Slurm.
#[derive(Clone, Debug, Args)]
#[command(next_help_heading = "Submissions to Slurm")]
pub(crate) struct SlurmFlags {
    /// Runs of a task, rounded up to those that share a survey [default: auto, a quarter of an hour or less]. Of a map: tiles of
    /// a task [default: 1]
    #[arg(long, value_name = "N|auto")]
    chunk: Option<Chunk>,
    /// Time limit of a task, for example 1:00:00
    #[arg(long, value_name = "TIME")]
    time: Option<TimeLimit>,
    /// Partition
    #[arg(long, value_name = "NAME")]
    partition: Option<SlurmName>,
    /// Account that pays
    #[arg(long, value_name = "NAME")]
    account: Option<SlurmName>,
    /// Tasks that run at the same time, at most
    #[arg(long, value_name = "N")]
    max_running: Option<NonZeroU32>,
    /// Cores of a task [default: 1]
    #[arg(long, value_name = "N")]
    cpus: Option<NonZeroU32>,
    /// Memory of a task, for example 4G
    #[arg(long, value_name = "SIZE")]
    memory: Option<Memory>,
    /// Another option of sbatch, for example --option=--qos=long. May be repeated
    #[arg(long = "option", value_name = "OPTION", allow_hyphen_values = true)]
    options: Vec<SlurmOption>,
}

impl SlurmFlags {
    /// The flags; each has a value.
    pub(super) const NAMES: [&str; 8] =
        ["--chunk", "--time", "--partition", "--account", "--max-running", "--cpus", "--memory", "--option"];

    pub(super) fn settings(&self) -> SlurmSettings {
        let Self { chunk, time, partition, account, max_running, cpus, memory, options } = self.clone();
        SlurmSettings { chunk, time, partition, account, max_running, cpus, memory, options }
    }
}

/// This program, as the tasks of a submission call it.
pub(super) fn own_program(invocation: &Invocation) -> Result<PathBuf, Failure> {
    let unknown = |error| Failure::failed(format!("the path of this program is not known: {error}"));
    invocation.program().map_err(unknown)
}
