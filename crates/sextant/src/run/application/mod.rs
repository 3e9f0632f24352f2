//! Applications on maps of the nodes: each is a separate simulation.

mod maps;
mod score;
mod simulate;
mod summary;

use sextant_apps::MissionOutcome;
use sextant_kernel::{SimTime, Watch};
use sextant_scenario::{Application, Scenario};
use sextant_sim::{Observer, ReadySimulation, Survey};

use super::error::RunError;
use super::stop::Stop;
use super::witness::Witness;
use crate::summary::ApplicationSummary;

use maps::WorkingMap;
use simulate::prepared;

pub use maps::UnalignedMap;
pub(super) use score::{Scored, distances_to_target};

/// What an application gets from the stages before it.
pub(super) struct Stage<'a> {
    pub(super) scenario: &'a Scenario,
    /// The maps that were computed; an application uses one of them.
    pub(super) made: &'a [&'a UnalignedMap],
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

/// An application that is ready to run on its map.
pub(super) struct ReadyApplication<'a> {
    scenario: &'a Scenario,
    application: &'a Application,
    map: WorkingMap,
    simulation: ReadySimulation<'static, MissionOutcome>,
}

impl<'a> ReadyApplication<'a> {
    /// The application on one of the maps of the stage.
    pub(super) fn new(stage: &Stage<'a>, application: &'a Application) -> Result<Self, RunError> {
        let Stage { scenario, made, survey, .. } = *stage;
        let map = WorkingMap::of(scenario, application, made)?;
        let simulation = prepared(scenario, application, &map, survey)?;
        Ok(Self { scenario, application, map, simulation })
    }

    /// The names of its robots.
    pub(super) fn robots(&self) -> Vec<String> {
        let robots = self.application.robots.iter();
        robots.map(|&robot| self.scenario.bodies()[robot].name.clone()).collect()
    }

    /// Runs it. Returns what its simulation left behind, and what happened in it.
    pub(super) fn run(self, observer: &mut impl Observer, watch: &dyn Watch) -> (Survey, Performance) {
        let Self { scenario, application, map, simulation } = self;
        let mut witness = Witness::new(scenario, application.robots.len());
        let (survey, outcome) = simulation.run(&mut (observer, (&mut witness, Stop(watch))));
        let scored = score::score(&witness, scenario.world().nodes.len(), &map.placement);
        let summary = summary::sum_up(scenario, application, &map, (&survey, outcome), (&witness, &scored));
        let performance = Performance { summary, end: survey.end, witness, scored };
        (survey, performance)
    }
}
