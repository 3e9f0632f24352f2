//! Reads from a recording what the nodes know of each other.

use std::path::Path;

use prost::Message as _;
use sextant_channel::{Anchor, Link, NeighbourLog, Position};
use sextant_kernel::NodeId;

use super::run::sound;
use crate::error::RecordingError;
use crate::mcap_file::Piece;
use crate::messages;
use crate::messages::names::{ANCHORS_TOPIC, BEACONS_TOPIC, LINKS_KEY, NEIGHBOURS_TOPIC};

/// What the nodes know of each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MutualKnowledge {
    /// Receptions of hello packets between nodes, if they listened to each other.
    pub neighbours: Option<NeighbourLog>,
    /// Receptions of the anchors' packets, if they listened to them.
    pub beacons: Option<NeighbourLog>,
    /// The nodes that know their position, by node.
    pub anchors: Vec<Anchor>,
}

/// Reads what the nodes of the recording `path` know of each other; `nodes` is their number.
///
/// # Errors
/// If the file cannot be read, is damaged, or refers to nodes that do not exist.
pub fn read_known(path: &Path, nodes: usize) -> Result<MutualKnowledge, RecordingError> {
    let (mut neighbours, mut beacons) = (None, None);
    let mut known = MutualKnowledge::default();
    sound(path, &mut |piece| {
        let (channel, data) = match piece {
            Piece::Message { channel, data, .. } => (channel, data),
            Piece::Metadata(record) if record.metadata.contains_key(LINKS_KEY) => {
                match record.name.as_str() {
                    NEIGHBOURS_TOPIC => neighbours = Some(Vec::new()),
                    BEACONS_TOPIC => beacons = Some(Vec::new()),
                    _ => {}
                }
                return Ok(());
            }
            _ => return Ok(()),
        };
        let wrong = |problem: String| RecordingError::message(path, &channel.topic, problem);
        match channel.topic.as_str() {
            NEIGHBOURS_TOPIC => neighbours.get_or_insert_default().push(link(data).map_err(wrong)?),
            BEACONS_TOPIC => beacons.get_or_insert_default().push(link(data).map_err(wrong)?),
            ANCHORS_TOPIC => known.anchors.push(anchor(data, nodes).map_err(wrong)?),
            _ => {}
        }
        Ok(())
    })?;
    known.neighbours = log(path, NEIGHBOURS_TOPIC, nodes, neighbours)?;
    known.beacons = log(path, BEACONS_TOPIC, nodes, beacons)?;
    known.anchors.sort_by_key(|anchor| anchor.node);
    if let Some(pair) = known.anchors.windows(2).find(|pair| pair[0].node == pair[1].node) {
        let problem = format!("node {} is an anchor twice", pair[0].node.0);
        return Err(RecordingError::message(path, ANCHORS_TOPIC, problem));
    }
    Ok(known)
}

fn log(
    path: &Path,
    topic: &str,
    nodes: usize,
    links: Option<Vec<Link>>,
) -> Result<Option<NeighbourLog>, RecordingError> {
    let log = links.map(|links| NeighbourLog::new(nodes, links)).transpose();
    log.map_err(|error| RecordingError::message(path, topic, error.to_string()))
}

fn link(data: &[u8]) -> Result<Link, String> {
    let messages::LinkMessage { listener, sender, received, sent, rssi_dbm } =
        messages::LinkMessage::decode(data).map_err(|why| why.to_string())?;
    Ok(Link { listener: NodeId(listener), sender: NodeId(sender), received, sent, rssi_dbm })
}

pub(crate) fn anchor(data: &[u8], nodes: usize) -> Result<Anchor, String> {
    let messages::AnchorMessage { node, x_m, y_m, z_m } =
        messages::AnchorMessage::decode(data).map_err(|why| why.to_string())?;
    let position = Position::new(x_m, y_m, z_m);
    if node as usize >= nodes {
        return Err(format!("an anchor is node {node}, but there are {nodes} nodes"));
    }
    if !position.is_finite() {
        return Err(format!("anchor {node} is at {position}; allowed: finite coordinates"));
    }
    Ok(Anchor { node: NodeId(node), position })
}
