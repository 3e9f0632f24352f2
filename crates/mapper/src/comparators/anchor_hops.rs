//! Hops of nodes to anchors, and how long they are.

use sextant_channel::{Anchor, Position};
use sextant_kernel::Watch;

use super::graph::{Graph, UNREACHED};
use super::node_by_node;
use crate::error::MapError;
use crate::knowledge::Knowledge;
use crate::numerics::memory::check_table;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// How an anchor computes the length of a hop from its distances and hops to the other anchors.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum HopLength {
    /// Sum of the distances divided by the sum of the hops.
    #[default]
    Mean,
    /// Least squares: the sum of distance times hops, divided by the sum of squared hops.
    LeastSquares,
}

/// The hops of nodes to anchors.
pub(super) struct AnchorHops<'a> {
    nodes: usize,
    pub(super) anchors: &'a [Anchor],
    /// Hops of all nodes from each anchor.
    pub(super) hops: Vec<Vec<u32>>,
    /// Length of a hop by each anchor (m).
    pub(super) lengths_m: Vec<Option<f64>>,
    pub(super) dimensions: usize,
}

impl<'a> AnchorHops<'a> {
    /// What an algorithm knows of them, with links of at least this share.
    pub(super) fn of(
        name: &'static str,
        knowledge: &Knowledge<'a>,
        link_share: f64,
        rule: HopLength,
        watch: &dyn Watch,
    ) -> Result<Self, MapError> {
        let dimensions = knowledge.dimensions();
        let anchors = knowledge.anchors(name, dimensions + 1)?;
        let graph = Graph::of(knowledge.neighbours(name)?, link_share);
        let nodes = graph.node_count();
        let what = || format!("the hops of {nodes} nodes to {} anchors", anchors.len());
        check_table(name, what, [nodes, anchors.len()], 4)?;
        let hops = graph.hops_from_each(anchors.iter().map(|anchor| anchor.node.index()), name, watch)?;
        let lengths_m =
            hops.iter().zip(anchors).map(|(hops, anchor)| hop_length_m(rule, anchor, hops, anchors)).collect();
        Ok(Self { nodes, anchors, hops, lengths_m, dimensions })
    }

    /// The map in which anchors keep their known places, and each other node is where `place` says. That takes so many `operations`.
    pub(super) fn map(
        &self,
        name: &'static str,
        knowledge: &Knowledge<'_>,
        operations: f64,
        watch: &dyn Watch,
        place: impl Fn(usize) -> Option<Position>,
    ) -> Result<TopologyMap, MapError> {
        let known = knowledge.known_places();
        let place = |node: usize| known[node].or_else(|| place(node));
        let places = node_by_node(name, self.nodes, operations, watch, place)?;
        Ok(TopologyMap::of_places(name, places, CoordinateFrame::World))
    }
}

/// Length of a hop as computed by `anchor`, from which `hops` are counted (m); `None` if it reaches no other anchor.
fn hop_length_m(rule: HopLength, anchor: &Anchor, hops: &[u32], anchors: &[Anchor]) -> Option<f64> {
    let (mut above, mut below) = (0.0, 0.0);
    for other in anchors.iter().filter(|other| other.node != anchor.node) {
        let count = hops[other.node.index()];
        if count == UNREACHED {
            continue;
        }
        let (distance_m, count) = (anchor.position.distance_m(other.position), f64::from(count));
        let weight = match rule {
            HopLength::Mean => 1.0,
            HopLength::LeastSquares => count,
        };
        above += weight * distance_m;
        below += weight * count;
    }
    (below > 0.0).then(|| above / below)
}
