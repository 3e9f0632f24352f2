//! Controllers of robots, also one that fails.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex};

use sextant::channel::Position;
use sextant::kernel::{SimTime, StationId, Work};
use sextant::recording::read_run;
use sextant::run::{RunStart, Simulator, SurveyEnd};
use sextant::sim::{CommandOutcome, Controller, Ending, Observer, RobotCommand, RobotTask, Situation, program_seed};
use sextant::{Programs, RunError, RunObserver, RunRecorder, Scenario, Summary, Watch};

use super::{results, robots_apart, shipped};

/// The controllers of a scenario as programs.
pub(crate) fn own_controllers(scenario: &Scenario) -> Programs<'static> {
    let mut programs = Programs::default();
    for robot in scenario.setup().robots {
        if let RobotTask::Survey(controller) = robot.task {
            programs = programs.with_controller(&robot.body.name, controller);
        }
    }
    programs
}

#[test]
fn controllers_of_the_scenario_given_back_change_no_octet() {
    let scenario = shipped("smoke.toml");
    assert_eq!(results(&scenario, own_controllers(&scenario)), results(&scenario, Programs::default()));
}

#[test]
fn own_controllers_of_robots_far_apart_change_no_octet() {
    let scenario = robots_apart();
    assert_eq!(results(&scenario, own_controllers(&scenario)), results(&scenario, Programs::default()));
}

/// A watch that a program stops.
#[derive(Debug, Default)]
struct Switch(AtomicBool);

impl Watch for Switch {
    fn begin(&self, _: Work) {}

    fn advance(&self, _: u64) {}

    fn is_stopped(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// What the observer was told of.
#[derive(Default)]
struct Told {
    begun: u32,
    survey_s: Option<f64>,
    is_interrupted: Option<bool>,
}

impl Observer for Told {}

impl RunObserver for Told {
    fn run_started(&mut self, _: &RunStart<'_>) -> Result<(), RunError> {
        self.begun += 1;
        Ok(())
    }

    fn survey_finished(&mut self, end: &SurveyEnd<'_>) -> Result<(), RunError> {
        self.survey_s = Some(end.simulated.survey.end.as_secs_f64());
        Ok(())
    }

    fn run_finished(&mut self, summary: &Summary) -> Result<(), RunError> {
        self.is_interrupted = Some(summary.interrupted);
        Ok(())
    }
}

/// Fails at its third stop, and says so by the switch.
#[derive(Clone)]
struct Failing {
    rest: Box<dyn Controller>,
    switch: Arc<Switch>,
    decisions: u32,
    error: Arc<Mutex<Option<String>>>,
    failed_ns: Arc<AtomicU64>,
}

impl Controller for Failing {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        self.decisions += 1;
        if self.decisions == 9 {
            *self.error.lock().expect("a lock") = Some("division by zero".to_owned());
            self.failed_ns.store(situation.time.as_nanos(), Ordering::Relaxed);
            self.switch.0.store(true, Ordering::Relaxed);
        }
        self.rest.decide(situation)
    }
}

#[test]
fn a_program_that_fails_ends_the_run_and_its_recording_is_readable() {
    let scenario = shipped("smoke.toml");
    let RobotTask::Survey(rest) = scenario.setup().robots.remove(0).task else { panic!("a robot that surveys") };
    let (switch, error, failed_ns) = (Arc::default(), Arc::default(), Arc::default());
    let failing = Failing {
        rest,
        switch: Arc::clone(&switch),
        decisions: 0,
        error: Arc::clone(&error),
        failed_ns: Arc::clone(&failed_ns),
    };
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let mut observer = (RunRecorder::new(&path), Told::default());
    let programs = Programs::default().with_controller("surveyor", Box::new(failing));
    let run = sextant::run_with(&scenario, programs, &mut observer, &*switch).expect("what was done until then");
    assert_eq!(error.lock().unwrap().as_deref(), Some("division by zero"));
    let Told { begun, survey_s, is_interrupted } = observer.1;
    assert_eq!((begun, is_interrupted), (1, Some(true)));
    let failed_s = SimTime::from_nanos(failed_ns.load(Ordering::Relaxed)).as_secs_f64();
    let ended_s = survey_s.unwrap();
    assert!(failed_s > 0.0 && ended_s >= failed_s && ended_s < failed_s + 5.0, "{failed_s} s, {ended_s} s");
    assert!(run.summary().interrupted && run.survey().unwrap().interrupted && run.maps().is_empty());
    let recorded = read_run(&path).expect("a readable recording");
    assert_eq!(recorded.log().stops(), run.survey().unwrap().log().stops());
    assert!(!recorded.log().stops().is_empty());
}

/// Drives north and then finishes; keeps what it knew at its last decision.
#[derive(Clone)]
struct Curious(Arc<Mutex<Option<(u128, bool, f64)>>>);

impl Controller for Curious {
    fn decide(&mut self, situation: &Situation<'_>) -> RobotCommand {
        let knows = (situation.program_seed(), situation.sweeps_sectors(), situation.heading_rad);
        *self.0.lock().expect("a lock") = Some(knows);
        match situation.outcome {
            CommandOutcome::Started => RobotCommand::Drive(situation.position + Position::new(0.0, 0.5, 0.0)),
            _ => RobotCommand::Finish(Ending::Complete),
        }
    }
}

#[test]
fn a_controller_knows_its_heading_its_seed_and_whether_it_sweeps() {
    for (name, sweeps) in [("smoke.toml", false), ("mmtm/two-bands.toml", true)] {
        let scenario = shipped(name);
        let robot = scenario.robots_of_survey().next().expect("a robot").name.clone();
        let known = Arc::default();
        let programs = Programs::default().with_controller(&robot, Box::new(Curious(Arc::clone(&known))));
        let survey = Simulator::with(&scenario, programs).unwrap().run(&mut ()).survey;
        let (seed, knows_sweeps, heading_rad) = known.lock().unwrap().take().expect("it decided");
        let station = StationId::from_index(scenario.world().nodes.len());
        assert_eq!((seed, knows_sweeps), (program_seed(scenario.seed(), station), sweeps), "{name}");
        assert!((heading_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{heading_rad}");
        assert_eq!(survey.robots[0].ending, Some(Ending::Complete));
    }
}
