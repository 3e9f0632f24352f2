//! The map that the nodes of a scenario compute themselves.

use std::sync::Arc;
use std::time::Duration;

use sextant_apps::distributed::{
    BearingSource, DistributedMapping, DistributedMappingConfig, MappingNode, MobileAnchor, NodeAntenna,
    PatternBearings, Patterns,
};
use sextant_channel::{Anchor, Antenna, AntennaConfig, SectorTable};
use sextant_kernel::{NodeId, SettingError};
use sextant_mac::dmg::MAX_BEACON_PAYLOAD_OCTETS;
use sextant_mapper::BearingTable;
use sextant_sim::{Broadcast, MacConfig, Network, NetworkId, Robot, RoleConfig, Setup};

use crate::check::errors::Errors;
use crate::check::maps::{MapJob, check_name};
use crate::check::networks::{self, NetworkTables};
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

/// The map that the nodes of `config` compute, if they do. Robots that are mobile anchors get what they send.
pub(crate) fn check_distributed(
    config: &ScenarioConfig,
    tables: &[NetworkTables<'_>],
    setup: &mut Setup,
    (anchors, maps): (&[Anchor], &[MapJob]),
    errors: &mut Errors,
) -> Option<NodeMapJob> {
    let written = config.distributed_mapping.as_ref()?;
    let has_mobile = config.robots.iter().any(|robot| robot.role == RoleConfig::Anchor);
    let network = networks::number("network", written.network.as_deref(), &config.networks);
    let network = errors.take(TABLE, network)?;
    check_phase(written, has_mobile, errors);
    if anchors.is_empty() && !has_mobile {
        let needed = "at least one node, or a robot with `role = \"anchor\"`, that knows its place";
        errors.refuse(&SettingError::missing("anchors", needed));
    }
    let algorithm = if has_mobile { "dmmtm-hs" } else { "dmmtm-ss" };
    let name = written.name.clone().unwrap_or_else(|| algorithm.to_owned());
    check_name(&name, TABLE, maps, errors);
    let (nodes, at) = (setup.world.nodes.len(), network.index());
    let busy = &setup.networks[at];
    let outside = (0..nodes).filter(|&node| !busy.has(NodeId::from_index(node))).count();
    if outside > 0 {
        let found = format!("a network without {outside} of the {nodes} nodes");
        errors.refuse(&SettingError::new("network", found, "a network of all nodes").within(TABLE));
    }
    check_receivers(&tables[at], errors);
    let antennas = antennas(busy, &tables[at], has_mobile, errors)?;
    let settings = Arc::new(errors.take(TABLE, DistributedMapping::try_from(written))?);
    let patterns = patterns(&settings, busy, has_mobile, errors);
    let sectors = antennas.as_ref().map(|(_, of_robots, per_ring)| (of_robots, *per_ring));
    let mobile = MobileAnchor::new(Arc::clone(&settings), sectors);
    if has_mobile && sectors.is_some() {
        check_message(&mobile, busy, &tables[at], errors);
    }
    let broadcast: Box<dyn Broadcast> = Box::new(mobile);
    for (i, robot) in config.robots.iter().enumerate().filter(|(_, robot)| robot.role == RoleConfig::Anchor) {
        let Some(built) = setup.robots.iter_mut().find(|built| built.body.name == robot.name) else { continue };
        check_network(i, built, network, config, errors);
        *built = built.clone().with_broadcast(broadcast.clone());
    }
    Some(NodeMapJob {
        name,
        algorithm,
        network,
        grid_step_m: written.place.grid_step_m,
        max_iterations: written.max_iterations,
        settings,
        antenna: antennas.map(|(of_nodes, ..)| of_nodes),
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

/// Nodes must hear each other.
pub(crate) fn check_receivers(tables: &NetworkTables<'_>, errors: &mut Errors) {
    let why = "because nodes must hear each other's messages at any time";
    let error = match tables.mac.value {
        MacConfig::SectorSweep(_) => return,
        MacConfig::CsmaUnslotted(csma) if csma.rx_on_when_idle => return,
        MacConfig::CsmaUnslotted(_) => {
            SettingError::new("csma_unslotted.rx_on_when_idle", "false", format!("true, {why}"))
        }
        MacConfig::BeaconEnabled(_) => {
            SettingError::new("beacon_enabled", "a table", format!("`sector_sweep` or `csma_unslotted`, {why}"))
        }
    };
    errors.refuse(&error.within(&tables.mac.key));
}

/// What a mobile anchor tells of its sectors must fit in a frame.
fn check_message(mobile: &MobileAnchor, network: &Network, tables: &NetworkTables<'_>, errors: &mut Errors) {
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
fn check_network(i: usize, robot: &Robot, network: NetworkId, config: &ScenarioConfig, errors: &mut Errors) {
    if robot.body.networks == [network] {
        return;
    }
    let names: Vec<String> = robot
        .body
        .networks
        .iter()
        .filter_map(|id| config.networks.keys().nth(id.index()))
        .map(|name| format!("`{name}`"))
        .collect();
    let key = if config.robots[i].networks.is_empty() { "network" } else { "networks" };
    let own = config.networks.keys().nth(network.index()).map_or("", String::as_str);
    let allowed = format!("`{own}` alone, the network of `{TABLE}`, for a robot with `role = \"anchor\"`");
    errors.refuse(&SettingError::new(format!("{}.{key}", config.table_of_robot(i)), names.join(", "), allowed));
}

/// The antenna of nodes, and the sectors of robots with their number in a ring; `None` within if the network has no
/// sectors, and without if there is an error.
#[expect(clippy::option_option, reason = "an error is not the same as a network without sectors")]
fn antennas(
    network: &Network,
    tables: &NetworkTables<'_>,
    has_mobile: bool,
    errors: &mut Errors,
) -> Option<Option<(NodeAntenna, SectorTable, u8)>> {
    let Some(antennas) = network.technology.antennas() else { return Some(None) };
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
    Some(Some((of_nodes, antennas.robot_sectors().clone(), robots.sector_count() / robots.rings())))
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
