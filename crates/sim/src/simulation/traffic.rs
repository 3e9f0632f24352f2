//! The traffic that the networks of a setup give to its nodes.

use std::sync::Arc;

use sextant_kernel::{NodeId, SettingError};

use super::stations::Stations;
use crate::applications::node_traffic::NodeTraffic;
use crate::applications::source::Source;
use crate::applications::traffic::Traffic;
use crate::service::network_id::NetworkId;
use crate::setup::Setup;

/// The traffic of each node; none where a node does not send it.
pub(super) fn of_nodes(setup: &Setup, sends: impl Fn(NodeId) -> bool) -> Result<Vec<NodeTraffic>, SettingError> {
    let stations = Stations::of(setup);
    let mut sources: Vec<Vec<Source>> = vec![Vec::new(); stations.roll.nodes];
    for (id, network) in (0..=u8::MAX).map(NetworkId).zip(&setup.networks) {
        stations.check_frames(id, network)?;
        let kinds: Vec<(&Traffic, Arc<Traffic>)> =
            network.traffic.kinds().map(|kind| (kind, Arc::new(kind.clone()))).collect();
        let shared = |traffic: &Traffic| {
            let known = kinds.iter().find(|(kind, _)| std::ptr::eq(*kind, traffic));
            known.map_or_else(|| Arc::new(traffic.clone()), |(_, shared)| Arc::clone(shared))
        };
        for (node, sources) in sources.iter_mut().enumerate() {
            let node = NodeId::from_index(node);
            let has_it = |node: &NodeId| network.has(*node) && sends(*node);
            let Some(traffic) = Some(node).filter(has_it).and_then(|node| network.traffic.of(node)) else { continue };
            let to = stations.destination(id, traffic, node)?;
            let clock = network.technology.settings().radio().clock(setup.seed, id, node);
            sources.push(Source::new(id, shared(traffic), to).with_clock(clock));
        }
    }
    Ok(sources.into_iter().map(NodeTraffic::new).collect())
}
