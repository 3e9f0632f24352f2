//! Checks a scenario and builds everything that a run needs, before anything runs.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use sextant_apps::{ControllerConfig, Surroundings};
use sextant_channel::{Anchor, Bounds, ObstacleField};
use sextant_kernel::{Seed, SettingError};
use sextant_mapper::{MapConfig, Mapper};
use sextant_sim::{
    BusyNetwork, Discovery, NetworkId, Robot, RobotBody, RobotConfig, RoleConfig, Sensors, Setup, Simulation, Sink,
    World,
};

use super::config::{MetricsConfig, RecordingConfig, ScenarioConfig};
use super::deserialize::deserialize;
use super::error::ScenarioErrors;
use super::errors::Errors;
use super::known_channel::KnownChannel;
use super::known_networks::KnownNetworks;
use super::layers;
use super::network_config::NetworkConfig;
use super::networks::{self, NetworkTables};
use super::survey_identity::SurveyIdentity;
use crate::text::counted;

/// A scenario that has been read and checked.
pub struct Scenario {
    config: ScenarioConfig,
    file: PathBuf,
    named_files: Vec<PathBuf>,
    text: String,
    parts: Parts,
    maps: Vec<NamedMap>,
}

/// A map to compute.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedMap {
    /// Its name in tables and recordings; unique in the scenario.
    pub name: String,
    /// The network whose log is mapped; the first surveyed one if absent. Joint maps name their networks themselves.
    pub network: Option<String>,
    /// The algorithm with its settings.
    pub mapper: Mapper,
}

/// The validated settings. They are built once, because planning the paths of robots takes a while.
#[derive(Clone)]
struct Parts {
    setup: Setup,
    anchors: Vec<Anchor>,
    discovery: Discovery,
    known_channel: KnownChannel,
}

impl Scenario {
    /// Reads the scenario at `path`, overrides it by the flags `set` (each `path.to.key=value`) and by `seed`, and checks
    /// it.
    ///
    /// # Errors
    /// If a file cannot be read or a setting is invalid: all errors found.
    pub fn load(path: &Path, set: &[String], seed: Option<u64>) -> Result<Self, ScenarioErrors> {
        let mut document = layers::read(path, set, seed)?;
        let text = std::mem::take(&mut document.text);
        let mut config: ScenarioConfig = deserialize(&document)?;
        let folder = path.parent().unwrap_or(Path::new(""));
        let mut named_files = Vec::new();
        for (key, file) in config.world.files_mut() {
            document.rebase(&format!("world.{key}"), file, folder);
            named_files.push(folder.join(file));
        }
        let of_traffic = config.traffic.iter_mut().map(|traffic| ("traffic".to_owned(), traffic));
        let of_networks = config
            .networks
            .iter_mut()
            .filter_map(|(name, network)| Some((format!("networks.{name}.traffic"), network.traffic.as_mut()?)));
        for (table, traffic) in of_traffic.chain(of_networks) {
            for (key, file) in traffic.files_mut() {
                document.rebase(&format!("{table}.{key}"), file, folder);
                named_files.push(folder.join(file));
            }
        }
        let of_antennas = config.antenna.iter_mut().map(|antenna| ("antenna".to_owned(), antenna));
        let of_networks = config
            .networks
            .iter_mut()
            .filter_map(|(name, network)| Some((format!("networks.{name}.antenna"), network.antenna.as_mut()?)));
        for (table, antenna) in of_antennas.chain(of_networks) {
            for (key, file) in antenna.files_mut() {
                document.rebase(&format!("{table}.{key}"), file, folder);
                named_files.push(folder.join(file));
            }
        }
        let mut errors = Errors { document: &document, found: Vec::new() };
        let (parts, maps) = check(&config, folder, &mut errors);
        ScenarioErrors::check(errors.found)?;
        let parts = parts.expect("what has no errors has all its parts");
        Ok(Self { config, file: path.to_path_buf(), named_files, text, parts, maps })
    }

    /// The scenario as written, with all layers merged.
    #[must_use]
    pub fn config(&self) -> &ScenarioConfig {
        &self.config
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.config.name
    }

