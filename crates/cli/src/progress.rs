//! The progress of a run on the terminal, as an observer.

use std::time::Duration;

use sextant::run::{MissionEnd, RunError, RunObserver, SimulationStart, SurveyEnd};
use sextant::scenario::MissionGoal;
use sextant_sim::Observer;

use crate::terminal::{ProgressBar, Watcher};

/// Shows how far the simulations of a run are.
pub(crate) struct RunProgress<'a> {
    /// Shows the rest of the work; its bar makes room.
    watcher: &'a Watcher<'a>,
    is_quiet: bool,
    bar: Option<(ProgressBar, Shown)>,
}

/// What the bar shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shown {
    /// Nodes heard by robots.
    NodesHeard,
    /// Simulated seconds, and packets.
    Packets,
    /// Simulated seconds, and messages of nodes that compute a map.
    Messages {
        /// Whether robots take part.
        has_robots: bool,
    },
    /// Simulated seconds of an application.
    Seconds,
}

impl<'a> RunProgress<'a> {
    /// The progress of a run that has not begun, whose other work `watcher` shows.
    pub(crate) fn new(watcher: &'a Watcher<'a>, is_quiet: bool) -> Self {
        Self { watcher, is_quiet, bar: None }
    }

    fn clear(&mut self) {
        if let Some((bar, _)) = self.bar.take() {
            bar.clear();
        }
    }
}

/// What the bar of a simulation is called, how many steps it has, and what it shows.
fn of_simulation(start: &SimulationStart<'_>) -> (&'static str, u64, Shown) {
    let scenario = start.scenario;
    if let Some(application) = start.mission {
        let name = match application.goal() {
            MissionGoal::Targets => "searching",
            MissionGoal::Field(_) => "seeking",
            MissionGoal::Link => "keeping a link",
            MissionGoal::Other => "working",
        };
        return (name, application.duration.as_secs(), Shown::Seconds);
    }
    let duration = scenario.config().duration_s.map(Duration::from_secs_f64);
    if let Some(map) = scenario.distributed() {
        // Nodes know when they have computed a map at the latest.
        let end = duration.map_or(map.longest(), |duration| duration.min(map.longest()));
        return ("in nodes", end.as_secs(), Shown::Messages { has_robots: !start.robots.is_empty() });
    }
    // Without robots, the end is a time.
    match duration.filter(|_| start.robots.is_empty()) {
        Some(end) => ("simulating", end.as_secs(), Shown::Packets),
        None => ("gathering", scenario.world().nodes.len() as u64, Shown::NodesHeard),
    }
}

impl Observer for RunProgress<'_> {
    fn goes_on(&mut self, progress: sextant_sim::Progress) -> bool {
        let Some((bar, shown)) = &self.bar else { return true };
        let whole_seconds = progress.time.as_nanos() / 1_000_000_000;
        match shown {
            Shown::Packets => {
                bar.set(whole_seconds, format!("s simulated, {} packets offered", progress.packets_offered));
            }
            Shown::Messages { has_robots } => {
                let stops = if *has_robots { format!(", {} stops", progress.stops) } else { String::new() };
                let note = format!("s simulated at most, {} messages{stops}", progress.packets_offered);
                bar.set(whole_seconds, note);
            }
            Shown::Seconds => bar.set(whole_seconds, "s simulated at most".to_owned()),
            Shown::NodesHeard => {
                let seconds = progress.time.as_secs_f64();
                let note = format!("nodes heard, {} stops, {seconds:.0} s simulated", progress.stops);
                bar.set(progress.nodes_heard as u64, note);
            }
        }
        true
    }
}

impl RunObserver for RunProgress<'_> {
    fn simulation_started(&mut self, start: &SimulationStart<'_>) -> Result<(), RunError> {
        self.watcher.clear();
        let (name, steps, shown) = of_simulation(start);
        self.bar = Some((ProgressBar::new(name, steps, self.is_quiet), shown));
        Ok(())
    }

    fn survey_finished(&mut self, _end: &SurveyEnd<'_>) -> Result<(), RunError> {
        self.clear();
        Ok(())
    }

    fn mission_finished(&mut self, _end: &MissionEnd<'_>) -> Result<(), RunError> {
        self.clear();
        Ok(())
    }
}
