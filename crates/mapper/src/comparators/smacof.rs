//! SMACOF (de Leeuw 1977): stress majorisation of ranges between neighbours.

use nalgebra::{DMatrix, Dyn, linalg::Cholesky};
use sextant_channel::{NeighbourLog, Position};
use sextant_kernel::maths::cholesky_watched;
use sextant_kernel::{Interrupted, NodeId, SettingError, Watch, Work};

use super::frame::FrameConfig;
use super::graph::Graph;
use super::mds_map::{of_parts, scaled};
use super::{Dimensions, check_link_share, default_link_share};
use crate::comparators::Comparator;
use crate::error::MapError;
use crate::estimator::{EstimatorSettings, Mapper};
use crate::knowledge::{Knowledge, KnowledgeKind};
use crate::ranging::{Ranging, RangingConfig};
use crate::topology_map::TopologyMap;

/// SMACOF as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SmacofConfig {
    /// How signal strengths between neighbours become distances.
    pub ranging: RangingConfig,
    /// What the map is aligned to.
    pub frame: FrameConfig,
    /// Maximum number of rounds, 1 or more.
    #[cfg_attr(feature = "schema", schemars(range(min = 1)))]
    pub rounds: u32,
    /// The rounds end when a round lowers the stress by less than this share; 0 or above.
    pub tolerance: f64,
    /// Least share of each other's packets that both nodes of a link must have received; above 0, at most 1.
    pub link_share: f64,
    /// Dimensions of the map, 2 or 3. If absent: 2 if all anchors have the same height, otherwise 3. Without anchors,
    /// the heights of the stops decide.
    #[cfg_attr(feature = "config", serde(skip_serializing_if = "Option::is_none"))]
    #[cfg_attr(feature = "schema", schemars(range(min = 2, max = 3)))]
    pub dimensions: Option<u8>,
}

impl Default for SmacofConfig {
    fn default() -> Self {
        Self {
            ranging: RangingConfig::default(),
            frame: FrameConfig::default(),
            rounds: 300,
            tolerance: 1e-6,
            link_share: default_link_share(),
            dimensions: None,
        }
    }
}

/// SMACOF. The distance of two neighbours follows from the mean strength of all packets that they received from each
/// other. Pairs that are not neighbours have no weight. The start is the map of MDS-MAP, scaled to the distances.
/// Each connected part of the network has a separate map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Smacof {
    ranging: Ranging,
    frame: FrameConfig,
    rounds: u32,
    tolerance: f64,
    link_share: f64,
    dimensions: Dimensions,
}

impl TryFrom<SmacofConfig> for Smacof {
    type Error = SettingError;

    fn try_from(config: SmacofConfig) -> Result<Self, SettingError> {
        let SmacofConfig { ranging, frame, rounds, tolerance, link_share, dimensions } = config;
        if rounds == 0 {
            return Err(SettingError::new("rounds", 0, "1 or more"));
        }
        check_link_share(link_share)?;
        Ok(Self {
            ranging: Ranging::try_from(ranging).map_err(|error| error.within("ranging"))?,
            frame,
            rounds,
            tolerance: SettingError::not_negative("tolerance", tolerance)?,
            link_share,
            dimensions: Dimensions::try_from(dimensions)?,
        })
    }
}

impl Comparator for Smacof {
    const NAME: &'static str = "smacof";

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
        let graph = Graph::of(log, self.link_share);
        let dimensions = self.dimensions.of(knowledge);
        let map = |part: &[usize]| {
            let dissimilarities = neighbour_ranges(&self.ranging, log, &graph, part);
            let mut places = matrix(&scaled(&graph, part, Self::NAME, dimensions, watch)?, dimensions);
            fit_scale(&mut places, &dissimilarities);
            let Some(places) = majorised(places, &dissimilarities, self.rounds, self.tolerance, watch)? else {
                return Ok(None);
            };
            Ok(Some(positions(&places)))
        };
        let (places, part_of) = of_parts(&graph, Self::NAME, dimensions, map)?;
        self.frame.map(Self::NAME, places, part_of, knowledge, dimensions)
    }
}

/// The pairs of neighbours in `part`, by place in it, with their distances.
pub(super) fn neighbour_ranges(
    ranging: &Ranging,
    log: &NeighbourLog,
    graph: &Graph,
    part: &[usize],
) -> Vec<PairDistance> {
    let mut pairs = Vec::new();
    for (a, &node) in part.iter().enumerate() {
        for &other in graph.neighbours(node).iter().filter(|&&other| other as usize > node) {
            let Ok(b) = part.binary_search(&(other as usize)) else { continue };
            let (from, to) = (NodeId::from_index(node), NodeId(other));
            let (mut sum_dbm, mut packets) = (0.0, 0.0);
            for link in [log.link(from, to), log.link(to, from)].into_iter().flatten() {
                if let Some(rssi_dbm) = link.rssi_dbm {
                    sum_dbm += f64::from(link.received) * rssi_dbm;
                    packets += f64::from(link.received);
                }
            }
            if packets > 0.0 {
                pairs.push(PairDistance { a, b, distance_m: ranging.distance_m(sum_dbm / packets) });
            }
        }
    }
    pairs
}

