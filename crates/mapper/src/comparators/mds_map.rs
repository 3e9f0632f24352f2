//! MDS-MAP (Shang et al. 2003): classical scaling of hop counts between all pairs of nodes.

use nalgebra::DMatrix;
use sextant_channel::Position;
use sextant_kernel::{SettingError, Watch, Work};

use super::frame::FrameConfig;
use super::graph::Graph;
use super::mds::classical_mds;
use super::{Dimensions, check_link_share, default_link_share};
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::numerics::memory::check_table;
use crate::topology_map::TopologyMap;

/// MDS-MAP as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MdsMapConfig {
    /// What the map is aligned to.
    pub frame: FrameConfig,
    /// Least share of each other's packets that both nodes of a link must have received; above 0, at most 1.
    pub link_share: f64,
    /// Dimensions of the map, 2 or 3. If absent: 2 if all anchors have the same height, otherwise 3. Without anchors,
    /// the heights of the stops decide.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 2, max = 3)))]
    pub dimensions: Option<u8>,
}

impl Default for MdsMapConfig {
    fn default() -> Self {
        Self { frame: FrameConfig::default(), link_share: default_link_share(), dimensions: None }
    }
}

/// MDS-MAP. Each connected part of the network has a separate map. Parts with fewer nodes than the number of
/// dimensions plus two are not mapped. Needs memory for the hops between all pairs of the nodes of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MdsMap {
    frame: FrameConfig,
    link_share: f64,
    dimensions: Dimensions,
}

impl TryFrom<MdsMapConfig> for MdsMap {
    type Error = SettingError;

    fn try_from(config: MdsMapConfig) -> Result<Self, SettingError> {
        let MdsMapConfig { frame, link_share, dimensions } = config;
        check_link_share(link_share)?;
        Ok(Self { frame, link_share, dimensions: Dimensions::try_from(dimensions)? })
    }
}

impl Comparator for MdsMap {
    const NAME: &'static str = "mds-map";

    fn uses(&self) -> &'static [KnowledgeKind] {
        match self.frame {
            FrameConfig::Anchors => &[KnowledgeKind::Neighbours, KnowledgeKind::Anchors],
            FrameConfig::Relative => &[KnowledgeKind::Neighbours],
        }
    }

    fn least_anchors(&self, dimensions: usize) -> usize {
        self.frame.least_anchors(dimensions)
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without a neighbour log; [`MapError::TooFewAnchors`]; [`MapError::TooMuchMemory`];
    /// [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let graph = Graph::of(knowledge.neighbours(Self::NAME)?, self.link_share);
        let dimensions = self.dimensions.of(knowledge);
        let (places, part_of) = of_parts(&graph, Self::NAME, dimensions, |part| {
            scaled(&graph, part, Self::NAME, dimensions, watch).map(Some)
        })?;
        self.frame.map(Self::NAME, places, part_of, knowledge, dimensions)
    }
}

/// Places of the nodes of each part, and the part of each node.
type Parts = (Vec<Option<Position>>, Vec<u32>);

/// Calls `map` for each connected part that is large enough, and collects the places of its nodes.
pub(super) fn of_parts(
    graph: &Graph,
    algorithm: &'static str,
    dimensions: usize,
    map: impl Fn(&[usize]) -> Result<Option<Vec<Position>>, MapError>,
) -> Result<Parts, MapError> {
    let mut places = vec![None; graph.node_count()];
    let mut part_of = vec![0; graph.node_count()];
    for (index, part) in (0..).zip(graph.parts()) {
        let what = || format!("the hops between all pairs of {} nodes", part.len());
        check_table(algorithm, what, [part.len(); 2], 8)?;
        let mapped = if part.len() < dimensions + 2 { None } else { map(&part)? };
        for (i, &node) in part.iter().enumerate() {
            part_of[node] = index;
            places[node] = mapped.as_ref().map(|places| places[i]);
        }
    }
    Ok((places, part_of))
}

/// The nodes of `part` scaled by their hops, in units of hops. `algorithm` is the name for progress messages.
pub(super) fn scaled(
    graph: &Graph,
    part: &[usize],
    algorithm: &'static str,
    dimensions: usize,
    watch: &dyn Watch,
) -> Result<Vec<Position>, MapError> {
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let pairs = part.len() as f64 * part.len() as f64;
    watch.begin(Work { name: algorithm, unit: "source of hops", steps: part.len() as u64, operations: pairs });
    let mut hops = DMatrix::zeros(part.len(), part.len());
    for (column, &node) in part.iter().enumerate() {
        watch.check()?;
        watch.advance(1);
        let from_node = graph.hops_from(node);
        for (row, &other) in part.iter().enumerate() {
            hops[(row, column)] = f64::from(from_node[other]);
        }
    }
    Ok(classical_mds(hops, algorithm, dimensions, watch)?)
}

impl EstimatorSettings for MdsMapConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        MdsMap::try_from(self).map(Mapper::new)
    }
}
