//! The run of one unit of a sweep.

use sextant_sim::{Observer, Progress};

use super::plan::{Plan, Unit};
use super::row::Row;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::run::{self, Simulated, Simulator};
use crate::scenario::{Scenario, ScenarioErrors};

/// The rows of `unit`; `None` if the user interrupts.
pub(super) fn run(plan: &Plan, unit: &Unit, interrupt: &Interrupt) -> Option<Vec<Row>> {
    let mut gathered: Option<(Simulated, Option<f64>)> = None;
    let mut rows = Vec::with_capacity(unit.cells.len());
    for &cell in &unit.cells {
        let outcome = plan.scenario(cell, unit.replicate).map_err(message).and_then(|scenario| {
            if gathered.is_none() {
                let simulated = gather(&scenario, interrupt)?;
                // All cells of the unit have the same world, so they share the bound.
                let bound_m = run::bound_m(&scenario, &simulated.survey, interrupt);
                gathered = Some((simulated, bound_m.map_err(|error| error.to_string())?));
            }
            let (simulated, bound_m) = gathered.as_ref().expect("the survey was just made");
            measured(plan, &scenario, simulated, *bound_m, interrupt)
        });
        if interrupt.is_requested() {
            return None;
        }
        rows.push(Row { cell, replicate: unit.replicate, outcome });
    }
    Some(rows)
}

fn gather(scenario: &Scenario, interrupt: &Interrupt) -> Result<Simulated, String> {
    let simulator = Simulator::new(scenario).map_err(|error| error.to_string())?;
    Ok(simulator.run(&mut Watch { interrupt }))
}

/// The values of all measures of `plan`.
fn measured(
    plan: &Plan,
    scenario: &Scenario,
    simulated: &Simulated,
    bound_m: Option<f64>,
    interrupt: &Interrupt,
) -> Result<Vec<Option<f64>>, String> {
    let discoveries = run::Discoveries::of(scenario, interrupt).map_err(|failure| reason(&failure))?;
    let survey = &simulated.survey;
    let distributed = run::evaluate_distributed(scenario, simulated);
    let mut maps: Vec<_> = distributed.into_iter().map(|evaluation| evaluation.summary).collect();
    for named in scenario.maps() {
        let evaluation = run::evaluate(scenario, named, (survey, &discoveries), bound_m, interrupt);
        maps.push(evaluation.map_err(|failure| reason(&failure))?.summary);
    }
    let summary = run::sum_up(scenario, survey, &discoveries, maps);
    Ok(plan.measures().iter().map(|measure| measure.of(&summary)).collect())
}

fn message(errors: ScenarioErrors) -> String {
    errors.to_string()
}

fn reason(failure: &Failure) -> String {
    match failure {
        Failure::BadInput(reports) => reports.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        Failure::Failed(report) => report.to_string(),
        Failure::Interrupted | Failure::Unread => "interrupted".to_owned(),
    }
}

/// Stops a simulation when the user interrupts.
struct Watch<'a> {
    interrupt: &'a Interrupt,
}

impl Observer for Watch<'_> {
    fn goes_on(&mut self, _progress: Progress) -> bool {
        !self.interrupt.is_requested()
    }
}
