//! What nodes found that computed a map themselves, as figures show it.

use prost::Message as _;
use sextant_kernel::NodeId;

use crate::messages::MappedNodeMessage;

/// A node that took part in a map which the nodes computed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RecordedNode {
    /// The node.
    pub node: NodeId,
    /// Its part.
    pub role: NodeRole,
    /// The share of its neighbours that lie beyond the radius of communication; `None` without neighbours.
    pub scattering: Option<f64>,
}

/// The part of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NodeRole {
    /// It knew its place.
    InitialAnchor,
    /// It became an anchor.
    NewAnchor,
    /// It is no anchor.
    Node,
}

/// Reads the message of one node.
pub(super) fn mapped_node(data: &[u8]) -> Result<RecordedNode, String> {
    let message = MappedNodeMessage::decode(data).map_err(|why| why.to_string())?;
    let role = match message.role.as_str() {
        "initial_anchor" => NodeRole::InitialAnchor,
        "new_anchor" => NodeRole::NewAnchor,
        "node" => NodeRole::Node,
        other => return Err(format!("role `{other}`; allowed: initial_anchor, new_anchor, node")),
    };
    let MappedNodeMessage { node, neighbours, scattered, .. } = message;
    let scattering = (neighbours > 0).then(|| f64::from(scattered.min(neighbours)) / f64::from(neighbours));
    Ok(RecordedNode { node: NodeId(node), role, scattering })
}
