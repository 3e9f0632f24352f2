//! `sextant run`: simulates a scenario, records it, computes its maps and measures them.

use std::path::PathBuf;

use clap::Args;

use super::options::{Results, ScenarioSource, Work};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::output::reject_shared;
use crate::run::{self, Request};

/// Arguments of `sextant run`.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The scenario.
    #[command(flatten)]
    pub source: ScenarioSource,
    /// The recording to write [default: SCENARIO.mcap in the working folder]
    #[arg(long, value_name = "RUN.mcap")]
    pub out: Option<PathBuf>,
    /// Also write frames to this file, for Wireshark: all frames on air, or only those that one robot receives if the
    /// scenario names it in recording.pcap.robot
    #[arg(long, value_name = "FILE.pcap")]
    pub pcap: Option<PathBuf>,
    /// Where the results go.
    #[command(flatten)]
    pub results: Results,
    /// How the work is done.
    #[command(flatten)]
    pub work: Work,
}

impl Arguments {
    /// The file of the recording.
    #[must_use]
    pub fn recording(&self) -> PathBuf {
        let default = || PathBuf::from(self.source.scenario.file_name().unwrap_or_default()).with_extension("mcap");
        self.out.clone().unwrap_or_else(default)
    }
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    arguments.work.start_threads()?;
    let scenario = arguments.source.load()?;
    let recording = arguments.recording();
    reject_shared(&[
        ("--out", Some(&recording)),
        ("--summary", arguments.results.summary.as_ref()),
        ("--pcap", arguments.pcap.as_ref()),
    ])?;
    let request = Request { recording: &recording, pcap: arguments.pcap.as_deref(), quiet: arguments.work.quiet };
    let summary = run::record(&scenario, request, interrupt)?;
    arguments.results.tell(&summary)?;
    if summary.interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}
