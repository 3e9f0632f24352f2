//! The stages of a run: discover, simulate, map, measure, apply, summarise.

use sextant_kernel::{SimTime, Watch};
use sextant_recording::Phase;
use sextant_scenario::{PlannedMission, Scenario};
use sextant_sim::{Reached, Snapshot, Survey};

use super::bound::LazyBound;
use super::discovery::Discoveries;
use super::distributed::evaluate_distributed;
use super::error::RunError;
use super::evaluation::{Evaluation, evaluate};
use super::mission::{Performance, ReadyMission, Stage, UnalignedMap};
use super::observer::{MapEnd, MissionEnd, RunObserver, RunStart, SimulationStart, SurveyEnd};
use super::outcome::sum_up;
use super::programs::Programs;
use super::simulator::{Simulated, Simulator};
use super::stop::Stop;
use crate::summary::{MapSummary, MissionSummary, Stopwatch, Summary, Timing, peak_rss_bytes};

/// A scenario that was run.
#[derive(Clone, Debug)]
pub struct Run {
    summary: Summary,
    survey: Option<Surveyed>,
    maps: Vec<Evaluation>,
}

impl Run {
    /// All results, as `sextant run --summary` writes them.
    #[must_use]
    pub fn summary(&self) -> &Summary {
        &self.summary
    }

    /// What the robots and anchors heard; `None` if the scenario has no survey.
    #[must_use]
    pub fn survey(&self) -> Option<&Survey> {
        self.survey.as_ref().map(|surveyed| &surveyed.simulated.survey)
    }

    /// The maps, each with what was estimated with it and its errors.
    #[must_use]
    pub fn maps(&self) -> &[Evaluation] {
        &self.maps
    }
}

/// A survey that was simulated, and the bound of its maps.
#[derive(Clone, Debug)]
pub struct Surveyed {
    /// What was heard, and what became of the packets.
    pub simulated: Simulated,
    /// The posterior bound for its maps (m), or why it does not apply.
    pub bound: LazyBound,
}

/// Runs `scenario`: simulates its survey, computes and measures its maps, and runs its missions. If `watch` stops the
/// work, the result is what was done until then, and its summary says `interrupted`.
///
/// # Errors
/// If parts of the scenario do not fit together, or `observer` fails.
pub fn run(scenario: &Scenario, observer: &mut dyn RunObserver, watch: &dyn Watch) -> Result<Run, RunError> {
    run_with(scenario, Programs::default(), observer, watch)
}

/// Runs `scenario` as [`run`] does, with controllers and applications of the caller's own in its survey.
///
/// # Errors
/// As for [`run`], and if a program cannot be given to its station.
pub fn run_with(
    scenario: &Scenario,
    programs: Programs<'_>,
    observer: &mut dyn RunObserver,
    watch: &dyn Watch,
) -> Result<Run, RunError> {
    StartedRun::new(scenario, programs, &mut *observer, watch)?.finish(observer)
}

/// A run whose survey is under way.
pub(super) struct StartedRun<'a> {
    scenario: &'a Scenario,
    watch: &'a dyn Watch,
    /// When the run began.
    begun: Stopwatch,
    discoveries: Discoveries,
    /// The survey; `None` if the scenario has none.
    simulator: Option<Simulator<'a>>,
}

impl<'a> StartedRun<'a> {
    /// Starts the run of `scenario`, up to the first instant of its survey.
    pub(super) fn new(
        scenario: &'a Scenario,
        programs: Programs<'a>,
        observer: &mut dyn RunObserver,
        watch: &'a dyn Watch,
    ) -> Result<Self, RunError> {
        let begun = Stopwatch::start();
        let has_survey = scenario.config().has_survey() || !programs.is_empty();
        let simulator = has_survey.then(|| Simulator::with(scenario, programs)).transpose()?;
        let discoveries = Discoveries::of(scenario, watch)?;
        observer.run_started(&RunStart { scenario, discoveries: &discoveries })?;
        if has_survey {
            start_survey(scenario, observer)?;
        }
        Ok(Self { scenario, watch, begun, discoveries, simulator })
    }

    /// Goes on with the survey until `time`.
    pub(super) fn until(&mut self, time: SimTime, observer: &mut dyn RunObserver) {
        if let Some(simulator) = &mut self.simulator {
            simulator.until(time, &mut (observer, Stop(self.watch)));
        }
    }

    /// How far the survey has gone; `None` if the scenario has none.
    pub(super) fn reached(&self) -> Option<Reached> {
        self.simulator.as_ref().map(Simulator::reached)
    }

