//! DR-MDS (Peng and Li 2014), reconstructed: scaling of distances that are straight over two hops.

use sextant_kernel::{SettingError, Watch};

use super::frame::FrameConfig;
use super::graph::Graph;
use super::hop_distance::NeighbourRanges;
use super::mds::classical_mds;
use super::mds_map::of_parts;
use super::smacof::{PairDistance, neighbour_ranges, refined};
use super::{Dimensions, check_link_share, default_link_share};
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::ranging::{Ranging, RangingConfig};
use crate::topology_map::TopologyMap;

/// DR-MDS as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct DrMdsConfig {
    /// How signal strengths between neighbours become distances.
    pub ranging: RangingConfig,
    /// What the map is aligned to.
    pub frame: FrameConfig,
    /// Number of rounds of SMACOF on the ranges between neighbours, after the scaling; 0 for none.
    pub rounds: u32,
    /// Least share of each other's packets that both nodes of a link must have received; above 0, at most 1.
    pub link_share: f64,
    /// Dimensions of the map, 2 or 3. If absent: 2 if all anchors have the same height, otherwise 3. Without anchors,
    /// the heights of the stops decide.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 2, max = 3)))]
    pub dimensions: Option<u8>,
}

impl Default for DrMdsConfig {
    fn default() -> Self {
        Self {
            ranging: RangingConfig::default(),
            frame: FrameConfig::default(),
            rounds: 0,
            link_share: default_link_share(),
            dimensions: None,
        }
    }
}

/// DR-MDS. Distances of neighbours follow from signal strengths, as in [`Smacof`](crate::Smacof). Those of two nodes
/// that share neighbours follow from hexahedra of these distances; farther nodes are joined by shortest ways. Classical
/// scaling makes a map of each connected part of the network. The paper was not available: this is a reconstruction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrMds {
    ranging: Ranging,
    frame: FrameConfig,
    rounds: u32,
    link_share: f64,
    dimensions: Dimensions,
}

/// Nodes that are not neighbours are farther apart than this share of the distances of neighbours.
const APART: f64 = 0.95;

impl TryFrom<DrMdsConfig> for DrMds {
    type Error = SettingError;

    fn try_from(config: DrMdsConfig) -> Result<Self, SettingError> {
        let DrMdsConfig { ranging, frame, rounds, link_share, dimensions } = config;
        check_link_share(link_share)?;
        let ranging = Ranging::try_from(ranging).map_err(|error| error.within("ranging"))?;
        Ok(Self { ranging, frame, rounds, link_share, dimensions: Dimensions::try_from(dimensions)? })
    }
}

impl Comparator for DrMds {
    const NAME: &'static str = "dr-mds";

    fn uses(&self) -> &'static [KnowledgeKind] {
        self.frame.uses_ranges()
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
        let log = knowledge.neighbours(Self::NAME)?;
        let dimensions = self.dimensions.of(knowledge);
        if self.frame == FrameConfig::Anchors {
            knowledge.anchors(Self::NAME, self.least_anchors(dimensions))?;
        }
        let graph = Graph::of(log, self.link_share);
        let map = |part: &[usize]| {
            let pairs = neighbour_ranges(&self.ranging, log, &graph, part);
            let edges = pairs.iter().map(|&PairDistance { a, b, distance_m }| (a, b, distance_m));
            let ranges = NeighbourRanges::new(part.len(), edges, usual_reach_m(&pairs), dimensions);
            let ways = ranges.shortest_ways(Self::NAME, watch)?;
            if ways.iter().any(|way_m| way_m.is_infinite()) {
                return Ok(None);
            }
            let places = classical_mds(ways, Self::NAME, dimensions, watch)?;
            if self.rounds == 0 {
                Ok(Some(places))
            } else {
                Ok(refined(&places, &pairs, self.rounds, dimensions, watch)?)
            }
        };
        let (places, part_of) = of_parts(&graph, Self::NAME, dimensions, map)?;
        self.frame.map(Self::NAME, places, part_of, knowledge, dimensions)
    }
}

/// The distance that most neighbours do not exceed (m). The largest one is often an error.
fn usual_reach_m(pairs: &[PairDistance]) -> f64 {
    let mut distances_m: Vec<f64> = pairs.iter().map(|pair| pair.distance_m).collect();
    distances_m.sort_unstable_by(f64::total_cmp);
    let last = distances_m.len().saturating_sub(1) as f64;
    distances_m.get(crate::numerics::whole(APART * last)).copied().unwrap_or(0.0)
}

impl EstimatorSettings for DrMdsConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        DrMds::try_from(self).map(Mapper::new)
    }

    fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        Some(&mut self.ranging)
    }
}
