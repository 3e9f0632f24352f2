//! `sextant run`: simulates a scenario, records it, computes its maps and measures them.

use std::path::PathBuf;

use clap::Args;

use super::live::LiveOptions;
use super::options::{Results, ScenarioSource, Work};
use super::outputs::{Replacing, admit, keep_logs, reads_scenario};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::live::{LiveView, Settings};
use sextant::forecast::warnings;
use sextant::run::{RunCapture, RunRecorder, run};
use sextant::scenario::DetailConfig;
use sextant_recording::admission::OutputKind;

use crate::progress::RunProgress;
use crate::terminal::{Watcher, warn};

/// Arguments of `sextant run`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario.
    #[command(flatten)]
    pub(crate) source: ScenarioSource,
    /// The recording to write [default: SCENARIO.mcap in the working folder]
    #[arg(long, value_name = "RUN.mcap")]
    pub(crate) out: Option<PathBuf>,
    /// Also write frames to this file, for Wireshark: all frames on air, or only those that one robot receives if the
    /// scenario names it in recording.pcap.robot
    #[arg(long, value_name = "FILE.pcap")]
    pub(crate) pcap: Option<PathBuf>,
    /// How the run is shown while it goes on.
    #[command(flatten)]
    pub(crate) live: LiveOptions,
    /// Where the results go.
    #[command(flatten)]
    pub(crate) results: Results,
    /// What may be replaced.
    #[command(flatten)]
    pub(crate) replacing: Replacing,
    /// How the work is done.
    #[command(flatten)]
    pub(crate) work: Work,
}

impl Arguments {
    /// The file of the recording.
    #[must_use]
    pub(crate) fn recording(&self) -> PathBuf {
        let default = || PathBuf::from(self.source.scenario.file_name().unwrap_or_default()).with_extension("mcap");
        self.out.clone().unwrap_or_else(default)
    }
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    arguments.work.start_threads()?;
    let scenario = arguments.source.load()?;
    scenario.check_grids()?;
    let recording = arguments.recording();
    let mut outputs = arguments.replacing.outputs();
    reads_scenario(&mut outputs, &scenario);
    outputs.writes("--out", &recording, OutputKind::Recording);
    if let Some(pcap) = &arguments.pcap {
        outputs.writes("--pcap", pcap, OutputKind::Capture);
    }
    arguments.results.among(&mut outputs);
    admit(&outputs, Some(arguments.work))?;
    let given = [("--pcap", arguments.pcap.as_deref()), ("--summary", arguments.results.summary.as_deref())];
    let given = given.into_iter().filter_map(|(flag, path)| Some((flag, path?)));
    keep_logs(None, given.chain([("--out", recording.as_path())]))?;
    if !arguments.work.quiet {
        warnings(&scenario).iter().for_each(|warning| warn(&warning.to_string()));
    }
    let nodes = scenario.world().nodes.len();
    if scenario.recording().detail.is_none() && DetailConfig::usual(nodes) == DetailConfig::Compact {
        let (what, keep) = (DetailConfig::DIFFERENCE, DetailConfig::KEEP);
        arguments
            .work
            .note(&format!("the recording of {nodes} nodes is compact: {what}; `--set {keep}` records all"));
    }
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let recorder = RunRecorder::new(&recording);
    let view = show(arguments, scenario.name(), interrupt)?;
    let recorder = match &view {
        Some(view) => recorder.with_relay(view.relay()),
        None => recorder,
    };
    let capture = arguments.pcap.as_deref().map(RunCapture::new);
    let mut observer = (recorder, (capture, RunProgress::new(&watcher, arguments.work.quiet)));
    let run = run(&scenario, &mut observer, &watcher)?;
    watcher.clear();
    if let Some(view) = view {
        view.finish(interrupt);
    }
    let summary = run.summary();
    arguments.results.tell(summary)?;
    if summary.interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}

/// Starts the live view, if there is to be one.
fn show(arguments: &Arguments, name: &str, interrupt: &Interrupt) -> Result<Option<LiveView>, Failure> {
    let LiveOptions { live, speed, port, host, paused } = &arguments.live;
    let Some(viewer) = *live else { return Ok(None) };
    let (host, port, name) = (host.clone(), *port, name.to_owned());
    let view =
        LiveView::start(&Settings { viewer, host, port, speed: speed.0, is_paused: *paused, name }, interrupt)?;
    arguments.work.note(&view.note(&arguments.live.host));
    Ok(Some(view))
}
