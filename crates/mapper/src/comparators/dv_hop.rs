//! DV-Hop (Niculescu and Nath 2003): hops to anchors times the mean length of a hop, then multilateration.

use sextant_channel::Anchor;
use sextant_kernel::{SettingError, Watch};

use super::graph::{Graph, UNREACHED};
use super::{check_link_share, default_link_share, node_by_node};
use crate::comparators::Comparator;
use crate::comparators::lateration::{Range, multilaterate};
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::numerics::memory::check_table;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// DV-Hop as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DvHopConfig {
    /// How an anchor computes the length of a hop.
    pub hop_length: HopLength,
    /// Least share of each other's packets that both nodes of a link must have received; above 0, at most 1.
    pub link_share: f64,
}

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

impl Default for DvHopConfig {
    fn default() -> Self {
        Self { hop_length: HopLength::default(), link_share: default_link_share() }
    }
}

/// DV-Hop. A node takes the length of a hop from the anchor with the fewest hops; of several such anchors, from the
/// one with the lowest number. A node is not placed if it reaches fewer anchors than the number of dimensions plus
/// one. Anchors keep their known places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DvHop {
    hop_length: HopLength,
    link_share: f64,
}

impl TryFrom<DvHopConfig> for DvHop {
    type Error = SettingError;

    fn try_from(config: DvHopConfig) -> Result<Self, SettingError> {
        check_link_share(config.link_share)?;
        Ok(Self { hop_length: config.hop_length, link_share: config.link_share })
    }
}

impl Comparator for DvHop {
    const NAME: &'static str = "dv-hop";

    fn uses(&self) -> &'static [KnowledgeKind] {
        &[KnowledgeKind::Neighbours, KnowledgeKind::Anchors]
    }

    fn least_anchors(&self, dimensions: usize) -> usize {
        dimensions + 1
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without a neighbour log; [`MapError::TooFewAnchors`] below three, in space four;
    /// [`MapError::TooMuchMemory`]; [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let dimensions = knowledge.dimensions();
        let anchors = knowledge.anchors(Self::NAME, dimensions + 1)?;
        let graph = Graph::of(knowledge.neighbours(Self::NAME)?, self.link_share);
        let nodes = graph.node_count();
        let what = || format!("the hops of {nodes} nodes to {} anchors", anchors.len());
        check_table(Self::NAME, what, [nodes, anchors.len()], 4)?;
        let from = anchors.iter().map(|anchor| anchor.node.index());
        let hops = graph.hops_from_each(from, Self::NAME, watch)?;
        let lengths_m: Vec<Option<f64>> = hops
            .iter()
            .zip(anchors)
            .map(|(hops, anchor)| hop_length_m(self.hop_length, anchor, hops, anchors))
            .collect();
        let known = knowledge.known_places();
        let place = |node: usize| {
            known[node].or_else(|| {
                let reached = || (0..anchors.len()).filter(|&anchor| hops[anchor][node] != UNREACHED);
                let nearest =
                    reached().filter(|&a| lengths_m[a].is_some()).min_by_key(|&anchor| hops[anchor][node])?;
                let length_m = lengths_m[nearest]?;
                let range = |a: usize| Range::new(anchors[a].position, length_m * f64::from(hops[a][node]));
                multilaterate(&reached().map(range).collect::<Vec<_>>(), dimensions).ok()
            })
        };
        // The refinement takes up to a hundred steps over all anchors.
        #[expect(clippy::cast_precision_loss, reason = "a number of anchors")]
        let operations = 100.0 * anchors.len() as f64;
        let places = node_by_node(Self::NAME, nodes, operations, watch, place)?;
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::World))
    }
}

/// Length of a hop as computed by `anchor`, from which `hops` are counted (m); `None` if it reaches no other anchor.
pub(super) fn hop_length_m(rule: HopLength, anchor: &Anchor, hops: &[u32], anchors: &[Anchor]) -> Option<f64> {
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

impl EstimatorSettings for DvHopConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        DvHop::try_from(self).map(Mapper::new)
    }
}
