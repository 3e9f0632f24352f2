//! `sextant explain-link`: why a station hears another one, or not.

use std::io::Write;
use std::path::PathBuf;

use clap::Args;

use super::options::{Overrides, Printing};
use crate::diagnostic::Failure;
use crate::terminal::stdout;
use sextant::explain_link;
use sextant::link::rays_csv;
use sextant::scenario::Scenario;

/// Arguments of `sextant explain-link`.
#[derive(Clone, Debug, Args)]
pub(crate) struct Arguments {
    /// The scenario file
    #[arg(value_name = "SCENARIO.toml")]
    pub(crate) scenario: PathBuf,
    /// One end: the name of a node, a robot (at its start) or a sink, or a place x,y or x,y,z in metres
    #[arg(value_name = "A", allow_hyphen_values = true)]
    pub(crate) from: String,
    /// The other end
    #[arg(value_name = "B", allow_hyphen_values = true)]
    pub(crate) to: String,
    /// Name of the network, if there are several [default: the first one that both are in]
    #[arg(long, value_name = "NAME")]
    pub(crate) network: Option<String>,
    /// Random seed, which shadowing is drawn from; overrides that of the scenario
    #[arg(long, value_name = "N")]
    pub(crate) seed: Option<u64>,
    /// Print the rays from A to B alone, as comma-separated values
    #[arg(long, conflicts_with = "format")]
    pub(crate) rays: bool,
    /// Settings that override those of the scenario.
    #[command(flatten)]
    pub(crate) overrides: Overrides,
    /// How results are printed.
    #[command(flatten)]
    pub(crate) printing: Printing,
}

pub(crate) fn execute(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { scenario, from, to, network, seed, rays, overrides, printing } = arguments;
    let scenario = Scenario::load_with(scenario, &overrides.set, *seed)?;
    let report = explain_link(&scenario, from, to, network.as_deref())?;
    if *rays {
        let rays = report.rays.unwrap_or_default();
        return Ok(stdout().write_all(rays_csv(&rays).as_bytes())?);
    }
    Ok(printing.print(&report, |stdout| write!(stdout, "{report}"))?)
}
