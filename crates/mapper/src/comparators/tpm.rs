//! Topology-preserving maps from hop counts (Dhanapala and Jayasumana 2014): singular vectors of the nodes' hops to a
//! few of them.

use nalgebra::DMatrix;
use sextant_channel::Position;
use sextant_kernel::{Interrupted, Seed, SettingError, Watch};

use super::eigenpairs::{self, SPARE};
use super::graph::{Graph, UNREACHED};
use super::landmarks::{CountConfig, LandmarksConfig};
use super::{Dimensions, check_link_share, default_link_share};
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Landmarks, Mapper, Messages};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::numerics::memory::check_table;
use crate::purpose;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// The topology-preserving map as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TpmConfig {
    /// The nodes from which hops are counted.
    pub landmarks: LandmarksConfig,
    /// The hop counts from which the axes of the map are computed.
    pub axes: AxesConfig,
    /// Least share of each other's packets that both nodes of a link must have received; above 0, at most 1.
    #[cfg_attr(feature = "config", serde(default = "default_link_share"))]
    pub link_share: f64,
    /// Dimensions of the map, 2 or 3. If absent: 2 if all anchors have the same height, otherwise 3. Without anchors,
    /// the heights of the stops decide.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 2, max = 3)))]
    pub dimensions: Option<u8>,
}

/// The hop counts from which the axes of a map are computed, as written in a scenario.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum AxesConfig {
    /// Those of all nodes.
    #[default]
    AllNodes,
    /// Those between the nodes from which hops are counted: far fewer messages.
    Landmarks,
}

impl Default for TpmConfig {
    fn default() -> Self {
        Self {
            landmarks: LandmarksConfig::default(),
            axes: AxesConfig::default(),
            link_share: default_link_share(),
            dimensions: None,
        }
    }
}

/// The topology-preserving map.
///
/// `P` holds the hops of each node to each landmark. With the singular value decomposition `P = U S Vᵀ` (not
/// centred), the map is the second and third column of `P V`, in space the second to fourth; the first column is
/// about the mean distance to the landmarks, so it is not an axis. `V` comes from the small matrix `PᵀP`, or from the
/// hops between the landmarks alone. Columns of `V` have no sign; the entry of largest magnitude is made positive.
/// Each connected part of the network has a separate map, in hops, up to rotation, reflection and scale; parts with
/// fewer nodes than the number of dimensions plus two are not mapped. Nodes with the same hop counts share one place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tpm {
    landmarks: LandmarksConfig,
    axes: AxesConfig,
    link_share: f64,
    dimensions: Dimensions,
}

impl TryFrom<TpmConfig> for Tpm {
    type Error = SettingError;

    fn try_from(config: TpmConfig) -> Result<Self, SettingError> {
        let TpmConfig { landmarks, axes, link_share, dimensions } = config;
        landmarks.check().map_err(|error| error.within("landmarks"))?;
        check_link_share(link_share)?;
        Ok(Self { landmarks, axes, link_share, dimensions: Dimensions::try_from(dimensions)? })
    }
}

impl Comparator for Tpm {
    const NAME: &'static str = "tpm";

    fn uses(&self) -> &'static [KnowledgeKind] {
        // Never the places of anchors, even if hops are counted from them.
        &[KnowledgeKind::Neighbours]
    }

    fn least_anchors(&self, dimensions: usize) -> usize {
        if self.landmarks == (LandmarksConfig::Anchors {}) { dimensions + 2 } else { 0 }
    }

    fn messages(&self) -> Messages {
        Messages::Floods(match self.landmarks {
            LandmarksConfig::FarthestPoints(CountConfig { count })
            | LandmarksConfig::Random(CountConfig { count }) => Landmarks::Count(count),
            LandmarksConfig::Anchors {} => Landmarks::Anchors,
            LandmarksConfig::ExtremeNodeSearch(_) => Landmarks::Sought,
        })
    }

    /// The map.
    ///
    /// # Errors
    /// [`MapError::Missing`] without a neighbour log; [`MapError::TooFewAnchors`]; [`MapError::TooMuchMemory`];
    /// [`MapError::Interrupted`].
    fn map(&self, knowledge: &Knowledge<'_>, watch: &dyn Watch) -> Result<TopologyMap, MapError> {
        let graph = Graph::of(knowledge.neighbours(Self::NAME)?, self.link_share);
        let dimensions = self.dimensions.of(knowledge);
        let anchors = knowledge.anchors(Self::NAME, self.least_anchors(dimensions))?;
        let anchors: Vec<usize> = anchors.iter().map(|anchor| anchor.node.index()).collect();
        let mut places = vec![None; graph.node_count()];
        let mut part_of = vec![0; graph.node_count()];
        for (index, part) in (0..).zip(graph.parts()) {
            for &node in &part {
                part_of[node] = index;
            }
            let least = dimensions + 2;
            let landmarks = self.landmarks.choose(&graph, &part, knowledge.seed, least, &anchors, watch)?;
            if part.len() < least || landmarks.len() < least {
                continue;
            }
            for (&node, place) in part.iter().zip(self.part(&graph, &part, &landmarks, dimensions, watch)?) {
                places[node] = Some(place);
            }
        }
        Ok(TopologyMap::of_places(Self::NAME, places, CoordinateFrame::Relative(part_of)))
    }
}

