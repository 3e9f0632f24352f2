//! The applications of a scenario.

use std::time::Duration;

use sextant_apps::{AlgorithmConfig, ApplicationConfig, MapSourceConfig};
use sextant_channel::{Bounds, Position};
use sextant_kernel::text::counted;
use sextant_kernel::{Files, SettingError};
use sextant_sim::layout::PlacedNode;
use sextant_sim::{Network, NetworkId, RobotBody, RoleConfig, Setup, TargetMotionConfig, World};

use super::algorithm::Algorithm;
use super::check_all_nodes;
use super::distributed::NodeMapJob;
use crate::check::errors::Errors;
use crate::check::maps::{MapJob, check_name};
use crate::check::networks::Networks;
use crate::config::ScenarioConfig;

/// An application that has been checked.
#[derive(Clone, Debug)]
pub struct Application {
    /// Its name in tables and recordings; unique in the scenario.
    pub name: String,
    /// The map that it is given.
    pub map: ApplicationMap,
    /// The numbers of its robots among those of the scenario.
    pub robots: Vec<usize>,
    /// The network of its messages.
    pub network: NetworkId,
    /// When it ends at the latest.
    pub duration: Duration,
    /// What it does.
    pub algorithm: Algorithm,
}

/// The map that an application is given.
#[derive(Clone, Debug, PartialEq)]
pub enum ApplicationMap {
    /// The true places of the nodes.
    Physical,
    /// The map of this name that is computed in the same run.
    Computed(String),
    /// The places of the nodes (m) as in a file, by node.
    File {
        /// Name of the file.
        name: String,
        /// The places.
        places: Vec<Option<Position>>,
    },
}

impl ApplicationMap {
    /// Its name in tables.
    #[must_use]
    pub fn name(&self) -> &str {
        match self {
            Self::Physical => "physical",
            Self::Computed(name) | Self::File { name, .. } => name,
        }
    }
}

/// A map with fewer places does not tell where a robot is.
const LEAST_PLACES: usize = 3;

/// What applications may name.
pub(crate) struct Surroundings<'a> {
    pub(crate) config: &'a ScenarioConfig,
    pub(crate) files: &'a Files,
    pub(crate) setup: &'a Setup,
    pub(crate) networks: &'a Networks<'a>,
    pub(crate) bodies: &'a [RobotBody],
    pub(crate) maps: &'a [MapJob],
    pub(crate) distributed: Option<&'a NodeMapJob>,
}

/// The applications of the scenario, with unique names.
pub(crate) fn check_applications(around: &Surroundings<'_>, errors: &mut Errors) -> Vec<Application> {
    let mut applications: Vec<Application> = Vec::new();
    for (i, written) in around.config.applications.iter().enumerate() {
        let table = format!("applications[{i}]");
        let name = written.name.clone().unwrap_or_else(|| written.algorithm.name().to_owned());
        check_own_name(&name, &table, &applications, around, errors);
        let map = errors.take(&table, around.map(written));
        // The numbers of robots are not known if one of them was refused.
        let are_known = around.bodies.len() == around.config.robots.len();
        let robots = if are_known { errors.take(&table, around.robots(written)) } else { None };
        let network = errors.take(&table, around.networks.number("network", written.network.as_deref()));
        let network = network.filter(|&network| around.check_network(network, &table, errors));
        let duration =
            SettingError::in_range("duration_s", written.duration_s, 1e-3, 1e7).map(Duration::from_secs_f64);
        let duration = errors.take(&table, duration);
        let network = network.filter(|&network| errors.take(&table, around.check_sensed(written, network)).is_some());
        let algorithm = network.and_then(|network| around.algorithm(written, network, &table, errors));
        if let Some(robots) = &robots {
            errors.take(&table, around.check_speeds(written, robots));
        }
        if let (Some(map), Some(robots), Some(network), Some(duration), Some(algorithm)) =
            (map, robots, network, duration, algorithm)
        {
            applications.push(Application { name, map, robots, network, duration, algorithm });
        }
    }
    applications
}

/// Refuses names that are not plain or that something else in the recording has.
fn check_own_name(name: &str, table: &str, others: &[Application], around: &Surroundings<'_>, errors: &mut Errors) {
    check_name(name, table, around.maps, errors);
    let taken = match name {
        "survey" => "the name of the first phase",
        _ if others.iter().any(|other| other.name == name) => "the name of an earlier application",
        _ if around.distributed.is_some_and(|map| map.name == name) => "the name of the map of the nodes",
        _ => return,
    };
    errors.refuse(&SettingError::new("name", format!("`{name}`, {taken}"), "a unique name").within(table));
}

