//! The simulation of an application.

use std::sync::Arc;

use sextant_apps::navigation::NavigationMap;
use sextant_apps::source_seeking::{SeekRecord, SeekStation, SeekTeam};
use sextant_apps::target_search::{SearchRecord, SearchStation, SearchTeam};
use sextant_scenario::{Application, Scenario, Task};
use sextant_sim::{
    Applications, Network, Observer, Robot, RobotBody, RobotTask, Setup, Simulation, Survey, TrafficPlan,
};

use super::maps::WorkingMap;
use crate::run::error::RunError;

/// An application, ready to run.
pub(super) struct Prepared {
    setup: Setup,
    stations: Stations,
}

/// The applications of all stations.
enum Stations {
    Search(Applications<SearchStation>),
    Seek(Applications<SeekStation>),
}

/// What the stations leave behind.
pub(super) enum Records {
    Search(Applications<SearchRecord>),
    Seek(Applications<SeekRecord>),
}

impl Prepared {
    /// The simulation of `application` on its map. Robots that have surveyed start where the `survey` ended for them.
    pub(super) fn new(
        scenario: &Scenario,
        application: &Application,
        map: &WorkingMap,
        survey: Option<&Survey>,
    ) -> Result<Self, RunError> {
        let whole = scenario.setup();
        let bodies: Vec<RobotBody> =
            application.robots.iter().map(|&robot| body(&scenario.bodies()[robot], application, survey)).collect();
        let nodes = &whole.world.nodes;
        let traffic = TrafficPlan::silent(nodes.len());
        let networks = whole.networks.into_iter().map(|network| Network { traffic: traffic.clone(), ..network });
        let networks: Vec<Network> = networks.collect();
        let known = NavigationMap::new(map.places.clone(), map.frame).map(Arc::new);
        let known = known.expect("a map with fewer than three places is refused before");
        let radio = networks[application.network.index()].technology.ieee802154();
        let radio = &radio.expect("the check of the scenario refuses applications over other technologies").radio;
        let stations = match &application.algorithm.task {
            Task::Search(search) => {
                let team = SearchTeam {
                    nodes: nodes.len(),
                    robots: &bodies,
                    sinks: whole.sinks.len(),
                    targets: whole.world.targets.len(),
                    network: application.network,
                    radio,
                    duration: application.duration,
                };
                Stations::Search(search.stations(&known, team))
            }
            Task::Seek(seek) => {
                let team = SeekTeam {
                    nodes: nodes.len(),
                    robots: &bodies,
                    sinks: whole.sinks.len(),
                    network: application.network,
                    tx_power: radio.tx_power(),
                };
                Stations::Seek(seek.stations(&known, team))
            }
        };
        let robots = bodies.into_iter().map(|body| Robot { body, task: RobotTask::Own }).collect();
        let setup = Setup { networks, robots, duration: Some(application.duration), ..whole };
        Ok(Self { setup, stations })
    }

    /// Runs it to its end, or until `observer` ends it.
    pub(super) fn run(self, observer: &mut impl Observer) -> Result<(Survey, Records), RunError> {
        match self.stations {
            Stations::Search(stations) => {
                let (survey, records) = run(self.setup, stations, SearchStation::into_record, observer)?;
                Ok((survey, Records::Search(records)))
            }
            Stations::Seek(stations) => {
                let (survey, records) = run(self.setup, stations, SeekStation::into_record, observer)?;
                Ok((survey, Records::Seek(records)))
            }
        }
    }
}

/// Runs a simulation of `stations`, and returns what each leaves behind.
fn run<S: sextant_sim::Application, R>(
    setup: Setup,
    stations: Applications<S>,
    into_record: fn(S) -> R,
    observer: &mut impl Observer,
) -> Result<(Survey, Applications<R>), RunError> {
    let simulation = Simulation::with(setup, stations)?;
    let (survey, Applications { nodes, robots, sinks }) = simulation.run_own(observer);
    let records = |stations: Vec<S>| stations.into_iter().map(into_record).collect();
    let records = Applications { nodes: records(nodes), robots: records(robots), sinks: records(sinks) };
    Ok((survey, records))
}

/// The body of a robot in the network of the application, where it starts.
fn body(body: &RobotBody, application: &Application, survey: Option<&Survey>) -> RobotBody {
    let ended = survey.and_then(|survey| survey.robots.iter().find(|robot| robot.name == body.name));
    let networks = vec![application.network];
    match ended {
        None => RobotBody { networks, ..body.clone() },
        Some(ended) => RobotBody {
            networks,
            start: ended.end_pose.truth.position,
            believed_start: ended.end_pose.believed_start(),
            ..body.clone()
        },
    }
}
