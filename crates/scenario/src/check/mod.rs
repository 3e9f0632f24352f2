//! Checks a scenario and builds everything that a run needs, before anything runs.

pub(crate) mod errors;
pub(crate) mod maps;
pub(crate) mod missions;
pub(crate) mod networks;
pub(crate) mod plausible;
mod purpose;
mod recording;
pub(crate) mod robots;
mod routing;
mod sinks;
mod world;

use std::time::Duration;

use sextant_apps::distributed::MappingNode;
use sextant_apps::routing::Routing;
use sextant_channel::Anchor;
use sextant_kernel::{Files, Seed, SettingError};
use sextant_sim::{Discovery, LeftOut, RobotBody, RoleConfig, Sensors, Setup, SimulatedRegion, Simulation, World};

use super::config::ScenarioConfig;
use errors::Errors;
use maps::{MapJob, check_log_of_maps, check_maps};
use missions::distributed::{NodeMapInput, NodeMapJob, check_distributed};
use missions::planned::{PlannedMission, Surroundings, check_missions};
use networks::Networks;
use networks::network::{ForeignChip, IncompleteChip, Named};
use networks::surveyed::PacketsPerStop;
use purpose::{check_duration, check_purpose, check_warm_up};
use recording::{check_recorded_nodes, check_recording};
use robots::team;
use robots::{Robots, check_robots, check_target_names};
use routing::check_routing;
use sinks::check_sinks;
use world::{check_anchors, check_battery, check_interferers, check_motions};

/// The validated settings. They are built once, because planning the paths of robots takes a while.
#[derive(Clone)]
pub(crate) struct Parts {
    /// The simulation of the survey.
    pub(crate) setup: Setup,
    /// The bodies of all robots, also of those that take no part in the survey.
    pub(crate) bodies: Vec<RobotBody>,
    pub(crate) anchors: Vec<Anchor>,
    pub(crate) discovery: Discovery,
    /// What nodes send while a robot listens, in the first network that robots survey.
    pub(crate) packets_per_stop: PacketsPerStop,
    pub(crate) foreign_chips: Vec<ForeignChip>,
    pub(crate) incomplete_chips: Vec<IncompleteChip>,
    pub(crate) maps: Vec<MapJob>,
    pub(crate) distributed: Option<NodeMapJob>,
    pub(crate) routing: Option<Routing>,
    pub(crate) applications: Vec<PlannedMission>,
    /// What is left out of the counts at the start.
    pub(crate) warm_up: Duration,
    /// Which part of the nodes' traffic is simulated.
    pub(crate) region: SimulatedRegion,
}

/// Adds the robots of the team, then checks each part of the scenario, then all parts together. `None` only if there are
/// errors.
pub(crate) fn check(config: &mut ScenarioConfig, files: &Files, errors: &mut Errors) -> Option<Parts> {
    if config.name.trim().is_empty() {
        errors.refuse(&SettingError::new("name", "empty", "a name with at least one letter"));
    }
    let world = errors.take("world", config.world.build(Seed(config.seed), files));
    if let Some(team) = &config.team {
        let robots = team::robots(team, world.as_ref(), Seed(config.seed));
        config.robots.extend(errors.take("team", robots)?);
        let surveying = config.robots.iter().filter(|robot| robot.role == RoleConfig::Survey).count();
        team::stitch_no_lone_robot(config.team.as_ref(), surveying, &mut config.maps);
    }
    let sensors = errors.take("sensors", Sensors::try_from(config.sensors));
    let interferers = check_interferers(config, errors);
    let world = world.zip(sensors).map(|(world, sensors)| World { sensors, interferers, ..world });
    check_in_world(config, world, files, errors)
}

/// Checks what is in `world`; with some errors, also without it.
fn check_in_world(
    config: &ScenarioConfig,
    world: Option<World>,
    files: &Files,
    errors: &mut Errors,
) -> Option<Parts> {
    let seed = Seed(config.seed);
    let named = Named { nodes: world.as_ref().map(|world| world.nodes.as_slice()), files };
    let networks = Networks::check(config, named, errors);
    let simulated = networks.simulated(named, errors);
    let robots = check_robots(config, world.as_ref(), &networks, errors);
    let sinks = check_sinks(config, world.as_ref(), &networks, errors);
    let duration = check_duration(config, errors);
    check_purpose(config, &networks, errors);
    check_motions(config, errors);
    let warm_up = check_warm_up(config, &networks, errors);
    let region = errors.take("simulation", config.simulation.region()).unwrap_or_default();
    let maps = check_maps(config, &networks, errors);
    check_log_of_maps(config, &maps, &networks, errors);
    check_target_names(&config.robots, world.as_ref(), errors);
    errors.take("metrics", config.metrics.check());
    check_recording(config, world.as_ref(), errors);
    let discovery = errors.take("discovery", Discovery::try_from(config.discovery));
    let anchors = world.as_ref().and_then(|world| check_anchors(config, world, &maps, errors));
    let faults = world.as_ref().and_then(|world| errors.take("faults", config.faults.build(&world.nodes, seed)));
    let batteries = world.as_ref().map(|world| check_battery(config, world, errors));
    let (world, simulated, anchors, discovery, faults) = (world?, simulated?, anchors?, discovery?, faults?);
    check_recorded_nodes(config, &world, errors);
    let Robots { of_survey: robots, bodies } = robots;
    let mut setup =
        Setup { world, networks: simulated, robots, sinks, duration, faults, batteries: batteries.flatten(), seed };
    let input = NodeMapInput { config, networks: &networks, anchors: &anchors, maps: &maps };
    let distributed = check_distributed(&input, &mut setup, errors);
    let routing = check_routing(config, &networks, &setup, files, errors);
    let surroundings = Surroundings {
        config,
        files,
        setup: &setup,
        networks: &networks,
        bodies: &bodies,
        maps: &maps,
        distributed: distributed.as_ref(),
    };
    let applications = check_missions(&surroundings, errors);
    let (packets_per_stop, foreign_chips) = (networks.packets_per_stop(), networks.foreign_chips());
    let parts = Parts {
        setup,
        bodies,
        anchors,
        discovery,
        packets_per_stop,
        foreign_chips,
        incomplete_chips: networks.incomplete_chips(),
        maps,
        distributed,
        routing,
        applications,
        warm_up,
        region,
    };
    if errors.found.is_empty() && config.has_survey() {
        parts.check_together(errors);
    }
    Some(parts)
}

impl Parts {
    /// Sets the simulation up, which checks what depends on several parts, such as the size of frames.
    fn check_together(&self, errors: &mut Errors) {
        let setup = self.setup.clone();
        let simulation = match (&self.distributed, &self.routing) {
            (None, None) => Simulation::new(setup).map(drop),
            (None, Some(routing)) => routing.simulation(setup, LeftOut::default()).map(drop),
            (Some(map), _) => {
                let nodes = map.nodes(setup.world.nodes.len(), &self.anchors);
                MappingNode::simulation(setup, nodes, LeftOut::default()).map(drop)
            }
        };
        errors.take("", simulation);
        errors.take("simulation", self.region.halo_m(self.setup.reach()));
    }
}