/// `places` after at most `rounds` rounds of majorisation; `None` if the pairs do not connect them.
pub(super) fn refined(
    places: &[Position],
    pairs: &[PairDistance],
    rounds: u32,
    dimensions: usize,
    watch: &dyn Watch,
) -> Result<Option<Vec<Position>>, Interrupted> {
    let places = majorised(matrix(places, dimensions), pairs, rounds, REFINED, watch)?;
    Ok(places.map(|places| positions(&places)))
}

/// A measured distance of two nodes. All pairs have the same weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairDistance {
    /// One node.
    pub a: usize,
    /// The other one.
    pub b: usize,
    /// Their distance (m).
    pub distance_m: f64,
}

/// A refinement ends when a round lowers the stress by less than this share.
const REFINED: f64 = 1e-9;

/// The places in the rows of a matrix; heights are 0 in the plane.
fn positions(places: &DMatrix<f64>) -> Vec<Position> {
    let z = |row: usize| if places.ncols() == 3 { places[(row, 2)] } else { 0.0 };
    (0..places.nrows()).map(|row| Position::new(places[(row, 0)], places[(row, 1)], z(row))).collect()
}

fn matrix(places: &[Position], dimensions: usize) -> DMatrix<f64> {
    DMatrix::from_fn(places.len(), dimensions, |row, column| <[f64; 3]>::from(places[row])[column])
}

fn apart(places: &DMatrix<f64>, pair: &PairDistance) -> f64 {
    (places.row(pair.a) - places.row(pair.b)).norm()
}

/// Scales `places` to minimise their stress.
fn fit_scale(places: &mut DMatrix<f64>, pairs: &[PairDistance]) {
    let (mut product, mut square) = (0.0, 0.0);
    for pair in pairs {
        let distance = apart(places, pair);
        product += distance * pair.distance_m;
        square += distance * distance;
    }
    if square > 0.0 {
        *places *= product / square;
    }
}

/// Raw stress: sum over the pairs of the squared difference of distances.
fn stress(places: &DMatrix<f64>, pairs: &[PairDistance]) -> f64 {
    pairs.iter().map(|pair| (apart(places, pair) - pair.distance_m).powi(2)).sum()
}

/// The matrix whose solutions are the Guttman transforms: `V + 1 1ᵀ/n`, V having −1 for each pair and its row sums
/// made zero by the diagonal. `None` if the pairs do not connect all nodes.
fn factored(
    nodes: usize,
    pairs: &[PairDistance],
    watch: &dyn Watch,
) -> Result<Option<Cholesky<f64, Dyn>>, Interrupted> {
    #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
    let mut v = DMatrix::from_element(nodes, nodes, 1.0 / nodes as f64);
    for &PairDistance { a, b, .. } in pairs {
        v[(a, b)] -= 1.0;
        v[(b, a)] -= 1.0;
        v[(a, a)] += 1.0;
        v[(b, b)] += 1.0;
    }
    // If the nodes are not connected, V + 1 1ᵀ/n is singular up to rounding.
    Ok(cholesky(v, watch)?.filter(|cholesky| cholesky.l_dirty().diagonal().min() > 1e-6))
}

/// The Cholesky factor of a symmetric matrix; `None` if it is not positive definite.
fn cholesky(mut matrix: DMatrix<f64>, watch: &dyn Watch) -> Result<Option<Cholesky<f64, Dyn>>, Interrupted> {
    let size = matrix.nrows();
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let operations = (size as f64).powi(3) / 6.0;
    watch.begin(Work { name: Smacof::NAME, unit: "column", steps: size as u64, operations });
    let is_definite = cholesky_watched(matrix.as_mut_slice(), size, watch)?;
    Ok(is_definite.then(|| Cholesky::pack_dirty(matrix)))
}