impl Tpm {
    /// The places of one connected part.
    fn part(
        &self,
        graph: &Graph,
        part: &[usize],
        landmarks: &[usize],
        dimensions: usize,
        watch: &dyn Watch,
    ) -> Result<Vec<Position>, MapError> {
        let what = || format!("the hops of {} nodes to {} others", part.len(), landmarks.len());
        check_table(Self::NAME, what, [graph.node_count(), landmarks.len()], 24)?;
        let hops = graph.hops_from_each(landmarks.iter().copied(), Self::NAME, watch)?;
        assert!(part.iter().all(|&node| hops.iter().all(|hops| hops[node] != UNREACHED)));
        let matrix = |nodes: &[usize]| {
            DMatrix::from_fn(nodes.len(), landmarks.len(), |row, column| f64::from(hops[column][nodes[row]]))
        };
        let p = matrix(part);
        let v = match self.axes {
            AxesConfig::AllNodes => right_singular_vectors(&p, dimensions + 1, watch)?,
            AxesConfig::Landmarks => right_singular_vectors(&matrix(landmarks), dimensions + 1, watch)?,
        };
        let axes = v.columns(1, dimensions);
        let map = p * axes;
        let place = |row: usize| {
            Position::new(map[(row, 0)], map[(row, 1)], if dimensions == 3 { map[(row, 2)] } else { 0.0 })
        };
        Ok((0..part.len()).map(place).collect())
    }
}

/// Up to this number of landmarks, all singular values are computed.
const SMALL: usize = 256;

/// The first `count` right singular vectors of `p` by falling singular value, from the eigenvectors of `pᵀp`; in each
/// column the entry of largest magnitude, the first of several, is positive.
fn right_singular_vectors(p: &DMatrix<f64>, count: usize, watch: &dyn Watch) -> Result<DMatrix<f64>, Interrupted> {
    let (_, mut v) = if p.ncols() <= SMALL {
        eigenpairs::sorted(&eigenpairs::transposed_product(p, p, watch)?, count)
    } else {
        let start = |row: usize, column: usize| Seed(0).normal(purpose::MAPPER, [3, row as u64, column as u64]);
        eigenpairs::iterated(DMatrix::from_fn(p.ncols(), count + SPARE, start), count, |basis| {
            eigenpairs::transposed_product(p, &eigenpairs::product(p, basis, watch)?, watch)
        })?
    };
    for mut column in v.column_iter_mut() {
        let mut largest: f64 = 0.0;
        for &entry in column.iter() {
            // Entries that differ only by rounding count as equal, so that rounding does not decide the sign.
            if entry.abs() > largest.abs() * (1.0 + 1e-9) {
                largest = entry;
            }
        }
        if largest < 0.0 {
            column.neg_mut();
        }
    }
    Ok(v)
}

impl EstimatorSettings for TpmConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        Tpm::try_from(self).map(Mapper::new)
    }
}

#[cfg(test)]
mod tests {
    use sextant_kernel::{Purpose, Unwatched};

    use super::*;

    #[test]
    fn singular_vectors_of_many_landmarks_are_those_of_the_decomposition_itself() {
        // Hops on a line, to 300 of its nodes, a few of them off by one.
        let off =
            |i: usize, j: usize| f64::from(u8::from(Seed(3).uniform(Purpose::new(8), [i as u64, j as u64, 1]) < 0.1));
        #[expect(clippy::cast_precision_loss, reason = "small numbers")]
        let p = DMatrix::from_fn(400, 300, |i, j| i.abs_diff(j) as f64 + off(i, j));
        let v = right_singular_vectors(&p, 3, &Unwatched).unwrap();
        let reference = p.clone().svd(false, true).v_t.unwrap().transpose();
        for (column, reference) in v.column_iter().zip(reference.column_iter()) {
            assert!((column.dot(&reference).abs() - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn singular_vectors_are_those_of_the_decomposition_itself() {
        let p = DMatrix::from_fn(9, 4, |i, j| f64::from(u32::try_from((i * i + 3 * j * i + 2 * j) % 11).unwrap()));
        let v = right_singular_vectors(&p, 4, &Unwatched).unwrap();
        let reference = p.clone().svd(false, true).v_t.unwrap().transpose();
        for (column, reference) in v.column_iter().zip(reference.column_iter()) {
            assert!((column.dot(&reference).abs() - 1.0).abs() < 1e-9);
            let largest = column.iter().copied().fold(0.0, |a: f64, b: f64| if b.abs() > a.abs() { b } else { a });
            assert!(largest > 0.0);
        }
    }
}
