//! The simulation of an application.

use std::sync::Arc;

use sextant_apps::navigation::NavigationMap;
use sextant_apps::source_seeking::{SeekRecord, SeekTeam};
use sextant_apps::target_search::{SearchRecord, SearchTeam};
use sextant_scenario::{Application, Scenario, Task};
use sextant_sim::{
    Applications, Network, Observer, ReadySimulation, Robot, RobotBody, RobotTask, Setup, Survey, TrafficPlan,
};

use super::maps::WorkingMap;
use crate::run::error::RunError;

/// The simulation of an application, ready to run.
pub(super) enum Prepared {
    Search(ReadySimulation<'static, Applications<SearchRecord>>),
    Seek(ReadySimulation<'static, Applications<SeekRecord>>),
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
        let radio = radio.clone();
        let own = |body: &RobotBody| Robot { body: body.clone(), task: RobotTask::Own };
        let robots = bodies.iter().map(own).collect();
        let (nodes, sinks, targets) = (nodes.len(), whole.sinks.len(), whole.world.targets.len());
        let setup = Setup { networks, robots, duration: Some(application.duration), ..whole };
        Ok(match &application.algorithm.task {
            Task::Search(search) => {
                let team = SearchTeam {
                    nodes,
                    robots: &bodies,
                    sinks,
                    targets,
                    network: application.network,
                    radio: &radio,
                    duration: application.duration,
                };
                Self::Search(search.simulation(&known, team, setup)?)
            }
            Task::Seek(seek) => {
                let network = application.network;
                let team = SeekTeam { nodes, robots: &bodies, sinks, network, tx_power: radio.tx_power() };
                Self::Seek(seek.simulation(&known, team, setup)?)
            }
        })
    }

    /// Runs it to its end, or until `observer` ends it.
    pub(super) fn run(self, observer: &mut impl Observer) -> (Survey, Records) {
        match self {
            Self::Search(simulation) => {
                let (survey, records) = simulation.run(observer);
                (survey, Records::Search(records))
            }
            Self::Seek(simulation) => {
                let (survey, records) = simulation.run(observer);
                (survey, Records::Seek(records))
            }
        }
    }
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
