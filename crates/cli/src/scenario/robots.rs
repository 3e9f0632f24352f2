//! The robots of a scenario.

use std::collections::BTreeMap;

use sextant_apps::{ControllerConfig, Surroundings};
use sextant_channel::ObstacleField;
use sextant_kernel::{Seed, SettingError};
use sextant_sim::{NetworkId, Robot, RobotBody, RobotConfig, RobotTask, RoleConfig, World};

use super::config::ScenarioConfig;
use super::errors::Errors;
use super::network_config::NetworkConfig;
use super::networks;

/// Maximum distance from the start of a robot to the nearest node (m).
const FARTHEST_START_M: f64 = 1e5;

/// The robots, with names of their own.
pub(super) fn check_robots(config: &ScenarioConfig, world: Option<&World>, errors: &mut Errors<'_>) -> Vec<Robot> {
    let mut robots: Vec<Robot> = Vec::new();
    for (i, robot_config) in config.robots.iter().enumerate() {
        let table = format!("robots[{i}]");
        let none = ObstacleField::default();
        let obstacles = world.map_or(&none, |world| &world.obstacles);
        // Planning a path over such a distance would take too long.
        if let Some(world) = world
            && !world.nodes.iter().any(|node| node.position.distance_m(robot_config.start_m) <= FARTHEST_START_M)
        {
            let [x, y, z] = robot_config.start_m.into();
            let allowed = format!("a place within {FARTHEST_START_M} m of a node");
            errors.refuse(&SettingError::new("start_m", format!("[{x}, {y}, {z}]"), allowed).within(&table));
            continue;
        }
        let robot = robot(i, robot_config, obstacles, Seed(config.seed)).and_then(|mut robot| {
            robot.body.networks = surveyed(robot_config, &config.networks)?;
            if robot_config.role == RoleConfig::Anchor && config.distributed_mapping.is_none() {
                let allowed = "\"survey\", or a table `[distributed_mapping]`: a mobile anchor tells nodes its place";
                return Err(SettingError::new("role", "\"anchor\"", allowed));
            }
            Ok(robot)
        });
        let Some(robot) = errors.take(&table, robot) else {
            continue;
        };
        if robots.iter().any(|other| other.body.name == robot.body.name) {
            let found = format!("`{}`, the name of an earlier robot", robot.body.name);
            errors.refuse(&SettingError::new("name", found, "a unique name").within(&table));
        }
        robots.push(robot);
    }
    robots
}

/// Refuses targets with the name of a robot: in a recording, both would be the same frame.
pub(super) fn check_target_names(
    robots: &[RobotConfig<ControllerConfig>],
    world: Option<&World>,
    errors: &mut Errors<'_>,
) {
    for (i, target) in world.iter().flat_map(|world| &world.targets).enumerate() {
        if robots.iter().any(|robot| robot.name == target.name()) {
            let found = format!("`{}`, the name of a robot", target.name());
            errors.refuse(&SettingError::new(format!("world.targets[{i}].name"), found, "a unique name"));
        }
    }
}

/// The networks whose nodes a robot surveys.
fn surveyed(
    robot: &RobotConfig<ControllerConfig>,
    networks: &BTreeMap<String, NetworkConfig>,
) -> Result<Vec<NetworkId>, SettingError> {
    if robot.networks.is_empty() {
        return Ok(vec![networks::number("network", robot.network.as_deref(), networks)?]);
    }
    if let Some(name) = &robot.network {
        return Err(SettingError::new("network", format!("`{name}`, beside `networks`"), "one of the two keys"));
    }
    let mut numbers = Vec::new();
    for (i, name) in robot.networks.iter().enumerate() {
        let key = format!("networks[{i}]");
        let number = networks::number(&key, Some(name), networks)?;
        if numbers.contains(&number) {
            return Err(SettingError::new(key, format!("`{name}`, which is listed before"), "each network once"));
        }
        numbers.push(number);
    }
    Ok(numbers)
}

fn robot(
    number: usize,
    config: &RobotConfig<ControllerConfig>,
    obstacles: &ObstacleField,
    seed: Seed,
) -> Result<Robot, SettingError> {
    let body = RobotBody::try_from(config)?;
    if let Some((found, allowed)) = obstacles.fault(body.start) {
        return Err(SettingError::new("start_m", found, allowed));
    }
    let surroundings =
        Surroundings { obstacles, start: body.start, radius_m: body.radius_m, seed, robot: number as u64 };
    let controller = config.controller.build(&surroundings).map_err(|error| error.within("controller"))?;
    Ok(Robot { body, task: RobotTask::Survey(controller) })
}
