//! What maps of hops and ranges are relative to.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use sextant_channel::Position;
use sextant_kernel::NodeId;

use crate::{CoordinateFrame, Knowledge, MapError, TopologyMap};

/// What a map without a frame of its own is brought to, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum FrameConfig {
    /// The anchors, by the similarity that fits them best; parts of the network with fewer anchors than dimensions plus
    /// two are not mapped.
    #[default]
    Anchors,
    /// Nothing. To be measured it is brought to the true places of all nodes, which nobody knows outside a simulation.
    Relative,
}

impl FrameConfig {
    /// Anchors without which there is no map.
    pub(super) fn least_anchors(self, dimensions: usize) -> usize {
        match self {
            Self::Anchors => dimensions + 2,
            Self::Relative => 0,
        }
    }

    /// The map of `places`, known up to a similarity in each of the parts `part_of` that nodes belong to. Brought to the
    /// anchors, these are where they are.
    pub(super) fn map(
        self,
        algorithm: &'static str,
        (places, part_of): (Vec<Option<Position>>, Vec<u32>),
        knowledge: &Knowledge<'_>,
        dimensions: usize,
    ) -> Result<TopologyMap, MapError> {
        let map = TopologyMap::of_places(algorithm, places, CoordinateFrame::Relative(part_of));
        if self == Self::Relative {
            return Ok(map);
        }
        let least = self.least_anchors(dimensions);
        let anchors = knowledge.anchors(algorithm, least)?;
        let known: Vec<(NodeId, Position)> = anchors.iter().map(|anchor| (anchor.node, anchor.position)).collect();
        let mut places = map.aligned_to(&known, least).positions();
        for anchor in anchors {
            places[anchor.node.index()] = Some(anchor.position);
        }
        Ok(TopologyMap::of_places(algorithm, places, CoordinateFrame::AlignedToAnchors))
    }
}
