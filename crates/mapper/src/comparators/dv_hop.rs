//! DV-Hop (Niculescu and Nath 2003): hops to anchors times the mean length of a hop, then multilateration.

use sextant_kernel::{SettingError, Watch};

use super::anchor_hops::{AnchorHops, HopLength};
use super::graph::UNREACHED;
use super::{check_link_share, default_link_share};
use crate::comparators::Comparator;
use crate::comparators::lateration::{Range, multilaterate};
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::topology_map::TopologyMap;

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
        let field = AnchorHops::of(Self::NAME, knowledge, self.link_share, self.hop_length, watch)?;
        let AnchorHops { anchors, hops, lengths_m, dimensions, .. } = &field;
        let place = |node: usize| {
            let reached = || (0..anchors.len()).filter(|&anchor| hops[anchor][node] != UNREACHED);
            let nearest = reached().filter(|&a| lengths_m[a].is_some()).min_by_key(|&anchor| hops[anchor][node])?;
            let length_m = lengths_m[nearest]?;
            let range = |a: usize| Range::new(anchors[a].position, length_m * f64::from(hops[a][node]));
            multilaterate(&reached().map(range).collect::<Vec<_>>(), *dimensions).ok()
        };
        // The refinement takes up to a hundred steps over all anchors.
        #[expect(clippy::cast_precision_loss, reason = "a number of anchors")]
        let operations = 100.0 * anchors.len() as f64;
        field.map(Self::NAME, knowledge, operations, watch, place)
    }
}

impl EstimatorSettings for DvHopConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        DvHop::try_from(self).map(Mapper::new)
    }
}
