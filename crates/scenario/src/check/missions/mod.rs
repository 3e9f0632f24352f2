//! What robots and nodes do on maps, and the maps that nodes compute themselves.

pub(crate) mod distributed;
pub(crate) mod planned;

use sextant_kernel::{NodeId, SettingError};
use sextant_sim::{MacConfig, Network};

use super::errors::Errors;
use super::networks::network::CheckedNetwork;

/// How many of the `nodes` nodes are not in the network.
pub(crate) fn outside(network: &Network, nodes: usize) -> usize {
    (0..nodes).filter(|&node| !network.has(NodeId::from_index(node))).count()
}

/// Refuses a network in `table` that is not one of all of the `nodes` nodes, or in which they do not hear each other at any time.
fn check_all_nodes(network: &Network, tables: &CheckedNetwork<'_>, nodes: usize, table: &str, errors: &mut Errors) {
    let outside = outside(network, nodes);
    if outside > 0 {
        let found = format!("a network without {outside} of the {nodes} nodes");
        errors.refuse(&SettingError::new("network", found, "a network of all nodes").within(table));
    }
    let why = "because nodes must hear each other's messages at any time";
    let mac = tables.mac.value;
    let error = match mac {
        MacConfig::SectorSweep(_) => return,
        MacConfig::CsmaUnslotted(csma) if csma.rx_on_when_idle => return,
        MacConfig::CsmaUnslotted(_) => {
            SettingError::new("csma_unslotted.rx_on_when_idle", "false", format!("true, {why}"))
        }
        MacConfig::BeaconEnabled(_) | MacConfig::Program(_) | MacConfig::Sleep(_) | MacConfig::Tsch(_) => {
            SettingError::new(mac.key(), "a table", format!("`sector_sweep` or `csma_unslotted`, {why}"))
        }
    };
    errors.refuse(&error.within(&tables.mac.key));
}
