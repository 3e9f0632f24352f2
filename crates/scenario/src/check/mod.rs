//! Checks a scenario and builds everything that a run needs, before anything runs.

pub(crate) mod errors;
pub(crate) mod maps;
pub(crate) mod missions;
pub(crate) mod networks;
pub(crate) mod plausible;
pub(crate) mod robots;
mod routing;
mod sinks;

use std::time::Duration;

use sextant_apps::distributed::MappingNode;
use sextant_apps::routing::Routing;
use sextant_channel::{Anchor, Bounds};
use sextant_kernel::text::counted;
use sextant_kernel::{Files, Seed, SettingError};
use sextant_sim::{
    Batteries, Discovery, Interferer, LeftOut, RobotBody, RoleConfig, Sensors, Setup, SimulatedRegion, Simulation,
    World,
};

use super::config::ScenarioConfig;
use errors::Errors;
use maps::{MapJob, check_log_of_maps, check_maps};
use missions::distributed::{NodeMapInput, NodeMapJob, check_distributed};
use missions::planned::{PlannedMission, Surroundings, check_missions};
use networks::Networks;
use networks::surveyed::PacketsPerStop;
use networks::tables::{ForeignChip, IncompleteChip, Named};
use robots::team;
use robots::{Robots, check_robots, check_target_names};
use routing::check_routing;
use sinks::check_sinks;

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

/// The batteries of the nodes, if there are any.
fn check_battery(config: &ScenarioConfig, world: &World, errors: &mut Errors) -> Option<Batteries> {
    let battery = config.battery.as_ref()?;
    for (is_there, with) in [
        (!config.applications.is_empty(), "`applications`"),
        (config.distributed_mapping.is_some(), "`distributed_mapping`"),
    ] {
        if is_there {
            let remedy = "remove one of the two: batteries are those of nodes that send their traffic";
            errors.refuse(&SettingError::conflict("battery", with, remedy));
        }
    }
    errors.take("battery", battery.build(&world.nodes, Seed(config.seed)))
}

/// When the simulation ends, if not with the survey.
fn check_duration(config: &ScenarioConfig, errors: &mut Errors) -> Option<Duration> {
    let duration = config.duration_s.and_then(|duration_s| {
        let checked = SettingError::in_range("duration_s", duration_s, 1e-6, 1e7).map(Duration::from_secs_f64);
        errors.take("", checked)
    });
    // Without a survey, maps need no more than the names of the nodes.
    let nothing_happens = !config.has_traffic() && config.distributed_mapping.is_none();
    if nothing_happens { Some(Duration::ZERO) } else { duration }
}

/// Refuses scenarios in which nothing happens, or packets that are for nobody.
fn check_purpose(config: &ScenarioConfig, networks: &Networks<'_>, errors: &mut Errors) {
    if !config.has_traffic() && config.distributed_mapping.is_none() && config.applications.is_empty() {
        let needed = "at least one robot, or `duration_s` to end a simulation without robots";
        errors.refuse(&SettingError::missing("robots", needed));
    }
    // Neither a map in the nodes nor what they sense needs a receiver, and nodes with programs receive themselves.
    let surveys = config.robots.iter().any(|robot| robot.role != RoleConfig::Agent);
    let senses = !config.world.targets.is_empty() || !config.world.fields.is_empty();
    let is_for_nobody =
        config.sinks.is_empty() && !surveys && config.distributed_mapping.is_none() && !networks.have_programs();
    if config.duration_s.is_some() && is_for_nobody && !senses && config.applications.is_empty() {
        let needed = "at least one sink in `[[sinks]]`, or a robot that surveys, to receive the packets";
        errors.refuse(&SettingError::missing("sinks", needed));
    }
}

/// Refuses nodes that move beside what takes all nodes to stand.
fn check_motions(config: &ScenarioConfig, errors: &mut Errors) {
    if config.world.motions.is_empty() {
        return;
    }
    let surveys = config.robots.iter().any(|robot| robot.role != RoleConfig::Agent);
    for (is_there, with) in [
        (surveys, "a robot that surveys"),
        (!config.maps.is_empty(), "`maps`"),
        (config.distributed_mapping.is_some(), "`distributed_mapping`"),
        (!config.applications.is_empty(), "`applications`"),
        (!config.world.targets.is_empty(), "`world.targets`"),
        (!config.world.fields.is_empty(), "`world.fields`"),
    ] {
        if is_there {
            let remedy = "remove one of the two: nodes that move send to sinks, and all else takes nodes to stand";
            errors.refuse(&SettingError::conflict("world.motions", with, remedy));
        }
    }
}

