//! The map that the nodes of a scenario compute themselves.

use std::sync::Arc;
use std::time::Duration;

use sextant_apps::distributed::{
    BearingSource, DistributedMapping, DistributedMappingConfig, MappingNode, MobileAnchor, NodeAntenna,
    PatternBearings, Patterns,
};
use sextant_channel::{Anchor, Antenna, AntennaConfig, SectorTable};
use sextant_kernel::text::counted;
use sextant_kernel::{NodeId, SettingError};
use sextant_mac::dmg::MAX_BEACON_PAYLOAD_OCTETS;
use sextant_mapper::BearingTable;
use sextant_sim::{Antennas, Broadcast, Network, NetworkId, Robot, RoleConfig, Setup};

use super::check_all_nodes;
use crate::check::errors::Errors;
use crate::check::maps::{MapJob, check_name};
use crate::check::networks::Networks;
use crate::check::networks::network::CheckedNetwork;
use crate::config::ScenarioConfig;

/// The table of the scenario.
const TABLE: &str = "distributed_mapping";

/// A map that the nodes compute themselves.
#[derive(Clone, Debug)]
pub struct NodeMapJob {
    /// Its name in tables and recordings.
    pub name: String,
    /// The algorithm: `dmmtm-ss` with static anchors alone, `dmmtm-hs` with mobile ones too.
    pub algorithm: &'static str,
    /// The network over which the nodes exchange messages.
    pub network: NetworkId,
    /// Distance of neighbouring grid vertices (m).
    pub grid_step_m: f64,
    /// Most iterations.
    pub max_iterations: u32,
    settings: Arc<DistributedMapping>,
    antenna: Option<NodeAntenna>,
    patterns: Patterns,
}

impl NodeMapJob {
    /// The applications of `nodes` nodes, of which `anchors` know their place.
    #[must_use]
    pub fn nodes(&self, nodes: usize, anchors: &[Anchor]) -> Vec<MappingNode> {
        let place = |node| anchors.iter().find(|anchor| anchor.node == node).map(|anchor| anchor.position);
        let node = |node| {
            let patterns = self.patterns.clone();
            MappingNode::new(Arc::clone(&self.settings), self.network, self.antenna, patterns, place(node))
        };
        (0..nodes).map(|index| node(NodeId::from_index(index))).collect()
    }

    /// Sectors of the antenna of each node; one without sectors.
    #[must_use]
    pub fn sectors(&self) -> u8 {
        self.antenna.map_or(1, |antenna| antenna.sectors)
    }

    /// Whether anchors work out the directions of their sectors.
    #[must_use]
    pub fn has_sectors(&self) -> bool {
        self.antenna.is_some()
    }

    /// When it ends at the latest, if it needs all of its iterations.
    #[must_use]
    pub fn longest(&self) -> Duration {
        self.settings.longest(self.has_sectors())
    }
}

/// What a map of the nodes is computed with.
pub(crate) struct NodeMapInput<'a> {
    pub(crate) config: &'a ScenarioConfig,
    pub(crate) networks: &'a Networks<'a>,
    pub(crate) anchors: &'a [Anchor],
    pub(crate) maps: &'a [MapJob],
}

/// The map that the nodes compute, if they do. Robots of `setup` that are mobile anchors get what they send.
pub(crate) fn check_distributed(
    input: &NodeMapInput<'_>,
    setup: &mut Setup,
    errors: &mut Errors,
) -> Option<NodeMapJob> {
    let NodeMapInput { config, networks, anchors, maps } = *input;
    let written = config.distributed_mapping.as_ref()?;
    let has_mobile = config.robots.iter().any(|robot| robot.role == RoleConfig::Anchor);
    let network = errors.take(TABLE, networks.number("network", written.network.as_deref()))?;
    check_phase(written, has_mobile, errors);
    if anchors.is_empty() && !has_mobile {
        let needed = "at least one node, or a robot with `role = \"anchor\"`, that knows its place";
        let found = format!("0 of the {}", counted(setup.world.nodes.len(), "node"));
        errors.refuse(&SettingError::new("anchors", found, needed));
    }
    let algorithm = if has_mobile { "dmmtm-hs" } else { "dmmtm-ss" };
    let name = written.name.clone().unwrap_or_else(|| algorithm.to_owned());
    check_name(&name, TABLE, maps, errors);
    let (busy, tables) = (&setup.networks[network.index()], networks.network(network));
    check_all_nodes(busy, tables, setup.world.nodes.len(), TABLE, errors);
    let antennas = match busy.technology.antennas() {
        Some(antennas) => Some(sectors(antennas, tables, has_mobile, errors)?),
        None => None,
    };
    let settings = Arc::new(errors.take(TABLE, DistributedMapping::try_from(written))?);
    let patterns = patterns(&settings, busy, has_mobile, errors);
    let told = antennas.as_ref().map(|sectors| (&sectors.of_robots, sectors.per_ring));
    let mobile = MobileAnchor::new(Arc::clone(&settings), told);
    if has_mobile && told.is_some() {
        check_message(&mobile, busy, tables, errors);
    }
    let broadcast: Box<dyn Broadcast> = Box::new(mobile);
    for (i, robot) in config.robots.iter().enumerate().filter(|(_, robot)| robot.role == RoleConfig::Anchor) {
        let Some(built) = setup.robots.iter_mut().find(|built| built.body.name == robot.name) else { continue };
        check_network(i, built, network, input, errors);
        *built = built.clone().with_broadcast(broadcast.clone());
    }
    Some(NodeMapJob {
        name,
        algorithm,
        network,
        grid_step_m: written.place.grid_step_m,
        max_iterations: written.max_iterations,
        settings,
        antenna: antennas.map(|sectors| sectors.of_nodes),
        patterns,
    })
}

