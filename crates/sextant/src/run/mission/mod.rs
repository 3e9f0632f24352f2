//! Missions on maps of the nodes: each is a separate simulation.

mod maps;
mod score;
mod simulate;
mod summary;

use sextant_apps::MissionOutcome;
use sextant_kernel::{SimTime, Watch};
use sextant_scenario::{PlannedMission, Scenario};
use sextant_sim::{Observer, ReadySimulation, Survey};

use super::error::RunError;
use super::stop::Stop;
use super::witness::Witness;
use crate::summary::MissionSummary;

use maps::WorkingMap;
use simulate::prepared;

pub use maps::UnalignedMap;
pub(super) use score::{Scored, distances_to_target};

/// What a mission gets from the stages before it.
pub(super) struct Stage<'a> {
    pub(super) scenario: &'a Scenario,
    /// The maps that were computed; a mission uses one of them.
    pub(super) made: &'a [&'a UnalignedMap],
    /// The survey, where the robots start at its end.
    pub(super) survey: Option<&'a Survey>,
    /// Time 0 of the mission in the whole run.
    pub(super) start: SimTime,
}

/// A mission that was run: what happened, and what it worked out.
#[derive(Clone, Debug)]
pub struct Performance {
    /// Its summary.
    pub summary: MissionSummary,
    /// When its simulation ended.
    pub end: SimTime,
    pub(super) witness: Witness,
    pub(super) scored: Vec<Scored>,
}

/// A mission that is ready to run on its map.
pub(super) struct ReadyMission<'a> {
    scenario: &'a Scenario,
    mission: &'a PlannedMission,
    map: WorkingMap,
    simulation: ReadySimulation<'static, MissionOutcome>,
}

impl<'a> ReadyMission<'a> {
    /// The mission on one of the maps of the stage.
    pub(super) fn new(stage: &Stage<'a>, mission: &'a PlannedMission) -> Result<Self, RunError> {
        let Stage { scenario, made, survey, .. } = *stage;
        let map = WorkingMap::of(scenario, mission, made)?;
        let simulation = prepared(scenario, mission, &map, survey)?;
        Ok(Self { scenario, mission, map, simulation })
    }

    /// The names of its robots.
    pub(super) fn robots(&self) -> Vec<String> {
        let robots = self.mission.robots.iter();
        robots.map(|&robot| self.scenario.bodies()[robot].name.clone()).collect()
    }

    /// Runs it. Returns what its simulation left behind, and what happened in it.
    pub(super) fn run(self, observer: &mut impl Observer, watch: &dyn Watch) -> (Survey, Performance) {
        let Self { scenario, mission, map, simulation } = self;
        let mut witness = Witness::new(scenario, mission.robots.len());
        let (survey, outcome) = simulation.run(&mut (observer, (&mut witness, Stop(watch))));
        let scored = score::score(&witness, scenario.world().nodes.len(), &map.placement);
        let summary = summary::sum_up(scenario, mission, &map, &survey, outcome, &witness, &scored);
        let performance = Performance { summary, end: survey.end, witness, scored };
        (survey, performance)
    }
}
