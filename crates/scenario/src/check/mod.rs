//! Checks a scenario and builds everything that a run needs, before anything runs.

pub(crate) mod errors;
pub(crate) mod maps;
pub(crate) mod missions;
pub(crate) mod networks;
pub(crate) mod plausible;
pub(crate) mod robots;

use std::time::Duration;

use sextant_apps::distributed::MappingNode;
use sextant_channel::{Anchor, Bounds};
use sextant_kernel::text::counted;
use sextant_kernel::{Files, Seed, SettingError};
use sextant_sim::{
    Discovery, Interferer, LeftOut, RobotBody, RoleConfig, Sensors, Setup, SimulatedRegion, Simulation, World,
};

use super::config::ScenarioConfig;
use errors::Errors;
use maps::{MapJob, check_log_of_maps, check_maps};
use missions::applications::{Application, Surroundings, check_applications};
use missions::distributed::{NodeMapJob, check_distributed};
use networks::NetworkTables;
use networks::known::{KnownNetworks, PacketsPerStop};
use networks::sinks::check_sinks;
use robots::team;
use robots::{Robots, check_robots, check_target_names};

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
    pub(crate) distributed: Option<NodeMapJob>,
    pub(crate) applications: Vec<Application>,
    /// What is left out of the counts at the start.
    pub(crate) warm_up: Duration,
    /// Which part of the nodes' traffic is simulated.
    pub(crate) region: SimulatedRegion,
}

