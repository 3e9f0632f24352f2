//! `sextant map`: from a reception log to maps.

use std::path::PathBuf;

use clap::Args;

use super::options::{Overrides, Results, Work};
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::mapping::{self, Input};
use crate::recording::SCENARIO_ATTACHMENT;
use crate::robot_log;
use crate::scenario::{AlgorithmName, MapSettings};
use crate::summary::Stopwatch;
use crate::terminal::Watcher;

/// What `sextant map` is told.
#[derive(Clone, Debug, Args)]
pub struct Arguments {
    /// A recording of `run`, or a folder with stops.csv and receptions.csv
    #[arg(value_name = "LOG")]
    pub log: PathBuf,
    /// How likely a packet is received over a distance: `fitted` (estimated from the log itself),
    /// trapezoid:p0=0.95,plateau_m=2,range_m=10[,floor=..,ceiling=..], or channel:exponent=..,sigma_db=..,
    /// tx_power_dbm=..,sensitivity_dbm=..[,max_range_m=..]. If absent, that of the scenario for a recording, `fitted`
    /// for a folder
    #[arg(long, value_name = "PROFILE")]
    pub profile: Option<String>,
    /// Make one map by this algorithm, with the settings that it has by itself, in place of the maps of a recording's
    /// scenario
    #[arg(long, value_enum, value_name = "ALGORITHM")]
    pub algorithm: Option<AlgorithmName>,
    /// Measure the maps against the true places: a CSV file with columns node,x_m,y_m,z_m. For a recording, the
    /// places that it holds if absent
    #[arg(long, value_name = "nodes.csv")]
    pub truth: Option<PathBuf>,
    /// Write the map to this file, with columns node,x_m,y_m,z_m,ties,infeasible and the entries of the covariance, if there is one. Further maps go to files beside it, named after them
    #[arg(long, value_name = "MAP.csv")]
    pub out: Option<PathBuf>,
    /// Settings that override those of the maps.
    #[command(flatten)]
    pub overrides: Overrides,
    /// Where the results go.
    #[command(flatten)]
    pub results: Results,
    /// How the work is done.
    #[command(flatten)]
    pub work: Work,
}

pub(crate) fn execute(arguments: &Arguments, interrupt: &Interrupt) -> Result<(), Failure> {
    let start = Stopwatch::start();
    arguments.work.start_threads()?;
    let mut input = Input::read(&arguments.log)?;
    let name = format!("{} of {}", SCENARIO_ATTACHMENT, arguments.log.display());
    let scenario = input.scenario.as_deref().map(|text| (name.as_str(), text));
    let set = &arguments.overrides.set;
    let settings = MapSettings::new(scenario, arguments.algorithm, arguments.profile.as_deref(), set)?;
    if let Some(path) = &arguments.truth {
        input.truth = Some(robot_log::read_truth(path)?);
    }
    let _keeper = interrupt.keep();
    let watcher = Watcher::new(interrupt, arguments.work.quiet);
    let summary = mapping::map(&mut input, &settings, arguments.out.as_deref(), start, &watcher)?;
    watcher.clear();
    for note in &input.notes {
        arguments.work.note(note);
    }
    arguments.results.tell(&summary)?;
    if summary.interrupted { Err(Failure::Interrupted) } else { Ok(()) }
}
