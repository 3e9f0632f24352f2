//! The run of one unit of a sweep.

use sextant_sim::{Observer, Progress};

use super::plan::{Plan, Unit};
use super::row::Row;
use crate::diagnostic::Failure;
use crate::interrupt::Interrupt;
use crate::run::{self, Simulated, Simulator};
use crate::scenario::{Scenario, ScenarioErrors};

/// The survey that cells share: its simulation, `None` if they have none, and the bound of its maps.
struct Gathered {
    simulated: Option<Simulated>,
    bound_m: Option<f64>,
}

/// The rows of `unit`; `None` if the user interrupts.
pub(super) fn run(plan: &Plan, unit: &Unit, interrupt: &Interrupt) -> Option<Vec<Row>> {
    let mut gathered: Option<Gathered> = None;
    let mut rows = Vec::with_capacity(unit.cells.len());
    for &cell in &unit.cells {
        let outcome = plan.scenario(cell, unit.replicate).map_err(message).and_then(|scenario| {
            if gathered.is_none() {
                gathered = Some(gather(&scenario, interrupt)?);
            }
            let gathered = gathered.as_ref().expect("the survey was just made");
            measured(plan, &scenario, gathered, interrupt)
        });
        if interrupt.is_requested() {
            return None;
        }
        rows.push(Row { cell, replicate: unit.replicate, outcome });
    }
    Some(rows)
}

fn gather(scenario: &Scenario, interrupt: &Interrupt) -> Result<Gathered, String> {
    if !scenario.config().has_survey() {
        return Ok(Gathered { simulated: None, bound_m: None });
    }
    let simulator = Simulator::new(scenario).map_err(|error| error.to_string())?;
    let simulated = simulator.run(&mut Watch { interrupt });
    // All cells of the unit have the same world, so they share the bound.
    let bound_m = run::bound_m(scenario, &simulated.survey, interrupt).map_err(|error| error.to_string())?;
    Ok(Gathered { simulated: Some(simulated), bound_m })
}

/// The values of all measures of `plan`.
fn measured(
    plan: &Plan,
    scenario: &Scenario,
    gathered: &Gathered,
    interrupt: &Interrupt,
) -> Result<Vec<Option<f64>>, String> {
    let discoveries = run::Discoveries::of(scenario, interrupt).map_err(|failure| reason(&failure))?;
    let survey = gathered.simulated.as_ref().map(|simulated| &simulated.survey);
    let distributed =
        gathered.simulated.as_ref().and_then(|simulated| run::evaluate_distributed(scenario, simulated));
    let mut evaluations: Vec<_> = distributed.into_iter().collect();
    if let Some(survey) = survey {
        for named in scenario.maps() {
            let evaluation = run::evaluate(scenario, named, (survey, &discoveries), gathered.bound_m, interrupt);
            evaluations.push(evaluation.map_err(|failure| reason(&failure))?);
        }
    }
    let (made, maps): (Vec<_>, Vec<_>) =
        evaluations.into_iter().map(|evaluation| (evaluation.made, evaluation.summary)).unzip();
    let applied = |application| run::apply(scenario, application, &made, survey, interrupt);
    let applications: Result<Vec<_>, _> = scenario.applications().iter().map(applied).collect();
    let applications = applications.map_err(|failure| reason(&failure))?;
    let summary = run::sum_up(scenario, survey, &discoveries, maps, applications);
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