    /// What it is like now.
    pub(super) fn snapshot(&self) -> Option<Snapshot> {
        self.simulator.as_ref().map(Simulator::snapshot)
    }

    /// Goes on to the end of the survey, and does what follows it.
    pub(super) fn finish(self, observer: &mut dyn RunObserver) -> Result<Run, RunError> {
        let Self { scenario, watch, begun, discoveries, simulator } = self;
        let simulated = simulator.map(|simulator| finish_survey(scenario, simulator, observer, watch)).transpose()?;
        let gather_s = begun.elapsed_s();
        let map_start = Stopwatch::start();
        let mut maps = Maps { scenario, discoveries: &discoveries, summaries: Vec::new(), evaluations: Vec::new() };
        let bound = LazyBound::default();
        let mut interrupted = false;
        if let Some(simulated) = &simulated {
            maps.of_nodes(simulated, observer, watch)?;
            let mapped = watch
                .check()
                .map_err(RunError::from)
                .and_then(|()| maps.of_robots(simulated, &bound, observer, watch));
            interrupted = is_interrupted(mapped)?;
        }
        let map_s = map_start.elapsed_s();
        let Maps { summaries, evaluations, .. } = maps;
        let survey = simulated.as_ref().map(|simulated| &simulated.survey);
        let mut applications = Vec::new();
        if !interrupted {
            (applications, interrupted) = apply_all(scenario, &evaluations, survey, observer, watch)?;
        }
        let mut summary =
            Summary { interrupted, ..sum_up(scenario, simulated.as_ref(), &discoveries, summaries, applications) };
        observer.run_finished(&summary)?;
        summary.timing = Some(Timing {
            wall_s: begun.elapsed_s(),
            gather_s: Some(gather_s),
            map_s: Some(map_s),
            events_per_s: survey.map(|survey| survey.events as f64 / gather_s),
            peak_rss_bytes: peak_rss_bytes(),
        });
        let survey = simulated.map(|simulated| Surveyed { simulated, bound });
        Ok(Run { summary, survey, maps: evaluations })
    }
}

/// Simulates the survey of `scenario` and nothing else; `None` if it has none. Scenarios with the same
/// [`survey_identity`](Scenario::survey_identity) share it: see [`run_on`].
///
/// # Errors
/// If parts of the scenario do not fit together, `observer` fails, or `watch` stops the work.
pub fn survey(
    scenario: &Scenario,
    observer: &mut dyn RunObserver,
    watch: &dyn Watch,
) -> Result<Option<Surveyed>, RunError> {
    if !scenario.config().has_survey() {
        return Ok(None);
    }
    let simulator = Simulator::new(scenario)?;
    start_survey(scenario, observer)?;
    let simulated = finish_survey(scenario, simulator, observer, watch)?;
    Ok(Some(Surveyed { simulated, bound: LazyBound::default() }))
}

/// The summary of `scenario` on a survey that was simulated before, without timing; what [`run`] does after its survey.
///
/// # Errors
/// As for [`run`], and if `watch` stops the work.
pub fn run_on(
    scenario: &Scenario,
    surveyed: Option<&Surveyed>,
    observer: &mut dyn RunObserver,
    watch: &dyn Watch,
) -> Result<Summary, RunError> {
    let discoveries = Discoveries::of(scenario, watch)?;
    let mut maps = Maps { scenario, discoveries: &discoveries, summaries: Vec::new(), evaluations: Vec::new() };
    if let Some(Surveyed { simulated, bound }) = surveyed {
        maps.of_nodes(simulated, observer, watch)?;
        maps.of_robots(simulated, bound, observer, watch)?;
    }
    let simulated = surveyed.map(|surveyed| &surveyed.simulated);
    let survey = simulated.map(|simulated| &simulated.survey);
    let (applications, interrupted) = apply_all(scenario, &maps.evaluations, survey, observer, watch)?;
    Ok(Summary { interrupted, ..sum_up(scenario, simulated, &discoveries, maps.summaries, applications) })
}

/// Whether work was stopped; other errors remain.
fn is_interrupted(outcome: Result<(), RunError>) -> Result<bool, RunError> {
    match outcome {
        Err(RunError::Interrupted(_)) => Ok(true),
        outcome => outcome.map(|()| false),
    }
}

