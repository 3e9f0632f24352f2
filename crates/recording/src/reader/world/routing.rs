//! The tree over which packets went, as figures show it.

use prost::Message as _;
use sextant_kernel::NodeId;

use crate::messages::TreeEdgeMessage;

/// A node in the tree at the end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedEdge {
    /// The node.
    pub node: NodeId,
    /// Its parent among the stations, nodes first and then sinks; `None` without one.
    pub parent: Option<u32>,
    /// Hops to a sink along the parents; `None` without a way.
    pub depth: Option<u32>,
}

/// Reads the message of one node.
pub(super) fn edge(data: &[u8]) -> Result<RecordedEdge, String> {
    let message = TreeEdgeMessage::decode(data).map_err(|why| why.to_string())?;
    Ok(RecordedEdge { node: NodeId(message.node), parent: message.parent_station, depth: message.depth })
}
