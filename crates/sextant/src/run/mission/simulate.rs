//! The simulation of a mission.

use std::sync::Arc;

use sextant_apps::navigation::NavigationMap;
use sextant_apps::{MissionOutcome, MissionTeam};
use sextant_scenario::{PlannedMission, Scenario};
use sextant_sim::{Network, ReadySimulation, Robot, RobotBody, RobotTask, Setup, Survey, TrafficPlan};

use super::maps::WorkingMap;
use crate::run::error::RunError;

/// The simulation of `mission` on its map, ready to run. Robots that have surveyed start where the `survey` ended for
/// them.
pub(super) fn prepared(
    scenario: &Scenario,
    mission: &PlannedMission,
    map: &WorkingMap,
    survey: Option<&Survey>,
) -> Result<ReadySimulation<'static, MissionOutcome>, RunError> {
    let whole = scenario.setup();
    let bodies: Vec<RobotBody> =
        mission.robots.iter().map(|&robot| body(&scenario.bodies()[robot], mission, survey)).collect();
    let nodes = &whole.world.nodes;
    let traffic = TrafficPlan::silent(nodes.len());
    let networks = whole.networks.into_iter().map(|network| Network { traffic: traffic.clone(), ..network });
    let networks: Vec<Network> = networks.collect();
    let known = NavigationMap::new(map.places.clone(), map.frame).map(Arc::new);
    let known = known.expect("a map with fewer than three places is refused before");
    let radio = networks[mission.network.index()].technology.ieee802154().map(|links| links.radio.clone());
    let own = |body: &RobotBody| Robot { body: body.clone(), task: RobotTask::Own };
    let robots = bodies.iter().map(own).collect();
    let team = MissionTeam {
        nodes: nodes.len(),
        robots: &bodies,
        sinks: whole.sinks.len(),
        targets: whole.world.targets.len(),
        network: mission.network,
        radio: radio.as_ref(),
        duration: mission.duration,
    };
    let setup = Setup { networks, robots, duration: Some(mission.duration), ..whole };
    Ok(Arc::clone(&mission.mission).prepare(&known, team, setup)?)
}

/// The body of a robot in the network of the mission, where it starts.
fn body(body: &RobotBody, mission: &PlannedMission, survey: Option<&Survey>) -> RobotBody {
    let ended = survey.and_then(|survey| survey.robots.iter().find(|robot| robot.name == body.name));
    let networks = vec![mission.network];
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
