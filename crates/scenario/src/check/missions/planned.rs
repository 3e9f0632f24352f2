//! The missions of a scenario.

use std::sync::Arc;
use std::time::Duration;

use sextant_apps::{
    MapSourceConfig, Mission, MissionConfig, MissionGoal, MissionLinks, MissionMedium, MissionPlace, MissionRobots,
};
use sextant_channel::Position;
use sextant_kernel::text::counted;
use sextant_kernel::{Files, SettingError};
use sextant_sim::layout::PlacedNode;
use sextant_sim::{Network, NetworkId, RobotBody, RoleConfig, Setup, Technology};

use super::distributed::NodeMapJob;
use super::{check_all_nodes, outside};
use crate::check::errors::Errors;
use crate::check::maps::{MapJob, check_name};
use crate::check::networks::Networks;
use crate::config::ScenarioConfig;

/// A mission that has been checked.
#[derive(Clone, Debug)]
pub struct PlannedMission {
    /// Its name in tables and recordings; unique in the scenario.
    pub name: String,
    /// The map that it is given.
    pub map: MissionMap,
    /// The numbers of its robots among those of the scenario.
    pub robots: Vec<usize>,
    /// The network of its messages.
    pub network: NetworkId,
    /// When it ends at the latest.
    pub duration: Duration,
    /// Name of its algorithm in tables.
    pub algorithm: &'static str,
    /// What it does.
    pub mission: Arc<dyn Mission>,
}

impl PlannedMission {
    /// What it is after.
    #[must_use]
    pub fn goal(&self) -> MissionGoal {
        self.mission.goal()
    }
}

/// The map that a mission is given.
#[derive(Clone, Debug, PartialEq)]
pub enum MissionMap {
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

impl MissionMap {
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
pub(crate) const LEAST_PLACES: usize = 3;

/// What missions may name.
pub(crate) struct Surroundings<'a> {
    pub(crate) config: &'a ScenarioConfig,
    pub(crate) files: &'a Files,
    pub(crate) setup: &'a Setup,
    pub(crate) networks: &'a Networks<'a>,
    pub(crate) bodies: &'a [RobotBody],
    pub(crate) maps: &'a [MapJob],
    pub(crate) distributed: Option<&'a NodeMapJob>,
}

/// The missions of the scenario, with unique names.
pub(crate) fn check_missions(around: &Surroundings<'_>, errors: &mut Errors) -> Vec<PlannedMission> {
    let mut missions: Vec<PlannedMission> = Vec::new();
    for (i, written) in around.config.applications.iter().enumerate() {
        let table = format!("applications[{i}]");
        let name = written.name.clone().unwrap_or_else(|| written.algorithm.settings().name().to_owned());
        let taken = TakenNames { maps: around.maps, distributed: around.distributed, missions: &missions };
        taken.check(&name, &table, errors);
        let map = errors.take(&table, around.map(written));
        // The numbers of robots are not known if one of them was refused.
        let are_known = around.bodies.len() == around.config.robots.len();
        let robots = if are_known { errors.take(&table, around.robots(written)) } else { None };
        let network = errors.take(&table, around.networks.number("network", written.network.as_deref()));
        let links = written.algorithm.settings().links();
        let network = network.filter(|&network| around.check_network(network, links, &table, errors));
        let duration =
            SettingError::in_range("duration_s", written.duration_s, 1e-3, 1e7).map(Duration::from_secs_f64);
        let duration = errors.take(&table, duration);
        let algorithm = written.algorithm.settings();
        let mission = network.and_then(|network| {
            let place = around.place(network)?;
            errors.take(&table, algorithm.check_world(&place))?;
            let checked = algorithm.check(&place);
            let checked = checked.map_err(|error| error.within(format!("algorithm.{}", algorithm.key())));
            errors.take(&table, checked)
        });
        if let Some(robots) = &robots {
            let bodies: Vec<&RobotBody> = robots.iter().map(|&robot| &around.bodies[robot]).collect();
            let targets = &around.config.world.targets;
            let robots = MissionRobots { bodies: &bodies, targets, may_be_slower: written.allow_slower };
            errors.take(&table, algorithm.check_robots(&robots));
        }
        if let (Some(map), Some(robots), Some(network), Some(duration), Some(mission)) =
            (map, robots, network, duration, mission)
        {
            let algorithm = algorithm.name();
            missions.push(PlannedMission { name, map, robots, network, duration, algorithm, mission });
        }
    }
    missions
}

/// What has names that a mission may not have.
pub(crate) struct TakenNames<'a> {
    pub(crate) maps: &'a [MapJob],
    pub(crate) distributed: Option<&'a NodeMapJob>,
    pub(crate) missions: &'a [PlannedMission],
}

