//! Routing, checked: its settings and its tree.

use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{Files, SettingError, StationId};
use sextant_mac::routing::fragment::MOST_OCTETS;
use sextant_mac::routing::rpl::LEAST_DATA_OCTETS;
use sextant_mac::routing::{HEADER_OCTETS, MAX_STATIONS, Trickle};
use sextant_sim::Setup;

use super::config::{CollectionConfig, FragmentsConfig, RoutedTo, RoutingConfig, TreeConfig};
use super::links::UsableLinks;
use super::rpl::{RplMode, RplPlan};
use super::tree::Tree;

/// Size of the header and the check sequence of a data frame among stations with short addresses (octets).
pub(super) const MAC_OCTETS: u8 = 11;

/// Largest payload of such a frame (octets).
pub(super) const MOST_PAYLOAD_OCTETS: usize = 127 - MAC_OCTETS as usize;

/// Routing in the first network of a setup, checked.
#[derive(Clone, Debug)]
pub struct Routing {
    pub(super) queue_packets: usize,
    pub(super) resends: u8,
    pub(super) to: RoutedTo,
    /// Number of nodes.
    pub(super) nodes: u32,
    pub(super) plan: Plan,
    pub(super) links: Arc<UsableLinks>,
    /// How packets go in fragments, if they do.
    pub(super) fragments: Option<Fragmenting>,
}

/// How packets go in fragments.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fragmenting {
    /// Size of a packet of a node (octets).
    pub(super) packet_octets: usize,
    /// How long a packet may take to be complete, ...
    pub(super) timeout: Duration,
    /// ... and how many a station puts together at the same time.
    pub(super) most: usize,
}

/// Where the tree comes from.
#[derive(Clone, Debug)]
pub(super) enum Plan {
    Fixed(Arc<Tree>),
    Built { trickle: Trickle, hysteresis_etx: f64 },
    Rpl(Arc<RplPlan>),
}

impl Routing {
    /// Routing among the stations of `setup`, as `config` says; a file is among `files`.
    ///
    /// # Errors
    /// If a number is out of range, or the tree does not reach each node, or there are too many stations.
    pub fn new(config: &RoutingConfig, setup: &Setup, files: &Files) -> Result<Self, SettingError> {
        let &RoutingConfig { ref tree, queue_packets, resends, usable_prr, to, fragments } = config;
        if !(1..=1000).contains(&queue_packets) {
            return Err(SettingError::new("queue_packets", queue_packets, "1 to 1000"));
        }
        if !(usable_prr > 0.0 && usable_prr <= 1.0) {
            return Err(SettingError::new("usable_prr", usable_prr, "above 0, to 1"));
        }
        let stations = setup.world.nodes.len() + setup.robots.len() + setup.sinks.len();
        if stations > MAX_STATIONS {
            let allowed = format!("at most {MAX_STATIONS}, whose numbers have 16 bits in packets");
            return Err(SettingError::new("", format!("set for {stations} stations"), allowed));
        }
        let nodes = StationId::from_index(setup.world.nodes.len()).0;
        if to == RoutedTo::Nodes && nodes < 2 {
            return Err(SettingError::new("to", "`nodes`, among less than two nodes", "at least two nodes"));
        }
        let links = Arc::new(UsableLinks::new(setup, usable_prr)?);
        let plan = match tree {
            TreeConfig::Given(given) => {
                let sinks: Vec<&str> = setup.sinks.iter().map(|sink| sink.name.as_str()).collect();
                let tree = Tree::read(&given.file, &setup.world.nodes, setup.robots.len(), &sinks, files);
                Plan::Fixed(Arc::new(tree.map_err(|error| error.within("tree.given"))?))
            }
            TreeConfig::Shortest(shortest) => {
                Plan::Fixed(Arc::new(Tree::shortest(&links, &roots(setup), shortest.metric)))
            }
            TreeConfig::Collection(collection) => {
                let trickle = trickle(collection).map_err(|error| error.within("tree.collection"))?;
                Plan::Built { trickle, hysteresis_etx: collection.hysteresis_etx }
            }
            TreeConfig::Rpl(rpl) => {
                if rpl.mode == RplMode::None && to != RoutedTo::Sink {
                    let remedy = "set `mode` to `non_storing` or `storing`, so that somebody knows ways down";
                    let with = "`routing.to`, by which packets go down";
                    return Err(SettingError::conflict("tree.rpl.mode", with, remedy));
                }
                Plan::Rpl(Arc::new(RplPlan::try_from(rpl).map_err(|error| error.within("tree.rpl"))?))
            }
        };
        let fragments = fragments.as_ref().map(Fragmenting::try_from).transpose();
        let fragments = fragments.map_err(|error| error.within("fragments"))?;
        Ok(Self { queue_packets: queue_packets.into(), resends, to, nodes, plan, links, fragments })
    }

    /// The least size of a frame of the traffic: a header of the MAC and those of a packet (octets).
    #[must_use]
    pub const fn least_mpdu_octets(tree: &TreeConfig, to: RoutedTo) -> u8 {
        match tree {
            TreeConfig::Rpl(_) => MAC_OCTETS + LEAST_DATA_OCTETS,
            TreeConfig::Given(_) | TreeConfig::Shortest(_) | TreeConfig::Collection(_) => {
                MAC_OCTETS + HEADER_OCTETS + to.further_octets()
            }
        }
    }
}

impl TryFrom<&FragmentsConfig> for Fragmenting {
    type Error = SettingError;

    fn try_from(config: &FragmentsConfig) -> Result<Self, SettingError> {
        let &FragmentsConfig { packet_octets, reassembly_s, reassembly_buffers } = config;
        if !(40..=MOST_OCTETS).contains(&packet_octets) {
            return Err(SettingError::new("packet_octets", packet_octets, format!("40 to {MOST_OCTETS}")));
        }
        if reassembly_buffers == 0 {
            return Err(SettingError::new("reassembly_buffers", 0, "1 to 255"));
        }
        let timeout_s = SettingError::in_range("reassembly_s", reassembly_s, 0.1, 60.0)?;
        let (packet_octets, most) = (packet_octets.into(), reassembly_buffers.into());
        Ok(Self { packet_octets, timeout: Duration::from_secs_f64(timeout_s), most })
    }
}

/// The sinks of a setup.
pub(super) fn roots(setup: &Setup) -> Vec<StationId> {
    let first = setup.world.nodes.len() + setup.robots.len();
    (first..first + setup.sinks.len()).map(StationId::from_index).collect()
}

fn trickle(config: &CollectionConfig) -> Result<Trickle, SettingError> {
    let shortest_s = SettingError::in_range("beacon_min_s", config.beacon_min_s, 0.01, 1e5)?;
    let longest_s = SettingError::in_range("beacon_max_s", config.beacon_max_s, shortest_s, 1e6)?;
    SettingError::in_range("hysteresis_etx", config.hysteresis_etx, 0.0, 100.0)?;
    Ok(Trickle::new(Duration::from_secs_f64(shortest_s), Duration::from_secs_f64(longest_s)))
}
