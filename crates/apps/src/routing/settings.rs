//! Routing, checked: its settings and its tree.

use std::sync::Arc;
use std::time::Duration;

use sextant_kernel::{Files, SettingError, StationId};
use sextant_mac::routing::{HEADER_OCTETS, MAX_STATIONS, Trickle};
use sextant_sim::Setup;

use super::config::{CollectionConfig, RoutedTo, RoutingConfig, TreeConfig};
use super::links::UsableLinks;
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
}

/// Where the tree comes from.
#[derive(Clone, Debug)]
pub(super) enum Plan {
    Fixed(Arc<Tree>),
    Built { trickle: Trickle, hysteresis_etx: f64 },
}

impl Routing {
    /// Routing among the stations of `setup`, as `config` says; a file is among `files`.
    ///
    /// # Errors
    /// If a number is out of range, or the tree does not reach each node, or there are too many stations.
    pub fn new(config: &RoutingConfig, setup: &Setup, files: &Files) -> Result<Self, SettingError> {
        let &RoutingConfig { ref tree, queue_packets, resends, usable_prr, to } = config;
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
        };
        Ok(Self { queue_packets: queue_packets.into(), resends, to, nodes, plan, links })
    }

    /// The tree, if it is fixed.
    #[must_use]
    pub fn tree(&self) -> Option<&Tree> {
        match &self.plan {
            Plan::Fixed(tree) => Some(tree),
            Plan::Built { .. } => None,
        }
    }

    /// The usable links of the layout.
    #[must_use]
    pub fn links(&self) -> &UsableLinks {
        &self.links
    }

    /// The least size of a frame of the traffic whose packets go to sinks only: a header of the MAC and one of a packet (octets).
    pub const LEAST_MPDU_OCTETS: u8 = MAC_OCTETS + HEADER_OCTETS;
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