impl TakenNames<'_> {
    /// Refuses names that are not plain or that something else in the recording has.
    pub(crate) fn check(&self, name: &str, table: &str, errors: &mut Errors) {
        check_name(name, table, self.maps, errors);
        let taken = match name {
            "survey" => "the name of the first phase",
            _ if self.missions.iter().any(|other| other.name == name) => "the name of an earlier application",
            _ if self.distributed.is_some_and(|map| map.name == name) => "the name of the map of the nodes",
            _ => return,
        };
        errors.refuse(&SettingError::new("name", format!("`{name}`, {taken}"), "a unique name").within(table));
    }
}

impl Surroundings<'_> {
    fn nodes(&self) -> &[PlacedNode] {
        &self.setup.world.nodes
    }

    /// The map of a mission.
    fn map(&self, written: &MissionConfig) -> Result<MissionMap, SettingError> {
        if self.nodes().len() < LEAST_PLACES {
            let found = format!("a map of {}", counted(self.nodes().len(), "node"));
            return Err(SettingError::new("map", found, format!("a world with at least {LEAST_PLACES} nodes")));
        }
        match &written.map {
            MapSourceConfig::Physical {} => Ok(MissionMap::Physical),
            MapSourceConfig::Computed(name) => {
                let of_nodes = self.distributed.iter().map(|map| map.name.as_str());
                let known: Vec<&str> = of_nodes.chain(self.maps.iter().map(|map| map.name.as_str())).collect();
                if known.contains(&name.as_str()) {
                    return Ok(MissionMap::Computed(name.clone()));
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
                Ok(MissionMap::File { name, places })
            }
        }
    }

    /// The robots of a mission.
    fn robots(&self, written: &MissionConfig) -> Result<Vec<usize>, SettingError> {
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

    /// What a mission in a network that has been checked sees of the scenario; `None` if its links carry neither messages nor
    /// have sectors.
    fn place(&self, network: NetworkId) -> Option<MissionPlace<'_>> {
        let Setup { world, sinks, networks, .. } = self.setup;
        let is_in = |sink: &sextant_sim::Sink| sink.is_in(network);
        let technology = &networks[network.index()].technology;
        let medium = match technology {
            Technology::Ieee80211ad(links) => MissionMedium::Sectors(links, technology.antennas()?),
            _ => MissionMedium::Messages(&technology.ieee802154()?.radio),
        };
        Some(MissionPlace {
            world,
            targets: &self.config.world.targets,
            sensors: &self.config.sensors,
            // A sink that has no place is a mistake of its own.
            has_sink: sinks.iter().any(is_in) || sinks.len() < self.config.sinks.len(),
            medium,
        })
    }

    /// Refuses networks in which nodes and robots cannot exchange messages. Returns whether it is a good one.
    fn check_network(&self, network: NetworkId, links: MissionLinks, table: &str, errors: &mut Errors) -> bool {
        let before = errors.found.len();
        let busy: &Network = &self.setup.networks[network.index()];
        if links == MissionLinks::Sectors {
            return self.check_sectors(busy, table, errors);
        }
        if busy.technology.ieee802154().is_none() {
            let mac = self.networks.network(network).mac.value;
            let with = if mac.sweeps_sectors() { "sector sweeps".to_owned() } else { format!("`mac.{}`", mac.key()) };
            let found =
                busy.name.as_ref().map_or(format!("one with {with}"), |name| format!("`{name}`, with {with}"));
            let allowed =
                "a network with a channel access of IEEE 802.15.4, over which nodes and robots exchange messages";
            errors.refuse(&SettingError::new("network", found, allowed).within(table));
            return false;
        }
        check_all_nodes(busy, self.networks.network(network), self.nodes().len(), table, errors);
        errors.found.len() == before
    }

    /// Refuses a network whose antennas have no sectors. Returns whether it is a good one.
    fn check_sectors(&self, network: &Network, table: &str, errors: &mut Errors) -> bool {
        let found = match &network.technology {
            Technology::Ieee80211ad(_) if outside(network, self.nodes().len()) == 0 => return true,
            Technology::Ieee80211ad(_) => "one without some of the nodes",
            _ => "one without sector sweeps",
        };
        let allowed = "a network of all nodes with `mac.sector_sweep`, whose beams follow";
        errors.refuse(&SettingError::new("network", found, allowed).within(table));
        false
    }
}