    /// The random seed.
    #[must_use]
    pub fn seed(&self) -> Seed {
        Seed(self.config.seed)
    }

    /// The text of the file or, if it extends another one or flags override it, of the merged settings. The value of
    /// `--seed` is not in it.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Name of the file, without its folder.
    #[must_use]
    pub fn file_name(&self) -> String {
        self.file.file_name().unwrap_or_default().to_string_lossy().into_owned()
    }

    /// The files that its settings name: tables of nodes and meshes of obstacles. They are not part of its
    /// [`text`](Self::text).
    #[must_use]
    pub fn named_files(&self) -> &[PathBuf] {
        &self.named_files
    }

    /// The world.
    #[must_use]
    pub fn world(&self) -> &World {
        &self.parts.setup.world
    }

    /// The channel of the first network that robots survey, for maps that may know it.
    #[must_use]
    pub fn known_channel(&self) -> KnownChannel {
        self.parts.known_channel
    }

    /// The networks whose logs a map uses: one, or several for a joint map.
    #[must_use]
    pub fn networks_of(&self, map: &NamedMap) -> Vec<NetworkId> {
        let surveyed = self.surveyed();
        let is_called = |id: &NetworkId, name: &str| self.networks()[id.index()].name.as_deref() == Some(name);
        let called = |name: &str| surveyed.iter().copied().find(|id| is_called(id, name)).unwrap_or(surveyed[0]);
        match &map.mapper {
            Mapper::Joint(joint) => joint.networks().map(called).collect(),
            _ => vec![map.network.as_deref().map_or(surveyed[0], called)],
        }
    }

    /// All its networks.
    #[must_use]
    pub fn networks(&self) -> &[BusyNetwork] {
        &self.parts.setup.networks
    }

    /// The networks that robots survey, in their order: at least one.
    #[must_use]
    pub fn surveyed(&self) -> Vec<NetworkId> {
        self.parts.setup.surveyed()
    }

    /// The maps to compute.
    #[must_use]
    pub fn maps(&self) -> &[NamedMap] {
        &self.maps
    }

    /// The nodes that know their position, by node.
    #[must_use]
    pub fn anchors(&self) -> &[Anchor] {
        &self.parts.anchors
    }

    /// How the nodes discover their neighbours.
    #[must_use]
    pub fn discovery(&self) -> &Discovery {
        &self.parts.discovery
    }

    /// How maps are compared with the truth.
    #[must_use]
    pub fn metrics(&self) -> &MetricsConfig {
        &self.config.metrics
    }

    /// What is recorded in addition to what a mapper needs.
    #[must_use]
    pub fn recording(&self) -> &RecordingConfig {
        &self.config.recording
    }

    /// Number of the robot whose receptions are captured; `None` if all frames on air are captured.
    #[must_use]
    pub fn captured_robot(&self) -> Option<usize> {
        let name = self.config.recording.pcap.robot.as_ref()?;
        self.config.robots.iter().position(|robot| robot.name == *name)
    }

    /// The setup of a simulation; each call returns robots at their start.
    #[must_use]
    pub fn setup(&self) -> Setup {
        self.parts.setup.clone()
    }

    /// Identifies the scenarios with the same surveys.
    #[must_use]
    pub fn survey_identity(&self) -> SurveyIdentity {
        SurveyIdentity::of(&self.config)
    }

    /// A short description: `496 nodes, 3 obstacles, 1 robot, 1 map`.
    #[must_use]
    pub fn outline(&self) -> String {
        let world = self.world();
        [
            counted(world.nodes.len(), "node"),
            counted(world.obstacles.len(), "obstacle"),
            counted(self.config.robots.len(), "robot"),
            counted(self.config.sinks.len(), "sink"),
            counted(self.maps.len(), "map"),
        ]
        .join(", ")
    }
}

/// Maximum distance from the start of a robot to the nearest node (m).
const FARTHEST_START_M: f64 = 1e5;