/// Tells `observer` that the survey begins.
fn start_survey(scenario: &Scenario, observer: &mut dyn RunObserver) -> Result<(), RunError> {
    let robots: Vec<String> = scenario.robots_of_survey().map(|robot| robot.name.clone()).collect();
    observer.simulation_started(&SimulationStart { scenario, mission: None, robots: &robots, start: SimTime::ZERO })
}

/// Simulates the survey to its end.
fn finish_survey(
    scenario: &Scenario,
    simulator: Simulator<'_>,
    observer: &mut dyn RunObserver,
    watch: &dyn Watch,
) -> Result<Simulated, RunError> {
    let simulated = simulator.run(&mut (&mut *observer, Stop(watch)));
    observer.survey_finished(&SurveyEnd { scenario, simulated: &simulated })?;
    Ok(simulated)
}

/// The maps so far.
struct Maps<'a> {
    scenario: &'a Scenario,
    discoveries: &'a Discoveries,
    summaries: Vec<MapSummary>,
    evaluations: Vec<Evaluation>,
}

impl Maps<'_> {
    /// Adds the map that the nodes computed, if they did: also what they had when the work was stopped.
    fn of_nodes(
        &mut self,
        simulated: &Simulated,
        observer: &mut dyn RunObserver,
        watch: &dyn Watch,
    ) -> Result<(), RunError> {
        let discoveries = self.discoveries;
        let evaluation = evaluate_distributed(self.scenario, simulated);
        evaluation.map_or(Ok(()), |evaluation| {
            self.add(evaluation, |scenario, evaluation| {
                observer.map_finished(&MapEnd { scenario, simulated, discoveries, named: None, evaluation, watch })
            })
        })
    }

    /// Computes, measures and adds the maps of the scenario in order, until the work is stopped.
    fn of_robots(
        &mut self,
        simulated: &Simulated,
        bound: &LazyBound,
        observer: &mut dyn RunObserver,
        watch: &dyn Watch,
    ) -> Result<(), RunError> {
        let (scenario, discoveries) = (self.scenario, self.discoveries);
        for named in scenario.maps() {
            let evaluation = evaluate(scenario, named, &simulated.survey, discoveries, bound, watch)?;
            self.add(evaluation, |scenario, evaluation| {
                let named = Some(named);
                observer.map_finished(&MapEnd { scenario, simulated, discoveries, named, evaluation, watch })
            })?;
        }
        Ok(())
    }

    /// Keeps a map, and then shows it.
    fn add(
        &mut self,
        evaluation: Evaluation,
        show: impl FnOnce(&Scenario, &Evaluation) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        self.summaries.push(evaluation.summary.clone());
        self.evaluations.push(evaluation);
        show(self.scenario, self.evaluations.last().expect("it was just added"))
    }
}

/// Runs the missions one after the other, until the work is stopped. Returns their summaries, and whether it was.
fn apply_all(
    scenario: &Scenario,
    evaluations: &[Evaluation],
    survey: Option<&Survey>,
    observer: &mut dyn RunObserver,
    watch: &dyn Watch,
) -> Result<(Vec<MissionSummary>, bool), RunError> {
    let made: Vec<&UnalignedMap> = evaluations.iter().map(|evaluation| &evaluation.made).collect();
    let mut end = survey.map(|survey| survey.end);
    let mut summaries = Vec::new();
    for mission in scenario.missions() {
        if watch.is_stopped() {
            return Ok((summaries, true));
        }
        let start = end.map_or(SimTime::ZERO, Phase::start_after);
        let stage = Stage { scenario, made: &made, survey, start };
        let performance = perform(&stage, mission, observer, watch)?;
        end = Some(start + (performance.end - SimTime::ZERO));
        summaries.push(performance.summary);
    }
    let interrupted = summaries.iter().any(|summary| summary.interrupted);
    Ok((summaries, interrupted))
}

/// Runs a mission on one of the maps.
fn perform(
    stage: &Stage<'_>,
    mission: &PlannedMission,
    observer: &mut dyn RunObserver,
    watch: &dyn Watch,
) -> Result<Performance, RunError> {
    let Stage { scenario, start, .. } = *stage;
    let ready = ReadyMission::new(stage, mission)?;
    let robots = ready.robots();
    observer.simulation_started(&SimulationStart { scenario, mission: Some(mission), robots: &robots, start })?;
    let (survey, performance) = ready.run(&mut &mut *observer, watch);
    let end = MissionEnd { scenario, mission, start, survey: &survey, performance: &performance };
    observer.mission_finished(&end)?;
    Ok(performance)
}
