//! Applications on maps of the nodes: each is a simulation of its own.

mod maps;
mod outputs;
mod score;
mod simulate;
mod summary;

use sextant_sim::Survey;

use super::witness::Witness;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::scenario::{Application, Scenario};
use crate::summary::ApplicationSummary;

use maps::GivenMap;
use simulate::Prepared;

pub use maps::MadeMap;
pub(super) use outputs::{Outputs, record};

/// Runs an application of `scenario` without recording it. It gets one of the maps that were `made`, and its robots start
/// where their `survey` ended.
///
/// # Errors
/// If its map has too few places, or parts of the scenario do not fit together.
pub fn apply(
    scenario: &Scenario,
    application: &Application,
    made: &[MadeMap],
    survey: Option<&Survey>,
    interrupt: &Interrupt,
) -> Result<ApplicationSummary, Failure> {
    let map = GivenMap::of(scenario, application, made)?;
    let prepared = Prepared::new(scenario, application, &map, survey)?;
    let mut witness = Witness::new(scenario, application.robots.len(), interrupt);
    let (survey, records) = prepared.run(&mut witness)?;
    let scored = score::score(&witness, scenario.world().nodes.len(), &map.placement);
    Ok(summary::sum_up(scenario, application, &map, (&survey, &records), (&witness, &scored)))
}
