//! The robots of a scenario.

pub(crate) mod team;

use sextant_apps::{ControllerConfig, Surroundings};
use sextant_channel::ObstacleField;
use sextant_kernel::{Seed, SettingError};
use sextant_sim::{Controller, NetworkId, Robot, RobotBody, RobotConfig, RobotTask, RoleConfig, World};

use super::errors::Errors;
use super::networks::Networks;
use super::sinks::is_name_of_node;
use crate::config::ScenarioConfig;

/// Maximum distance from the start of a robot to the nearest node (m).
const FARTHEST_START_M: f64 = 1e5;

/// The longest time of a planned path (s): 31 years.
const LONGEST_SURVEY_S: f64 = 1e9;

/// The robots of a scenario.
#[derive(Clone, Default)]
pub(crate) struct Robots {
    /// Those that take part in the survey: all but the agents.
    pub(crate) of_survey: Vec<Robot>,
    /// The bodies of all.
    pub(crate) bodies: Vec<RobotBody>,
}

/// The robots, with unique names.
pub(crate) fn check_robots(
    config: &ScenarioConfig,
    world: Option<&World>,
    networks: &Networks<'_>,
    errors: &mut Errors,
) -> Robots {
    let mut robots = Robots::default();
    for (i, robot_config) in config.robots.iter().enumerate() {
        let table = config.table_of_robot(i);
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
        let checked = body(robot_config, obstacles, networks).and_then(|body| {
            check_frame(robot_config, networks)?;
            let controller = controller(i, robot_config, &body, obstacles, Seed(config.seed))?;
            if robot_config.role == RoleConfig::Anchor && config.distributed_mapping.is_none() {
                let allowed = "\"survey\", or a table `[distributed_mapping]`: a mobile anchor tells nodes its place";
                return Err(SettingError::new("role", "\"anchor\"", allowed));
            }
            Ok((body, controller))
        });
        let Some((body, controller)) = errors.take(&table, checked) else {
            continue;
        };
        if robots.bodies.iter().any(|other| other.name == body.name) || is_name_of_node(world, &body.name) {
            let found = format!("`{}`, the name of a node or of an earlier robot", body.name);
            errors.refuse(&SettingError::new("name", found, "a unique name").within(&table));
        }
        if let Some(controller) = controller {
            robots.of_survey.push(Robot { body: body.clone(), task: RobotTask::Survey(controller) });
        }
        robots.bodies.push(body);
    }
    robots
}

/// Refuses targets with the name of a robot: in a recording, both would be the same frame.
pub(crate) fn check_target_names(
    robots: &[RobotConfig<ControllerConfig>],
    world: Option<&World>,
    errors: &mut Errors,
) {
    for (i, target) in world.iter().flat_map(|world| &world.targets).enumerate() {
        if robots.iter().any(|robot| robot.name == target.name()) {
            let found = format!("`{}`, the name of a robot", target.name());
            errors.refuse(&SettingError::new(format!("world.targets[{i}].name"), found, "a unique name"));
        }
    }
}

/// Refuses frames of their own for robots whose log has directions: these would be in the frame of the world.
fn check_frame(robot: &RobotConfig<ControllerConfig>, networks: &Networks<'_>) -> Result<(), SettingError> {
    if robot.frame.is_world() || !networks.sweep_sectors() {
        return Ok(());
    }
    let remedy = "remove one of them, because sectors have directions in the world";
    Err(SettingError::conflict("frame", "`mac.sector_sweep`", remedy))
}

/// The networks whose nodes a robot surveys.
fn surveyed(robot: &RobotConfig<ControllerConfig>, networks: &Networks<'_>) -> Result<Vec<NetworkId>, SettingError> {
    if robot.networks.is_empty() {
        return Ok(vec![networks.number("network", robot.network.as_deref())?]);
    }
    if robot.network.is_some() {
        return Err(SettingError::conflict("network", "`networks`", "set one of them"));
    }
    let mut numbers = Vec::new();
    for (i, name) in robot.networks.iter().enumerate() {
        let key = format!("networks[{i}]");
        let number = networks.number(&key, Some(name))?;
        if numbers.contains(&number) {
            return Err(SettingError::new(key, format!("`{name}`, which is listed before"), "each network once"));
        }
        numbers.push(number);
    }
    Ok(numbers)
}

/// The body of a robot at a free place, in its networks.
fn body(
    robot: &RobotConfig<ControllerConfig>,
    obstacles: &ObstacleField,
    networks: &Networks<'_>,
) -> Result<RobotBody, SettingError> {
    let body = RobotBody::try_from(robot)?;
    if let Some((found, allowed)) = obstacles.fault(body.start) {
        return Err(SettingError::new("start_m", found, allowed));
    }
    Ok(RobotBody { networks: surveyed(robot, networks)?, ..body })
}

/// What drives robot `number` during the survey; `None` for an agent.
fn controller(
    number: usize,
    robot: &RobotConfig<ControllerConfig>,
    body: &RobotBody,
    obstacles: &ObstacleField,
    seed: Seed,
) -> Result<Option<Box<dyn Controller>>, SettingError> {
    let config = match (&robot.controller, robot.role) {
        (None, RoleConfig::Agent) => return Ok(None),
        (Some(_), RoleConfig::Agent) => {
            let remedy = "remove the table, because applications drive this robot";
            return Err(SettingError::conflict("controller", "`role = \"agent\"`", remedy));
        }
        (None, RoleConfig::Survey | RoleConfig::Anchor) => {
            let needed = "a table with the path of the robot, or `role = \"agent\"` for applications alone";
            return Err(SettingError::missing("controller", needed));
        }
        (Some(config), RoleConfig::Survey | RoleConfig::Anchor) => config,
    };
    let surroundings =
        Surroundings { obstacles, start: body.start, radius_m: body.radius_m, seed, robot: number as u64 };
    let within = |error: SettingError| error.within("controller");
    let controller = config.build(&surroundings).map_err(within)?;
    let way = config.expected_way(&surroundings).map_err(within)?;
    let time_s = way.length_m / body.speed_m_per_s + way.stops as f64 * body.listen.as_secs_f64();
    if time_s > LONGEST_SURVEY_S {
        let found = format!("a path of {:e} m, which takes {time_s:.0e} s", way.length_m);
        let allowed = format!("a path of at most {LONGEST_SURVEY_S:e} s; it takes `speed_m_per_s` and `listen_s`");
        return Err(SettingError::new("controller", found, allowed));
    }
    Ok(Some(controller))
}