impl Surroundings<'_> {
    fn nodes(&self) -> &[PlacedNode] {
        &self.setup.world.nodes
    }

    /// The map of an application.
    fn map(&self, written: &ApplicationConfig) -> Result<ApplicationMap, SettingError> {
        if self.nodes().len() < LEAST_PLACES {
            let found = format!("a map of {}", counted(self.nodes().len(), "node"));
            return Err(SettingError::new("map", found, format!("a world with at least {LEAST_PLACES} nodes")));
        }
        match &written.map {
            MapSourceConfig::Physical {} => Ok(ApplicationMap::Physical),
            MapSourceConfig::Computed(name) => {
                let of_nodes = self.distributed.iter().map(|map| map.name.as_str());
                let known: Vec<&str> = of_nodes.chain(self.maps.iter().map(|map| map.name.as_str())).collect();
                if known.contains(&name.as_str()) {
                    return Ok(ApplicationMap::Computed(name.clone()));
                }
                let allowed = match &known[..] {
                    [] => "the name of a map in `[[maps]]`, of which the scenario has none".to_owned(),
                    known => known.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", "),
                };
                Err(SettingError::new("map.computed", format!("`{name}`"), allowed))
            }
            MapSourceConfig::File(file) => {
                let path = self.files.path(file);
                let refuse = |found: String, allowed: &str| Err(SettingError::new("map.file", found, allowed));
                let read = match sextant_logs::read_map(&path) {
                    Ok(read) => read,
                    Err(error) => {
                        let refused = refuse(error.to_string(), "a CSV file with columns node,x_m,y_m[,z_m]");
                        return refused.map_err(|error| self.files.discreet(file, error));
                    }
                };
                let nodes = self.nodes();
                if let Some(unknown) = read.keys().find(|name| !nodes.iter().any(|node| node.name == **name)) {
                    let found = format!("`{}`, in which the node `{unknown}` has a place", file.display());
                    let refused = refuse(found, "places of nodes of the world");
                    return refused.map_err(|error| self.files.discreet(file, error));
                }
                if read.len() < LEAST_PLACES {
                    let found = format!("`{}`, with {}", file.display(), counted(read.len(), "node"));
                    return refuse(found, &format!("at least {LEAST_PLACES} nodes"));
                }
                let places = nodes.iter().map(|node| read.get(&node.name).copied()).collect();
                let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
                Ok(ApplicationMap::File { name, places })
            }
        }
    }

    /// The robots of an application.
    fn robots(&self, written: &ApplicationConfig) -> Result<Vec<usize>, SettingError> {
        let number = |name: &String| self.bodies.iter().position(|body| body.name == *name);
        let mut robots = Vec::new();
        for (i, name) in written.robots.iter().enumerate() {
            let key = format!("robots[{i}]");
            let Some(robot) = number(name) else {
                let known: Vec<_> = self.bodies.iter().map(|body| format!("`{}`", body.name)).collect();
                let allowed = if known.is_empty() { "a robot in `[[robots]]`".to_owned() } else { known.join(", ") };
                return Err(SettingError::new(key, format!("`{name}`"), allowed));
            };
            if robots.contains(&robot) {
                return Err(SettingError::new(key, format!("`{name}`, which is listed before"), "each robot once"));
            }
            robots.push(robot);
        }
        if robots.is_empty() {
            let takes_part = |role: RoleConfig| matches!(role, RoleConfig::Agent | RoleConfig::Survey);
            let configs = self.config.robots.iter().enumerate();
            robots.extend(configs.filter(|(_, robot)| takes_part(robot.role)).map(|(i, _)| i));
        }
        if robots.is_empty() {
            let allowed = "at least one robot: one with `role = \"agent\"` does nothing but applications";
            return Err(SettingError::new("robots", "no robot", allowed));
        }
        Ok(robots)
    }

    /// What an application does in a network that has been checked.
    fn algorithm(
        &self,
        written: &ApplicationConfig,
        network: NetworkId,
        table: &str,
        errors: &mut Errors,
    ) -> Option<Algorithm> {
        let radio = &self.setup.networks[network.index()].technology.ieee802154()?.radio;
        errors.take(table, Algorithm::new(&written.algorithm, radio, &self.setup.world))
    }

    /// Refuses networks in which nodes and robots cannot exchange messages. Returns whether it is a good one.
    fn check_network(&self, network: NetworkId, table: &str, errors: &mut Errors) -> bool {
        let before = errors.found.len();
        let busy: &Network = &self.setup.networks[network.index()];
        if busy.technology.ieee802154().is_none() {
            let found = busy
                .name
                .as_ref()
                .map_or("one with sector sweeps".to_owned(), |name| format!("`{name}`, with sector sweeps"));
            let allowed = "a network of IEEE 802.15.4, over which nodes and robots exchange messages";
            errors.refuse(&SettingError::new("network", found, allowed).within(table));
            return false;
        }
        check_all_nodes(busy, self.networks.tables(network), self.nodes().len(), table, errors);
        errors.found.len() == before
    }

    /// Refuses applications that have nothing to search, or no node that can detect it.
    fn check_sensed(&self, written: &ApplicationConfig, network: NetworkId) -> Result<(), SettingError> {
        let World { targets, fields, .. } = &self.setup.world;
        let sensors = &self.config.sensors;
        let algorithm = written.algorithm.key();
        let refuse = |key: &str, found: &str, allowed: String| Err(SettingError::new(key, found, allowed));
        match &written.algorithm {
            AlgorithmConfig::Detarsk(_) | AlgorithmConfig::PG(_) => {
                if targets.is_empty() {
                    let allowed =
                        format!("another algorithm, or targets in `[[world.targets]]`: `{algorithm}` searches them");
                    return refuse("algorithm", &format!("`{algorithm}`, without targets"), allowed);
                }
                if sensors.targets.is_none() {
                    let allowed = format!("a table `[sensors.targets]`: with `{algorithm}` nodes detect targets");
                    return refuse("algorithm", &format!("`{algorithm}`, without sensors of targets"), allowed);
                }
                let has_sink =
                    self.setup.sinks.iter().any(|sink| sink.networks.as_ref().is_none_or(|of| of.contains(&network)));
                if !has_sink && matches!(written.algorithm, AlgorithmConfig::Detarsk(_)) {
                    let allowed =
                        "at least one sink in the network, in `[[sinks]]`: nodes tell it of the first detection";
                    return refuse("algorithm", "`detarsk`, without a sink", allowed.to_owned());
                }
                self.check_targets()
            }
            AlgorithmConfig::LevelSet(_) | AlgorithmConfig::Gradient(_) => {
                if fields.is_empty() {
                    let allowed = format!(
                        "another algorithm, or a field in `[[world.fields]]`: `{algorithm}` seeks its source"
                    );
                    return refuse("algorithm", &format!("`{algorithm}`, without fields"), allowed);
                }
                if sensors.fields.is_none() {
                    let allowed = format!("a table `[sensors.fields]`: with `{algorithm}` nodes sample the field");
                    return refuse("algorithm", &format!("`{algorithm}`, without sensors of fields"), allowed);
                }
                Ok(())
            }
        }
    }

    /// Refuses targets that never come near a node.
    fn check_targets(&self) -> Result<(), SettingError> {
        let radius_m = self.config.sensors.targets.map_or(0.0, |sensor| sensor.radius_m);
        let Some(world) = Bounds::of(self.nodes().iter().map(|node| node.position)) else { return Ok(()) };
        for (i, target) in self.config.world.targets.iter().enumerate() {
            let places = match &target.motion {
                TargetMotionConfig::Waypoints(way) => way.places_m.clone(),
                TargetMotionConfig::RandomWalk(walk) => vec![walk.start_m],
                TargetMotionConfig::Wander(visit) => vec![visit.from_m, visit.to_m],
                TargetMotionConfig::Evade(flight) => vec![flight.start_m],
            };
            let Some(way) = Bounds::of(places) else { continue };
            let pairs = |of: fn(Position) -> f64| (of(way.min), of(way.max), of(world.min), of(world.max));
            let axes = [pairs(|place| place.x_m), pairs(|place| place.y_m), pairs(|place| place.z_m)];
            if axes.iter().any(|&(low, high, least, most)| low > most + radius_m || high < least - radius_m) {
                let found = format!("target `{}`, whose way is outside the world", target.name);
                let allowed = format!(
                    "targets that come within {radius_m} m of the box around the nodes (see `world.targets[{i}]`)"
                );
                return Err(SettingError::new("algorithm", found, allowed));
            }
        }
        Ok(())
    }

    /// Refuses robots that are slower than the targets that they search.
    fn check_speeds(&self, written: &ApplicationConfig, robots: &[usize]) -> Result<(), SettingError> {
        let is_search = matches!(written.algorithm, AlgorithmConfig::Detarsk(_) | AlgorithmConfig::PG(_));
        if !is_search || written.allow_slower {
            return Ok(());
        }
        let speed = |motion: &TargetMotionConfig| match motion {
            TargetMotionConfig::Waypoints(way) if way.places_m.len() < 2 => 0.0,
            TargetMotionConfig::Waypoints(way) => way.speed_m_per_s,
            TargetMotionConfig::RandomWalk(walk) => walk.speed_m_per_s,
            TargetMotionConfig::Wander(visit) => visit.speed_m_per_s,
            TargetMotionConfig::Evade(flight) => flight.speed_m_per_s,
        };
        let targets = self.config.world.targets.iter().map(|target| (speed(&target.motion), &target.name));
        let Some((fastest, target)) = targets.max_by(|a, b| a.0.total_cmp(&b.0)) else { return Ok(()) };
        for &robot in robots {
            let RobotBody { name, speed_m_per_s, .. } = &self.bodies[robot];
            if *speed_m_per_s < fastest {
                let found = format!(
                    "`{name}` with {speed_m_per_s} m/s, slower than the target `{target}` with {fastest} m/s"
                );
                let allowed = "robots that are at least as fast as the targets; `allow_slower = true` permits others";
                return Err(SettingError::new("robots", found, allowed));
            }
        }
        Ok(())
    }
}
