//! The frames of maps of hops and ranges.

use sextant_channel::Position;
use sextant_kernel::NodeId;

use crate::error::MapError;
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// What a map without the frame of the world is aligned to, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum FrameConfig {
    /// The anchors, by the similarity that fits them best. Parts of the network that have fewer anchors than the
    /// number of dimensions plus two are not mapped.
    #[default]
    Anchors,
    /// Nothing. To measure its errors, the map is aligned to the true places of all nodes, which are known only in a
    /// simulation.
    Relative,
}

impl FrameConfig {
    /// The kinds of knowledge that a map of ranges between neighbours uses.
    pub(super) fn uses_ranges(self) -> &'static [KnowledgeKind] {
        match self {
            Self::Anchors => &[KnowledgeKind::NeighbourRssi, KnowledgeKind::Anchors, KnowledgeKind::PathLoss],
            Self::Relative => &[KnowledgeKind::NeighbourRssi, KnowledgeKind::PathLoss],
        }
    }

    /// Least number of anchors for a map.
    pub(super) fn least_anchors(self, dimensions: usize) -> usize {
        match self {
            Self::Anchors => dimensions + 2,
            Self::Relative => 0,
        }
    }

    /// The map of `places`, which are known up to a similarity in each part; `part_of` gives the part of each node.
    /// If the map is aligned to the anchors, these keep their known places.
    pub(super) fn map(
        self,
        algorithm: &'static str,
        places: Vec<Option<Position>>,
        part_of: Vec<u32>,
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