/// The time of mobile anchors is given if, and only if, there are any.
fn check_phase(written: &DistributedMappingConfig, has_mobile: bool, errors: &mut Errors) {
    const KEY: &str = "mobile_phase_s";
    let error = match (written.mobile_phase_s, has_mobile) {
        (None, true) => SettingError::missing(KEY, "a time, because a robot has `role = \"anchor\"`"),
        (Some(_), false) => {
            let with = "the robots, of which none has `role = \"anchor\"`";
            SettingError::conflict(KEY, with, "remove it, or add a robot with that role")
        }
        _ => return,
    };
    errors.refuse(&error.within(TABLE));
}

/// What a mobile anchor tells of its sectors must fit in a frame.
fn check_message(mobile: &MobileAnchor, network: &Network, tables: &CheckedNetwork<'_>, errors: &mut Errors) {
    let most = usize::from(MAX_BEACON_PAYLOAD_OCTETS);
    let octets = mobile.largest_octets();
    if octets > most {
        let rings = network.technology.antennas().map_or(1, |antennas| antennas.robots().rings());
        let found = format!("{rings} rings: a mobile anchor tells their directions in a message of {octets} octets");
        let allowed = format!("fewer rings, so that the message has at most {most} octets");
        let error = SettingError::new("robots.sectors.elevations_deg", found, allowed);
        errors.refuse(&error.within(&tables.antenna.key));
    }
}

/// A mobile anchor sends in the network of the map, and in no other.
fn check_network(i: usize, robot: &Robot, network: NetworkId, input: &NodeMapInput<'_>, errors: &mut Errors) {
    if robot.body.networks == [network] {
        return;
    }
    let name = |id: NetworkId| input.networks.network(id).name;
    let names: Vec<String> = robot.body.networks.iter().filter_map(|&id| Some(format!("`{}`", name(id)?))).collect();
    let key = if input.config.robots[i].networks.is_empty() { "network" } else { "networks" };
    let own = name(network).unwrap_or_default();
    let allowed = format!("`{own}` alone, the network of `{TABLE}`, for a robot with `role = \"anchor\"`");
    let key = format!("{}.{key}", input.config.table_of_robot(i));
    errors.refuse(&SettingError::new(key, names.join(", "), allowed));
}

/// The sectors of the stations of a network.
struct Sectors {
    of_nodes: NodeAntenna,
    of_robots: SectorTable,
    /// Sectors of robots in a ring.
    per_ring: u8,
}

/// The sectors of these `antennas`, if the map can be computed with them.
fn sectors(
    antennas: &Antennas,
    tables: &CheckedNetwork<'_>,
    has_mobile: bool,
    errors: &mut Errors,
) -> Option<Sectors> {
    let written = tables.antenna.value?;
    let of_nodes = errors.take(&tables.antenna.key, node_antenna(antennas.nodes(), &written.nodes))?;
    let rings = "rings of equal sectors, because mobile anchors tell their directions ring by ring";
    if has_mobile && !matches!(written.robots, AntennaConfig::Sectors(_)) {
        let found = kind(&written.robots);
        errors.refuse(&SettingError::new("robots", found, rings).within(&tables.antenna.key));
        return None;
    }
    if has_mobile && antennas.turn_with_robots() {
        let allowed = "\"compass\": mobile anchors tell the directions of their sectors once";
        errors.refuse(&SettingError::new("robot_headings", "\"body\"", allowed).within(&tables.antenna.key));
        return None;
    }
    let robots = antennas.robots();
    let per_ring = robots.sector_count() / robots.rings();
    Some(Sectors { of_nodes, of_robots: antennas.robot_sectors().clone(), per_ring })
}

/// By which strengths tell directions, if they do.
fn patterns(settings: &DistributedMapping, network: &Network, has_mobile: bool, errors: &mut Errors) -> Patterns {
    let BearingSource::Pattern(PatternBearings { error_db }) = settings.bearings() else {
        return Patterns::default();
    };
    let Some(antennas) = network.technology.antennas() else {
        let with = "a network without sectors";
        let error = SettingError::conflict("bearings.pattern", with, "remove it, or add `mac.sector_sweep`");
        errors.refuse(&error.within(TABLE));
        return Patterns::default();
    };
    let table = |antenna: &Antenna| {
        Arc::new(BearingTable::new(antenna, antenna.sector_count() / antenna.rings().max(1), error_db))
    };
    Patterns { nodes: Some(table(antennas.nodes())), robots: has_mobile.then(|| table(antennas.robots())) }
}

/// The antenna of nodes, which must be one ring of equal sectors.
fn node_antenna(antenna: &Antenna, written: &AntennaConfig) -> Result<NodeAntenna, SettingError> {
    let allowed = "one ring of equal sectors, whose directions an anchor can work out";
    let AntennaConfig::Sectors(_) = written else {
        return Err(SettingError::new("nodes", kind(written), allowed));
    };
    if antenna.rings() != 1 {
        let found = format!("{} rings", antenna.rings());
        return Err(SettingError::new("nodes.sectors.elevations_deg", found, allowed));
    }
    let table = antenna.sectors();
    let wedge = table.iter().next().expect("a ring has a sector").wedge()?;
    let [low_rad, high_rad] = wedge.elevation_rad;
    Ok(NodeAntenna { sectors: antenna.sector_count(), vertical_width_rad: high_rad - low_rad })
}

/// What kind of antenna it is, as in a scenario.
fn kind(antenna: &AntennaConfig) -> &'static str {
    match antenna {
        AntennaConfig::Omnidirectional(_) => "`omnidirectional`",
        AntennaConfig::Sectors(_) => "`sectors`",
        AntennaConfig::CodeBook(_) => "`code_book`",
    }
}
