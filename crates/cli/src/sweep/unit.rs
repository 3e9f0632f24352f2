//! The run of one unit of a sweep.

use sextant_sim::{Observer, Progress, Simulation, Survey};

use super::plan::{Plan, Unit};
use super::row::Row;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::run;
use crate::scenario::{Scenario, ScenarioErrors};

/// The rows of `unit`; `None` if the user interrupts.
pub(super) fn run(plan: &Plan, unit: &Unit, interrupt: &Interrupt) -> Option<Vec<Row>> {
    let mut survey: Option<(Survey, Option<f64>)> = None;
    let mut rows = Vec::with_capacity(unit.cells.len());
    for &cell in &unit.cells {
        let outcome = plan.scenario(cell, unit.replicate).map_err(message).and_then(|scenario| {
            if survey.is_none() {
                let gathered = gather(&scenario, interrupt)?;
                // All cells of the unit have the same world, so they share the bound.
                let bound_m = run::bound_m(&scenario, &gathered, interrupt).map_err(|error| error.to_string())?;
                survey = Some((gathered, bound_m));
            }
            let (survey, bound_m) = survey.as_ref().expect("the survey was just made");
            measured(plan, &scenario, survey, *bound_m, interrupt)
        });
        if interrupt.is_requested() {
            return None;
        }
        rows.push(Row { cell, replicate: unit.replicate, outcome });
    }
    Some(rows)
}

fn gather(scenario: &Scenario, interrupt: &Interrupt) -> Result<Survey, String> {
    let simulation = Simulation::new(scenario.setup()).map_err(|error| error.to_string())?;
    Ok(simulation.run(&mut Watch { interrupt }))
}

/// The values of all measures of `plan`.
fn measured(
    plan: &Plan,
    scenario: &Scenario,
    survey: &Survey,
    bound_m: Option<f64>,
    interrupt: &Interrupt,
) -> Result<Vec<Option<f64>>, String> {
    let discoveries = run::Discoveries::of(scenario, interrupt).map_err(|failure| reason(&failure))?;
    let mut maps = Vec::new();
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