/// Checks each part of the scenario, then all parts together.
fn check(config: &ScenarioConfig, folder: &Path, errors: &mut Errors<'_>) -> (Option<Parts>, Vec<NamedMap>) {
    if config.name.trim().is_empty() {
        errors.refuse(&SettingError::new("name", "empty", "a name with at least one letter"));
    }
    let world = errors.take("world", config.world.build(Seed(config.seed), folder));
    let sensors = errors.take("sensors", Sensors::try_from(config.sensors));
    let world = world.zip(sensors).map(|(world, sensors)| World { sensors, ..world });
    let tables = NetworkTables::all(config);
    let nodes = world.as_ref().map(|world| world.nodes.as_slice());
    let networks: Vec<_> = tables.iter().map(|network| network.check(config, nodes, folder, errors)).collect();
    let robots = check_robots(config, world.as_ref(), errors);
    let sinks = check_sinks(config, world.as_ref(), errors);
    let duration = config.duration_s.map(|duration_s| {
        let checked = SettingError::in_range("duration_s", duration_s, 1e-6, 1e7).map(Duration::from_secs_f64);
        errors.take("", checked)
    });
    if config.robots.is_empty() && config.duration_s.is_none() {
        let allowed = "at least one robot, or `duration_s` to end a simulation without robots";
        errors.refuse(&SettingError::new("robots", "none", allowed));
    }
    let known = KnownNetworks::new(&tables, &config.robots, Some(folder));
    let maps = check_maps(&config.maps, &known, errors);
    check_target_names(&config.robots, world.as_ref(), errors);
    errors.take("metrics", config.metrics.check());
    if let Some(snapshots) = &config.recording.fields {
        let places = world.iter().flat_map(|world| &world.nodes).map(|node| node.position);
        errors.take("recording.fields", snapshots.check(Bounds::of(places)));
    }
    errors.take("recording.pcap", config.recording.pcap.check(&config.robots));
    let discovery = errors.take("discovery", Discovery::try_from(config.discovery));
    let anchors = world.as_ref().and_then(|world| check_anchors(config, world, &maps, errors));
    let (Some(world), Some(networks)) = (world, networks.into_iter().collect::<Option<Vec<_>>>()) else {
        return (None, maps);
    };
    let (Some(anchors), Some(discovery)) = (anchors, discovery) else { return (None, maps) };
    let Some(known_channel) = known.first_channel() else { return (None, maps) };
    for (i, name) in config.recording.likelihood.iter().enumerate() {
        if !world.nodes.iter().any(|node| node.name == *name) {
            let key = format!("recording.likelihood[{i}]");
            errors.refuse(&SettingError::new(key, format!("`{name}`"), "the name of a node"));
        }
    }
    let seed = Seed(config.seed);
    let setup = Setup { world, networks, robots, sinks, duration: duration.flatten(), seed };
    if errors.found.is_empty() {
        // The simulation checks what depends on several parts, such as the size of frames.
        if let Err(error) = Simulation::new(setup.clone()) {
            errors.refuse(&error);
        }
    }
    (Some(Parts { setup, anchors, discovery, known_channel }), maps)
}

/// Refuses targets with the name of a robot: in a recording, both would be the same frame.
fn check_target_names(robots: &[RobotConfig<ControllerConfig>], world: Option<&World>, errors: &mut Errors<'_>) {
    for (i, target) in world.iter().flat_map(|world| &world.targets).enumerate() {
        if robots.iter().any(|robot| robot.name == target.name()) {
            let found = format!("`{}`, the name of a robot", target.name());
            errors.refuse(&SettingError::new(format!("world.targets[{i}].name"), found, "a unique name"));
        }
    }
}

/// The nodes that know their position; checks that there are enough for each of `maps`.
fn check_anchors(
    config: &ScenarioConfig,
    world: &World,
    maps: &[NamedMap],
    errors: &mut Errors<'_>,
) -> Option<Vec<Anchor>> {
    let anchors = errors.take("anchors", config.anchors.choose(&world.nodes, Seed(config.seed)))?;
    let first = anchors.first().map_or(0.0, |anchor| anchor.position.z_m);
    let is_planar = anchors.iter().all(|anchor| (anchor.position.z_m - first).abs() <= 1e-9);
    for map in maps {
        let needed = map.mapper.least_anchors(if is_planar { 2 } else { 3 });
        if anchors.len() < needed {
            let found = format!("{} of the {}", anchors.len(), counted(world.nodes.len(), "node"));
            let allowed = format!("at least {needed}, for the map `{}`", map.name);
            errors.refuse(&SettingError::new("anchors", found, allowed));
        }
    }
    Some(anchors)
}

