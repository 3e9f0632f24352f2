//! `sextant run`: simulate, record, map, measure.

use std::path::PathBuf;

use clap::Args;

use super::options::{Results, ScenarioSource, Work};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::output::refuse_shared;
use crate::run::{self, Request};

/// What `sextant run` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// The scenario.
    #[command(flatten)]
    pub source: ScenarioSource,
    /// Where the recording goes; SCENARIO.mcap in the working folder if absent
    #[arg(long, value_name = "RUN.mcap")]
    pub out: Option<PathBuf>,
    /// Also write the frames to this file, for Wireshark: all on air, or those that the robot hears that the
    /// scenario names as recording.pcap.robot
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
    /// Where the recording goes.
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
    refuse_shared(&[
        ("--out", Some(&recording)),
        ("--summary", arguments.results.summary.as_ref()),
        ("--pcap", arguments.pcap.as_ref()),
    ])?;
    let request = Request { recording: &recording, pcap: arguments.pcap.as_deref(), quiet: arguments.work.quiet };
    let summary = run::record(&scenario, request, interrupt)?;
    arguments.results.tell(&summary)?;
    if summary.interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}
