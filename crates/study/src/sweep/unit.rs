//! The run of one unit of a sweep.

use sextant::run::{RunError, Surveyed, run_on, survey};
use sextant::summary::Numbers;
use sextant_kernel::{Unreported, Watch};
use sextant_scenario::{Scenario, ScenarioErrors};

use super::plan::Sweep;
use super::row::RunRow;
use super::work_list::Unit;

/// The rows of `unit`; `None` if the work is stopped. Its cells share their survey.
pub(crate) fn run(plan: &Sweep, unit: &Unit, watch: &dyn Watch) -> Option<Vec<RunRow>> {
    let watch = &Unreported(watch);
    let mut surveyed: Option<Option<Surveyed>> = None;
    let mut rows = Vec::with_capacity(unit.cells.len());
    for &cell in &unit.cells {
        let outcome = plan.scenario(cell, unit.replicate).map_err(message).and_then(|scenario| {
            if surveyed.is_none() {
                surveyed = Some(survey(&scenario, &mut (), watch).map_err(reason)?);
            }
            measured(plan, &scenario, surveyed.as_ref().and_then(Option::as_ref), watch)
        });
        if watch.is_stopped() {
            return None;
        }
        rows.push(RunRow { cell, replicate: unit.replicate, outcome });
    }
    Some(rows)
}

/// The values of all measures of `plan`.
fn measured(
    plan: &Sweep,
    scenario: &Scenario,
    surveyed: Option<&Surveyed>,
    watch: &dyn Watch,
) -> Result<Vec<Option<f64>>, String> {
    let summary = run_on(scenario, surveyed, &mut (), watch).map_err(reason)?;
    let numbers = Numbers::of(&summary);
    Ok(plan.measures().iter().map(|measure| numbers.get(measure)).collect())
}

fn message(errors: ScenarioErrors) -> String {
    errors.to_string()
}

fn reason(error: RunError) -> String {
    error.to_string()
}