fn check_robots(config: &ScenarioConfig, world: Option<&World>, errors: &mut Errors<'_>) -> Vec<Robot> {
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

/// The sinks, with names of their own.
fn check_sinks(config: &ScenarioConfig, world: Option<&World>, errors: &mut Errors<'_>) -> Vec<Sink> {
    let none = ObstacleField::default();
    let obstacles = world.map_or(&none, |world| &world.obstacles);
    let mut sinks: Vec<Sink> = Vec::new();
    for (i, sink) in config.sinks.iter().enumerate() {
        let placed = sink.place(obstacles).and_then(|placed| {
            let numbers = sink.networks.as_ref().map(|names| {
                let numbered = names.iter().enumerate();
                let number = |(j, name): (usize, &String)| {
                    networks::number(&format!("networks[{j}]"), Some(name), &config.networks)
                };
                numbered.map(number).collect::<Result<Vec<_>, _>>()
            });
            Ok(Sink { networks: numbers.transpose()?, ..placed })
        });
        let table = format!("sinks[{i}]");
        let Some(placed) = errors.take(&table, placed) else { continue };
        let is_taken = sinks.iter().any(|other| other.name == placed.name)
            || config.robots.iter().any(|robot| robot.name == placed.name);
        if is_taken {
            let found = format!("`{}`, as of another robot or sink", placed.name);
            errors.refuse(&SettingError::new("name", found, "a unique name").within(&table));
        }
        sinks.push(placed);
    }
    sinks
}

/// The maps to compute; absent channel settings are taken from the networks of the maps, where they are known.
pub(super) fn check_maps(configs: &[MapConfig], networks: &KnownNetworks, errors: &mut Errors<'_>) -> Vec<NamedMap> {
    let mut maps: Vec<NamedMap> = Vec::new();
    for (i, config) in configs.iter().enumerate() {
        let table = format!("maps[{i}]");
        let mut config = config.clone();
        if errors.take(&table, networks.complete(&mut config)).is_none() {
            continue;
        }
        let mapper = Mapper::try_from(config.algorithm).map_err(|error| error.within("algorithm"));
        let Some(mapper) = errors.take(&table, mapper) else {
            continue;
        };
        let name = config.name.clone().unwrap_or_else(|| mapper.name().to_owned());
        let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
        if name.is_empty() || !name.chars().all(is_plain) {
            let allowed = "at least one character; only letters, digits, `-`, `_` and `.`";
            errors.refuse(&SettingError::new("name", format!("`{name}`"), allowed).within(&table));
        }
        if maps.iter().any(|map| map.name == name) {
            let found = format!("`{name}`, the name of an earlier map");
            errors.refuse(&SettingError::new("name", found, "a unique name").within(&table));
        }
        maps.push(NamedMap { name, network: config.network, mapper });
    }
    maps
}

fn robot(
    number: usize,
    config: &RobotConfig<ControllerConfig>,
    obstacles: &ObstacleField,
    seed: Seed,
) -> Result<Robot, SettingError> {
    let body = RobotBody::try_from(config)?;
    if config.role == RoleConfig::Anchor {
        let allowed = "\"survey\": no map of the scenario has messages for a mobile anchor to send";
        return Err(SettingError::new("role", "\"anchor\"", allowed));
    }
    if let Some((found, allowed)) = obstacles.fault(body.start) {
        return Err(SettingError::new("start_m", found, allowed));
    }
    let surroundings =
        Surroundings { obstacles, start: body.start, radius_m: body.radius_m, seed, robot: number as u64 };
    let controller = config.controller.build(&surroundings).map_err(|error| error.within("controller"))?;
    Ok(Robot { body, controller, broadcast: None })
}
