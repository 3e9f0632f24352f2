//! Applications on maps of the nodes: each is a separate simulation.

mod maps;
mod score;
mod simulate;
mod summary;

use sextant_kernel::{SimTime, Watch};
use sextant_sim::Survey;

use super::error::RunError;
use super::observer::{ApplicationEnd, RunObserver, SimulationStart};
use super::stop::Stop;
use super::witness::Witness;
use crate::scenario::{Application, Scenario};
use crate::summary::ApplicationSummary;

use maps::GivenMap;
use simulate::Prepared;

pub use maps::MadeMap;
pub(super) use score::{Scored, distances_to_target};

/// What an application gets from the stages before it.
pub(super) struct Stage<'a> {
    pub(super) scenario: &'a Scenario,
    /// The maps that were computed; an application uses one of them.
    pub(super) made: &'a [&'a MadeMap],
    /// The survey, where the robots start at its end.
    pub(super) survey: Option<&'a Survey>,
    /// Time 0 of the application in the whole run.
    pub(super) start: SimTime,
}

/// An application that was run: what happened, and what it worked out.
#[derive(Clone, Debug)]
pub struct Performance {
    /// Its summary.
    pub summary: ApplicationSummary,
    /// When its simulation ended.
    pub end: SimTime,
    pub(super) witness: Witness,
    pub(super) scored: Vec<Scored>,
}

/// Runs an application on one of the maps.
pub(super) fn perform(
    stage: &Stage<'_>,
    application: &Application,
    observer: &mut dyn RunObserver,
    watch: &dyn Watch,
) -> Result<Performance, RunError> {
    let Stage { scenario, made, survey, start } = *stage;
    let map = GivenMap::of(scenario, application, made)?;
    let prepared = Prepared::new(scenario, application, &map, survey)?;
    let robots: Vec<String> = application.robots.iter().map(|&robot| scenario.bodies()[robot].name.clone()).collect();
    observer.simulation_started(&SimulationStart {
        scenario,
        application: Some(application),
        robots: &robots,
        start,
    })?;
    let mut witness = Witness::new(scenario, robots.len());
    let (survey, records) = prepared.run(&mut (&mut *observer, (&mut witness, Stop(watch))))?;
    let scored = score::score(&witness, scenario.world().nodes.len(), &map.placement);
    let summary = summary::sum_up(scenario, application, &map, (&survey, &records), (&witness, &scored));
    let performance = Performance { summary, end: survey.end, witness, scored };
    let end = ApplicationEnd { scenario, application, start, survey: &survey, performance: &performance };
    observer.application_finished(&end)?;
    Ok(performance)
}
