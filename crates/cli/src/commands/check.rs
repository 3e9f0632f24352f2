//! `sextant check`: checks scenario files without running them, and says what follows from them.

mod forecast;

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use clap::Args;
use miette::Report;
use serde::Serialize;

use super::options::{Format, Overrides, Printing};
use crate::diagnostic::{Failure, report};
use crate::terminal::{stdout, warn};
use sextant::Forecast;
use sextant::forecast::warnings;
use sextant::scenario::{Scenario, ScenarioErrors, ScenarioFile};
use sextant_kernel::text::counted;
use sextant_study::sweep::Sweep;

/// Arguments of `sextant check`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario files
    #[arg(value_name = "SCENARIO.toml", required = true)]
    pub(crate) scenarios: Vec<PathBuf>,
    /// Also print what follows from each scenario: radio range, neighbours, channel load, path, packets, cost
    #[arg(short, long)]
    pub(crate) verbose: bool,
    /// Settings that override those of the scenarios.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// How the answer is printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
}

/// A valid scenario.
#[derive(Serialize)]
struct Valid {
    /// Its file; octets of its path that are no Unicode are replaced.
    file: String,
    name: String,
    outline: String,
    /// Number of cells of its sweep.
    #[serde(skip_serializing_if = "Option::is_none")]
    cells: Option<usize>,
    warnings: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    forecast: Option<Forecast>,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let mut reports = Vec::new();
    let mut valid = Vec::new();
    for path in &arguments.scenarios {
        match check(path, arguments) {
            Ok(scenario) => {
                scenario.warnings.iter().for_each(|warning| warn(&format!("{}: {warning}", path.display())));
                if matches!(arguments.printing.format, Format::Text) {
                    scenario.write(&mut stdout())?;
                }
                valid.push(scenario);
            }
            Err(errors) => reports.extend(errors),
        }
    }
    if matches!(arguments.printing.format, Format::Json) {
        arguments.printing.print(&valid, |_| Ok(()))?;
    }
    if reports.is_empty() { Ok(()) } else { Err(Failure::BadInput(reports)) }
}

/// Checks the scenario at `path` and all cells of its sweep.
fn check(path: &Path, arguments: &Arguments) -> Result<Valid, Vec<Report>> {
    let set = &arguments.overrides.set;
    let reports = |errors: &ScenarioErrors| errors.errors().iter().map(report).collect::<Vec<_>>();
    let scenario = Scenario::load_with(path, set, None).map_err(|errors| {
        let mut found = reports(&errors);
        // The scenario may be wrong in its sweep too.
        if let Err(of_sweep) = ScenarioFile::read(path).and_then(|file| file.axes(set)) {
            let is_new = |error: &&sextant::scenario::ScenarioError| {
                errors.errors().iter().all(|known| known.place() != error.place())
            };
            found.extend(of_sweep.errors().iter().filter(is_new).map(report));
        }
        found
    })?;
    scenario.check_grids().map_err(|errors| reports(&errors))?;
    let sweep = scenario.config().sweep.as_ref().map(|_| Sweep::read_replacing(path, set)).transpose();
    let sweep = sweep.map_err(|errors| reports(&errors))?;
    let left_out = sweep.as_ref().map_or_else(|| scenario.file().left_out(set), Sweep::left_out);
    let left_out = left_out.map_err(|errors| reports(&errors))?;
    Ok(Valid {
        file: path.to_string_lossy().into_owned(),
        name: scenario.name().to_owned(),
        outline: scenario.outline(),
        cells: sweep.map(|sweep| sweep.cells().len()),
        warnings: left_out.into_iter().chain(warnings(&scenario).iter().map(ToString::to_string)).collect(),
        forecast: arguments.verbose.then(|| Forecast::of(&scenario)),
    })
}

impl Valid {
    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let cells = self.cells.map_or(String::new(), |cells| format!(", a sweep of {}", counted(cells, "cell")));
        writeln!(out, "ok {}: {}{cells}", self.name, self.outline)?;
        self.forecast.as_ref().map_or(Ok(()), |forecast| forecast::write(forecast, out))
    }
}