/// One step of majorisation, `X = V⁺ B(Z) Z`: the stress never rises.
fn transformed(
    places: &DMatrix<f64>,
    pairs: &[PairDistance],
    factor: &Cholesky<f64, Dyn>,
    watch: &dyn Watch,
) -> Result<DMatrix<f64>, Interrupted> {
    let mut product = DMatrix::zeros(places.nrows(), places.ncols());
    for pair in pairs {
        let apart = places.row(pair.a) - places.row(pair.b);
        let distance = apart.norm();
        if distance > 0.0 {
            let pull = apart * (pair.distance_m / distance);
            let mut a = product.row_mut(pair.a);
            a += &pull;
            let mut b = product.row_mut(pair.b);
            b -= &pull;
        }
    }
    for mut column in product.column_iter_mut() {
        watch.check()?;
        factor.solve_mut(&mut column);
    }
    Ok(product)
}

/// `places` after majorisation; `None` if the pairs do not connect them.
fn majorised(
    mut places: DMatrix<f64>,
    pairs: &[PairDistance],
    rounds: u32,
    tolerance: f64,
    watch: &dyn Watch,
) -> Result<Option<DMatrix<f64>>, Interrupted> {
    let Some(factor) = factored(places.nrows(), pairs, watch)? else { return Ok(None) };
    #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
    let operations = (places.nrows() * places.len()) as f64 * f64::from(rounds);
    watch.begin(Work { name: Smacof::NAME, unit: "round", steps: rounds.into(), operations });
    let mut before = stress(&places, pairs);
    for _ in 0..rounds {
        places = transformed(&places, pairs, &factor, watch)?;
        watch.advance(1);
        let after = stress(&places, pairs);
        if before - after <= tolerance * before {
            break;
        }
        before = after;
    }
    Ok(Some(places))
}

impl EstimatorSettings for SmacofConfig {
    fn mapper(self) -> Result<Mapper, SettingError> {
        Smacof::try_from(self).map(Mapper::new)
    }

    fn ranging_mut(&mut self) -> Option<&mut RangingConfig> {
        Some(&mut self.ranging)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed, Unwatched};

    fn random(rows: usize, seed: u64) -> DMatrix<f64> {
        DMatrix::from_fn(rows, 2, |i, j| 10.0 * Seed(seed).uniform(Purpose::new(8), [i as u64, j as u64, 11]))
    }

    fn pairs(places: &DMatrix<f64>, noise: f64) -> Vec<PairDistance> {
        let mut pairs = Vec::new();
        for a in 0..places.nrows() {
            for b in a + 1..places.nrows() {
                let distance = (places.row(a) - places.row(b)).norm();
                let factor = 1.0 + noise * Seed(4).normal(Purpose::new(8), [a as u64, b as u64, 12]);
                if distance < 5.0 {
                    pairs.push(PairDistance { a, b, distance_m: distance * factor.abs() });
                }
            }
        }
        pairs
    }

    #[test]
    fn the_stress_never_rises_from_any_start() {
        for seed in 0..20 {
            let pairs = pairs(&random(40, seed), 0.3);
            let factor = factored(40, &pairs, &Unwatched).unwrap().expect("a connected network");
            let mut places = random(40, seed + 100);
            let mut before = stress(&places, &pairs);
            for round in 0..60 {
                places = transformed(&places, &pairs, &factor, &Unwatched).unwrap();
                let after = stress(&places, &pairs);
                assert!(after <= before * (1.0 + 1e-12), "seed {seed}, round {round}: {before} to {after}");
                before = after;
            }
        }
    }

    #[test]
    fn exact_distances_are_a_fixed_point_without_stress() {
        let places = random(30, 3);
        let pairs = pairs(&places, 0.0);
        let factor = factored(30, &pairs, &Unwatched).unwrap().expect("a connected network");
        let next = transformed(&places, &pairs, &factor, &Unwatched).unwrap();
        assert!(stress(&places, &pairs) < 1e-20 && stress(&next, &pairs) < 1e-18);
        let mut shrunk = places.clone() * 0.1;
        fit_scale(&mut shrunk, &pairs);
        assert!((shrunk - places).amax() < 1e-9);
    }

    #[test]
    fn the_factor_is_the_library_s_to_the_last_bit() {
        let square = random(30, 7) * random(30, 8).transpose();
        let definite = &square * square.transpose() + DMatrix::identity(30, 30);
        let (found, expected) =
            (cholesky(definite.clone(), &Unwatched).unwrap().unwrap(), definite.clone().cholesky());
        assert_eq!(Some(found.l()), expected.map(|cholesky| cholesky.l()));
        assert!(cholesky(definite - DMatrix::identity(30, 30) * 2.0, &Unwatched).unwrap().is_none());
    }

    #[test]
    fn a_network_that_falls_apart_has_no_factor() {
        let apart = [PairDistance { a: 0, b: 1, distance_m: 1.0 }, PairDistance { a: 2, b: 3, distance_m: 1.0 }];
        assert!(factored(4, &apart, &Unwatched).unwrap().is_none());
    }
}
