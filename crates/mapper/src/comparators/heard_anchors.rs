//! The anchors that a node heard.

use sextant_channel::{NeighbourLog, Position};
use sextant_kernel::NodeId;

use crate::error::MapError;
use crate::knowledge::Knowledge;

/// An anchor that a node heard.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NamedAnchor {
    pub(super) node: NodeId,
    pub(super) position: Position,
    /// Packets received.
    pub(super) packets: u32,
    /// Their mean strength (dBm).
    pub(super) rssi_dbm: f64,
}

/// The anchors that each node heard.
pub(super) struct HeardAnchors<'a> {
    beacons: &'a NeighbourLog,
    places: Vec<Option<Position>>,
}

impl<'a> HeardAnchors<'a> {
    /// The anchors in `knowledge`, for an `algorithm` that needs at least `needed` of them.
    pub(super) fn new(knowledge: &Knowledge<'a>, algorithm: &'static str, needed: usize) -> Result<Self, MapError> {
        knowledge.anchors(algorithm, needed)?;
        Ok(Self { beacons: knowledge.beacons(algorithm)?, places: knowledge.known_places() })
    }

    /// The place of `node`, if it is an anchor.
    pub(super) fn own_place(&self, node: usize) -> Option<Position> {
        self.places[node]
    }

    /// Number of nodes.
    pub(super) fn node_count(&self) -> usize {
        self.places.len()
    }

    /// Anchors that a node heard, on average.
    #[expect(clippy::cast_precision_loss, reason = "numbers of nodes and links")]
    pub(super) fn mean_heard(&self) -> f64 {
        self.beacons.links().len() as f64 / self.node_count().max(1) as f64
    }

    /// The anchors that `node` heard with a known strength, strongest first; equal ones by their number.
    pub(super) fn of(&self, node: usize) -> Vec<NamedAnchor> {
        let links = self.beacons.heard_by(NodeId::from_index(node)).iter();
        let mut heard: Vec<NamedAnchor> = links
            .filter_map(|link| {
                let position = self.places[link.sender.index()]?;
                Some(NamedAnchor { node: link.sender, position, packets: link.received, rssi_dbm: link.rssi_dbm? })
            })
            .collect();
        heard.sort_by(|a, b| b.rssi_dbm.total_cmp(&a.rssi_dbm).then(a.node.cmp(&b.node)));
        heard
    }
}