/// What is recorded, but for the nodes that it names.
fn check_recording(config: &ScenarioConfig, world: Option<&World>, errors: &mut Errors) {
    if let Some(snapshots) = &config.recording.fields {
        let places = world.iter().flat_map(|world| &world.nodes).map(|node| node.position);
        errors.take("recording.fields", snapshots.check(Bounds::of(places)));
    }
    errors.take("recording", config.recording.check());
    errors.take("recording.pcap", config.recording.pcap.check(&config.robots));
}

/// Refuses names in `recording.likelihood` that no node has.
fn check_recorded_nodes(config: &ScenarioConfig, world: &World, errors: &mut Errors) {
    for (i, name) in config.recording.likelihood.iter().enumerate() {
        if !world.nodes.iter().any(|node| node.name == *name) {
            let key = format!("recording.likelihood[{i}]");
            errors.refuse(&SettingError::new(key, format!("`{name}`"), "the name of a node"));
        }
    }
}

/// The sources of noise, with unique names.
fn check_interferers(config: &ScenarioConfig, errors: &mut Errors) -> Vec<Interferer> {
    let mut interferers: Vec<Interferer> = Vec::new();
    for (i, interferer) in config.interferers.iter().enumerate() {
        let table = format!("interferers[{i}]");
        let Some(interferer) = errors.take(&table, interferer.build(i, Seed(config.seed))) else { continue };
        if interferers.iter().any(|other| other.name() == interferer.name()) {
            let found = format!("`{}`, as of another interferer", interferer.name());
            errors.refuse(&SettingError::new("name", found, "a unique name").within(&table));
        }
        interferers.push(interferer);
    }
    interferers
}

/// What is left out of the counts at the start.
fn check_warm_up(config: &ScenarioConfig, networks: &Networks<'_>, errors: &mut Errors) -> Duration {
    let Some(warm_up_s) = config.warm_up_s else { return Duration::ZERO };
    let checked = match config.duration_s {
        None => {
            let remedy = "set `duration_s` or remove it, because a survey counts from its start";
            Err(SettingError::conflict("warm_up_s", "a scenario without `duration_s`", remedy))
        }
        Some(_) if networks.sweep_sectors() => {
            Err(SettingError::conflict("warm_up_s", "`mac.sector_sweep`", "remove it, because all sweeps count"))
        }
        Some(duration_s) if !(warm_up_s >= 0.0 && warm_up_s < duration_s) => {
            Err(SettingError::new("warm_up_s", warm_up_s, format!("0 to less than `duration_s`, {duration_s}")))
        }
        Some(_) => Ok(Duration::from_secs_f64(warm_up_s)),
    };
    errors.take("", checked).unwrap_or_default()
}

/// The nodes that know their position; checks that there are enough for each of `maps`.
fn check_anchors(
    config: &ScenarioConfig,
    world: &World,
    maps: &[MapJob],
    errors: &mut Errors,
) -> Option<Vec<Anchor>> {
    let anchors = errors.take("anchors", config.anchors.choose(&world.nodes, &world.obstacles, Seed(config.seed)))?;
    let first = anchors.first().map_or(0.0, |anchor| anchor.position.z_m);
    let is_planar = anchors.iter().all(|anchor| (anchor.position.z_m - first).abs() <= 1e-9);
    let needed = |map: &MapJob| map.mapper.least_anchors(if is_planar { 2 } else { 3 });
    let lacking: Vec<&MapJob> = maps.iter().filter(|map| anchors.len() < needed(map)).collect();
    if let Some(most) = lacking.iter().map(|map| needed(map)).max() {
        let found = format!("{} of the {}", anchors.len(), counted(world.nodes.len(), "node"));
        let names: Vec<String> = lacking.iter().map(|map| format!("`{}`", map.name)).collect();
        let maps = if names.len() == 1 { "map" } else { "maps" };
        let allowed = format!("at least {most}, for the {maps} {}", names.join(", "));
        errors.refuse(&SettingError::new("anchors", found, allowed));
    }
    errors.take("faults", config.faults.believed(&anchors, &world.nodes, Seed(config.seed)))
}
