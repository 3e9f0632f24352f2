//! `sextant check`: checks scenario files without running them.

use std::io::{self, Write};
use std::path::PathBuf;

use clap::Args;

use super::options::Overrides;
use crate::diagnostic::{Failure, report};
use sextant::scenario::Scenario;
use sextant::sweep::Sweep;
use sextant_kernel::text::counted;

/// Arguments of `sextant check`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario files
    #[arg(value_name = "SCENARIO.toml", required = true)]
    pub(crate) scenarios: Vec<PathBuf>,
    /// Settings that override those of the scenarios.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let set = &arguments.overrides.set;
    let mut reports = Vec::new();
    for path in &arguments.scenarios {
        match Scenario::load_with(path, set, None) {
            Ok(scenario) if scenario.config().sweep.is_none() => {
                writeln!(io::stdout(), "ok {}: {}", scenario.name(), scenario.outline())?;
            }
            Ok(scenario) => match Sweep::read(path, set, None, None) {
                Ok(plan) => {
                    let cells = counted(plan.cells().len(), "cell");
                    writeln!(io::stdout(), "ok {}: {}, a sweep of {cells}", scenario.name(), scenario.outline())?;
                }
                Err(errors) => reports.extend(errors.errors().iter().map(report)),
            },
            Err(errors) => reports.extend(errors.errors().iter().map(report)),
        }
    }
    if reports.is_empty() { Ok(()) } else { Err(Failure::BadInput(reports)) }
}