/// Adds the robots of the team, then checks each part of the scenario, then all parts together.
pub(crate) fn check(config: &mut ScenarioConfig, files: &Files, errors: &mut Errors) -> (Option<Parts>, Vec<MapJob>) {
    if config.name.trim().is_empty() {
        errors.refuse(&SettingError::new("name", "empty", "a name with at least one letter"));
    }
    let world = errors.take("world", config.world.build(Seed(config.seed), files));
    if let Some(team) = &config.team {
        let robots = team::robots(team, world.as_ref(), Seed(config.seed));
        let Some(robots) = errors.take("team", robots) else { return (None, Vec::new()) };
        config.robots.extend(robots);
        let surveying = config.robots.iter().filter(|robot| robot.role == RoleConfig::Survey).count();
        team::stitch_no_lone_robot(config.team.as_ref(), surveying, &mut config.maps);
    }
    let config = &*config;
    let sensors = errors.take("sensors", Sensors::try_from(config.sensors));
    let interferers = check_interferers(config, errors);
    let world = world.zip(sensors).map(|(world, sensors)| World { sensors, interferers, ..world });
    let tables = NetworkTables::all(config);
    let nodes = world.as_ref().map(|world| world.nodes.as_slice());
    let links: Vec<_> = tables.iter().map(|network| network.links(nodes, files, errors)).collect();
    let known = KnownNetworks::new(&tables, &links, &config.robots);
    let networks: Vec<_> = (tables.iter().zip(links))
        .map(|(network, links)| network.check(config, links, nodes, files, errors))
        .collect();
    let robots = check_robots(config, world.as_ref(), errors);
    let sinks = check_sinks(config, world.as_ref(), errors);
    let duration = config.duration_s.map(|duration_s| {
        let checked = SettingError::in_range("duration_s", duration_s, 1e-6, 1e7).map(Duration::from_secs_f64);
        errors.take("", checked)
    });
    if !config.has_traffic() && config.distributed_mapping.is_none() && config.applications.is_empty() {
        let needed = "at least one robot, or `duration_s` to end a simulation without robots";
        errors.refuse(&SettingError::missing("robots", needed));
    }
    if has_no_receiver(config) {
        let needed = "at least one sink in `[[sinks]]`, or a robot that surveys, to receive the packets";
        errors.refuse(&SettingError::missing("sinks", needed));
    }
    let warm_up = check_warm_up(config, errors);
    let region = errors.take("simulation", config.simulation.region());
    let maps = check_maps(&config.maps, &config.robots, &known, errors);
    check_log_of_maps(config, &maps, &known, errors);
    check_target_names(&config.robots, world.as_ref(), errors);
    errors.take("metrics", config.metrics.check());
    if let Some(snapshots) = &config.recording.fields {
        let places = world.iter().flat_map(|world| &world.nodes).map(|node| node.position);
        errors.take("recording.fields", snapshots.check(Bounds::of(places)));
    }
    errors.take("recording", config.recording.check());
    errors.take("recording.pcap", config.recording.pcap.check(&config.robots));
    let discovery = errors.take("discovery", Discovery::try_from(config.discovery));
    let anchors = world.as_ref().and_then(|world| check_anchors(config, world, &maps, errors));
    let faults =
        world.as_ref().and_then(|world| errors.take("faults", config.faults.build(&world.nodes, Seed(config.seed))));
    let (Some(world), Some(networks)) = (world, networks.into_iter().collect::<Option<Vec<_>>>()) else {
        return (None, maps);
    };
    let (Some(anchors), Some(discovery), Some(faults)) = (anchors, discovery, faults) else { return (None, maps) };
    let Some(packets_per_stop) = known.packets_per_stop() else { return (None, maps) };
    for (i, name) in config.recording.likelihood.iter().enumerate() {
        if !world.nodes.iter().any(|node| node.name == *name) {
            let key = format!("recording.likelihood[{i}]");
            errors.refuse(&SettingError::new(key, format!("`{name}`"), "the name of a node"));
        }
    }
    let seed = Seed(config.seed);
    let Robots { of_survey: robots, bodies } = robots;
    // Without a survey, maps need no more than the names of the nodes.
    let nothing_happens = !config.has_traffic() && config.distributed_mapping.is_none();
    let duration = if nothing_happens { Some(Duration::ZERO) } else { duration.flatten() };
    let mut setup = Setup { world, networks, robots, sinks, duration, faults, seed };
    let distributed = check_distributed(config, &tables, &mut setup, (&anchors, &maps), errors);
    let surroundings = Surroundings {
        config,
        files,
        setup: &setup,
        tables: &tables,
        bodies: &bodies,
        maps: &maps,
        distributed: distributed.as_ref(),
    };
    let applications = check_applications(&surroundings, errors);
    if errors.found.is_empty() && config.has_survey() {
        // The simulation checks what depends on several parts, such as the size of frames.
        let simulation = match &distributed {
            None => Simulation::new(setup.clone()).map(drop),
            Some(map) => {
                let nodes = map.nodes(setup.world.nodes.len(), &anchors);
                MappingNode::simulation(setup.clone(), nodes, LeftOut::default()).map(drop)
            }
        };
        errors.take("", simulation);
        errors.take("simulation", region.unwrap_or_default().halo_m(setup.reach()));
    }
    let region = region.unwrap_or_default();
    (
        Some(Parts {
            setup,
            bodies,
            anchors,
            discovery,
            packets_per_stop,
            distributed,
            applications,
            warm_up,
            region,
        }),
        maps,
    )
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
fn check_warm_up(config: &ScenarioConfig, errors: &mut Errors) -> Duration {
    let Some(warm_up_s) = config.warm_up_s else { return Duration::ZERO };
    let has_sweeps = NetworkTables::all(config).iter().any(NetworkTables::sweeps_sectors);
    let checked = match config.duration_s {
        None => {
            let remedy = "set `duration_s` or remove it, because a survey counts from its start";
            Err(SettingError::conflict("warm_up_s", "a scenario without `duration_s`", remedy))
        }
        Some(_) if has_sweeps => {
            Err(SettingError::conflict("warm_up_s", "`mac.sector_sweep`", "remove it, because all sweeps count"))
        }
        Some(duration_s) if !(warm_up_s >= 0.0 && warm_up_s < duration_s) => {
            Err(SettingError::new("warm_up_s", warm_up_s, format!("0 to less than `duration_s`, {duration_s}")))
        }
        Some(_) => Ok(Duration::from_secs_f64(warm_up_s)),
    };
    errors.take("", checked).unwrap_or_default()
}

/// Whether nodes send traffic for a time without a receiver, and nothing else happens in that time: no map in the nodes, and nothing
/// that they sense.
fn has_no_receiver(config: &ScenarioConfig) -> bool {
    let surveys = config.robots.iter().any(|robot| robot.role != RoleConfig::Agent);
    let senses = !config.world.targets.is_empty() || !config.world.fields.is_empty();
    let is_for_nobody = config.sinks.is_empty() && !surveys && config.distributed_mapping.is_none();
    config.duration_s.is_some() && is_for_nobody && !senses && config.applications.is_empty()
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
