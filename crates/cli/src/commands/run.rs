//! `sextant run`: simulate, record, map, measure.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::Args;

use super::Format;
use crate::diagnostic::Failure;
use crate::scenario::Scenario;

/// What `sextant run` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The scenario file
    #[arg(value_name = "SCENARIO.toml")]
    pub scenario: PathBuf,
    /// Where the recording goes; SCENARIO.mcap in the working folder if absent
    #[arg(long, value_name = "RUN.mcap")]
    pub out: Option<PathBuf>,
    /// Also write the results to this file, as one JSON object
    #[arg(long, value_name = "FILE.json")]
    pub summary: Option<PathBuf>,
    /// Also write the frames to this file, for Wireshark: all on air, or those that the robot hears that the
    /// scenario names as recording.pcap.robot
    #[arg(long, value_name = "FILE.pcap")]
    pub pcap: Option<PathBuf>,
    /// Seed of all randomness, in place of the scenario's
    #[arg(long, value_name = "N")]
    pub seed: Option<u64>,
    /// Threads to compute with; one a core if absent. The results do not depend on it
    #[arg(long, value_name = "N")]
    pub threads: Option<NonZeroUsize>,
    /// Override a setting: path.to.key=value, the value in TOML, quotes optional; may be repeated
    #[arg(long, value_name = "K=V", value_parser = crate::scenario::flag)]
    pub set: Vec<String>,
    /// How results are printed
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
    /// No progress bar and no notes
    #[arg(long)]
    pub quiet: bool,
}

impl Arguments {
    /// Where the recording goes.
    #[must_use]
    pub fn recording(&self) -> PathBuf {
        let default = || PathBuf::from(self.scenario.file_name().unwrap_or_default()).with_extension("mcap");
        self.out.clone().unwrap_or_else(default)
    }
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    set_threads(arguments.threads)?;
    let scenario = Scenario::load(&arguments.scenario, &arguments.set, arguments.seed)?;
    crate::run::execute(arguments, &scenario)
}

/// Sets how many threads compute; once a process.
pub(crate) fn set_threads(threads: Option<NonZeroUsize>) -> Result<(), Failure> {
    let Some(threads) = threads else {
        return Ok(());
    };
    rayon::ThreadPoolBuilder::new()
        .num_threads(threads.get())
        .build_global()
        .map_err(|error| Failure::failed(format!("{threads} threads cannot be started: {error}")))
}
