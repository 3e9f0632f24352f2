//! The signal strengths that robots measured.

use sextant_channel::{Position, ReceptionLog};
use sextant_kernel::NodeId;

use super::gross_strengths;
use crate::error::MapError;

/// With what strength a stop received a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Strength {
    /// Place of the stop (m).
    pub(crate) place: Position,
    /// Mean strength of the packets received there (dBm).
    pub(crate) rssi_dbm: f64,
}

/// The strengths of `node`, stop by stop. A stop with several sectors has one for each sector that received the node.
pub(crate) fn strengths(log: &ReceptionLog, node: NodeId) -> Vec<Strength> {
    strengths_at(log, node, |_| true)
}

/// The same without those that contradict all others.
pub(crate) fn sound_strengths(log: &ReceptionLog, node: NodeId) -> Vec<Strength> {
    let gross = gross_strengths::of_node(log, node);
    strengths_at(log, node, |stop| gross.iter().all(|gross| gross.stop != stop))
}

fn strengths_at(log: &ReceptionLog, node: NodeId, counts: impl Fn(u32) -> bool) -> Vec<Strength> {
    let receptions = log.of(node).iter().filter(|reception| reception.received > 0 && counts(reception.stop));
    receptions
        .filter_map(|reception| {
            let place = log.stops()[reception.stop as usize].position;
            Some(Strength { place, rssi_dbm: reception.rssi_dbm? })
        })
        .collect()
}

/// The strengths of each node of `log`.
///
/// # Errors
/// [`MapError::Missing`] if packets were received and none has a strength.
pub(crate) fn all_strengths(algorithm: &'static str, log: &ReceptionLog) -> Result<Vec<Vec<Strength>>, MapError> {
    let nodes: Vec<Vec<Strength>> =
        (0..log.node_count()).map(|node| strengths(log, NodeId::from_index(node))).collect();
    let is_heard = log.receptions().iter().any(|reception| reception.received > 0);
    if is_heard && nodes.iter().all(Vec::is_empty) {
        return Err(MapError::Missing {
            algorithm,
            what: "the signal strengths of receptions",
            remedy: "a log has them in the column `rssi_dbm`; `packet_centroid` and `link_model` map without",
        });
    }
    Ok(nodes)
}
