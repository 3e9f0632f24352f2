//! Places of nodes from measured distances between them, without a log: for tables that a user has.

mod cooperative;

use nalgebra::DMatrix;
use sextant_channel::Position;
use sextant_kernel::{Interrupted, NodeId, Watch};

use self::cooperative::Cooperative;
use super::mds::classical_mds;
pub use super::smacof::PairDistance;
use super::smacof::refined;
use crate::error::MapError;
use crate::numerics::memory::check_table;
use crate::topology_map::{CoordinateFrame, TopologyMap};

/// How places follow from distances.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LocaliseMethod {
    /// The places whose distances fit best, all together, with the anchors where they are; the start is that of `Smacof`.
    LeastSquares,
    /// Stress majorisation (de Leeuw 1977) of the distances, aligned to the anchors.
    Smacof,
    /// Classical scaling (Torgerson 1952) of the lengths of the shortest ways, aligned to the anchors: MDS-MAP with distances
    /// (Shang et al. 2003). The anchors tell the scale, so that distances may be numbers of hops.
    Mds,
}

/// What is known for [`localise`].
#[derive(Clone, Debug, PartialEq)]
pub struct DistanceProblem {
    /// Number of nodes.
    pub nodes: usize,
    /// Distances of pairs; a pair that was measured twice counts twice.
    pub pairs: Vec<PairDistance>,
    /// Nodes whose places are known (m).
    pub anchors: Vec<(usize, Position)>,
    /// 2 or 3. In the plane heights are 0, those of anchors too.
    pub dimensions: usize,
}

/// Places from distances.
#[derive(Clone, Debug, PartialEq)]
pub struct Localised {
    /// The place of each node (m); `None` if the distances do not fix it: a part of the network with too few nodes, or with too few
    /// anchors if there are any.
    pub places: Vec<Option<Position>>,
    /// Their covariances (m²), by least squares with anchors.
    pub covariances: Vec<Option<[[f64; 3]; 3]>>,
    /// Whether the places are in the frame of the anchors. Without anchors, each part of the network is in a frame of its own, known up
    /// to turns, shifts and a mirror image.
    pub in_world: bool,
    /// Number of the connected part of the network that each node is in.
    pub part_of: Vec<u32>,
    /// Root of the mean squared difference between measured distances and those of the places (m); `None` without any.
    pub residual_m: Option<f64>,
}

/// Why places cannot be computed from distances.
#[derive(Debug, thiserror::Error)]
pub enum LocaliseError {
    /// A number of a node is too high.
    #[error("node {found}; allowed: 0 to {} for {nodes} nodes", .nodes.saturating_sub(1))]
    Node {
        /// The number.
        found: usize,
        /// The number of nodes.
        nodes: usize,
    },
    /// A distance that is none.
    #[error("the distance of nodes {a} and {b} is {distance_m} m; allowed: a number above 0, of two different nodes")]
    Distance {
        /// One node.
        a: usize,
        /// The other one.
        b: usize,
        /// The distance (m).
        distance_m: f64,
    },
    /// The place of an anchor is not finite, or is given twice.
    #[error("anchor {0}: its place is to be given once, by finite numbers")]
    Anchor(usize),
    /// Too few anchors for the frame.
    #[error("{found} anchors; allowed: none, or at least {least} for a place in {dimensions} dimensions")]
    TooFewAnchors {
        /// Anchors found.
        found: usize,
        /// Anchors needed.
        least: usize,
        /// Dimensions of the space.
        dimensions: usize,
    },
    /// Dimensions of no space.
    #[error("{0} dimensions; allowed: 2 or 3")]
    Dimensions(usize),
    /// The table of distances is too large, or the work was ended.
    #[error(transparent)]
    Map(#[from] MapError),
}

impl From<Interrupted> for LocaliseError {
    fn from(interrupted: Interrupted) -> Self {
        Self::Map(interrupted.into())
    }
}

/// The name for progress messages.
const NAME: &str = "localise";
/// Most rounds of majorisation.
const ROUNDS: u32 = 1000;

/// Computes places from distances.
///
/// Each connected part of the network that has enough anchors is placed, or each part if there are no anchors.
///
/// # Errors
/// If a number is not allowed, there are too few anchors, the nodes are too many for the memory, or `watch` ends the work.
pub fn localise(
    problem: &DistanceProblem,
    method: LocaliseMethod,
    watch: &dyn Watch,
) -> Result<Localised, LocaliseError> {
    problem.check()?;
    let DistanceProblem { nodes, dimensions, .. } = *problem;
    check_table(NAME, || format!("the distances between all pairs of {nodes} nodes"), [nodes; 2], 16)?;
    let anchors = problem.anchors_in_dimensions();
    let pairs = &problem.pairs;
    let mut known = pairs.clone();
    // Scaling alone knows no unit: its distances may be hops.
    if method != LocaliseMethod::Mds {
        for (number, &(a, place)) in anchors.iter().enumerate() {
            let others = anchors[number + 1..].iter();
            known.extend(others.map(|&(b, other)| PairDistance { a, b, distance_m: place.distance_m(other) }));
        }
    }
    let ways = shortest_ways(nodes, &known, watch)?;
    let part_of = parts(&ways);
    let mut places = vec![None; nodes];
    for part in 0..part_of.iter().max().map_or(0, |&last| last + 1) {
        let of_part: Vec<usize> = (0..nodes).filter(|&node| part_of[node] == part).collect();
        if of_part.len() < dimensions + 1 {
            continue;
        }
        let within = DMatrix::from_fn(of_part.len(), of_part.len(), |a, b| ways[(of_part[a], of_part[b])]);
        let mut found = classical_mds(within, NAME, dimensions, watch)?;
        if method != LocaliseMethod::Mds {
            let position = |node: usize| of_part.binary_search(&node).ok();
            let pairs: Vec<PairDistance> = known
                .iter()
                .filter_map(|pair| Some(PairDistance { a: position(pair.a)?, b: position(pair.b)?, ..*pair }))
                .collect();
            if let Some(better) = refined(&found, &pairs, ROUNDS, dimensions, watch)? {
                found = better;
            }
        }
        of_part.iter().zip(found).for_each(|(&node, place)| places[node] = Some(place));
    }
    if !anchors.is_empty() {
        let map = TopologyMap::of_places(NAME, places, CoordinateFrame::Relative(part_of.clone()));
        let anchors: Vec<(NodeId, Position)> =
            anchors.iter().map(|&(node, place)| (NodeId::from_index(node), place)).collect();
        places = map.aligned_to(&anchors, dimensions + 1).positions();
        anchors.iter().for_each(|&(node, place)| places[node.index()] = Some(place));
    }
    let mut covariances = vec![None; nodes];
    if method == LocaliseMethod::LeastSquares {
        let cooperative = Cooperative::new(pairs, &anchors, &places, dimensions);
        cooperative.fit(&mut places, &mut covariances, watch)?;
    }
    let residual_m = residual_m(pairs, &places);
    Ok(Localised { places, covariances, in_world: !anchors.is_empty(), part_of, residual_m })
}

impl DistanceProblem {
    fn check(&self) -> Result<(), LocaliseError> {
        let Self { nodes, dimensions, .. } = *self;
        if !matches!(dimensions, 2 | 3) {
            return Err(LocaliseError::Dimensions(dimensions));
        }
        let check = |found: usize| if found < nodes { Ok(()) } else { Err(LocaliseError::Node { found, nodes }) };
        for &PairDistance { a, b, distance_m } in &self.pairs {
            check(a)?;
            check(b)?;
            if a == b || !distance_m.is_finite() || distance_m <= 0.0 {
                return Err(LocaliseError::Distance { a, b, distance_m });
            }
        }
        for (number, &(node, place)) in self.anchors.iter().enumerate() {
            check(node)?;
            if !place.is_finite() || self.anchors[..number].iter().any(|&(other, _)| other == node) {
                return Err(LocaliseError::Anchor(node));
            }
        }
        let (found, least) = (self.anchors.len(), dimensions + 1);
        if found > 0 && found < least {
            return Err(LocaliseError::TooFewAnchors { found, least, dimensions });
        }
        Ok(())
    }

    /// The anchors; in the plane at a height of 0.
    fn anchors_in_dimensions(&self) -> Vec<(usize, Position)> {
        let z = |place: Position| if self.dimensions == 3 { place.z_m } else { 0.0 };
        self.anchors.iter().map(|&(node, place)| (node, Position::new(place.x_m, place.y_m, z(place)))).collect()
    }
}

/// The lengths (m) of the shortest ways between all nodes, infinite where there is none (Floyd 1962).
fn shortest_ways(nodes: usize, pairs: &[PairDistance], watch: &dyn Watch) -> Result<DMatrix<f64>, Interrupted> {
    let mut ways = DMatrix::from_element(nodes, nodes, f64::INFINITY);
    ways.fill_diagonal(0.0);
    for &PairDistance { a, b, distance_m } in pairs {
        let shorter = distance_m.min(ways[(a, b)]);
        (ways[(a, b)], ways[(b, a)]) = (shorter, shorter);
    }
    if 2 * pairs.len() >= nodes * nodes.saturating_sub(1) && ways.iter().all(|way| way.is_finite()) {
        // Measured distances are kept, even where two others are shorter together.
        return Ok(ways);
    }
    let mut over = vec![0.0; nodes];
    for middle in 0..nodes {
        watch.check()?;
        over.copy_from_slice(ways.column(middle).as_slice());
        for mut column in ways.column_iter_mut() {
            let first = column[middle];
            if first.is_finite() {
                column.iter_mut().zip(&over).for_each(|(own, second)| *own = own.min(first + second));
            }
        }
    }
    Ok(ways)
}

/// The number of the connected part of each node.
fn parts(ways: &DMatrix<f64>) -> Vec<u32> {
    let mut part_of = vec![u32::MAX; ways.nrows()];
    let mut next = 0;
    for node in 0..ways.nrows() {
        if part_of[node] == u32::MAX {
            let reached = ways.column(node);
            part_of.iter_mut().zip(reached.iter()).filter(|(_, way)| way.is_finite()).for_each(|(of, _)| *of = next);
            next += 1;
        }
    }
    part_of
}

fn residual_m(pairs: &[PairDistance], places: &[Option<Position>]) -> Option<f64> {
    let both = pairs.iter().filter_map(|pair| Some((places[pair.a]?.distance_m(places[pair.b]?), pair.distance_m)));
    let squares: Vec<f64> = both.map(|(found_m, measured_m)| (found_m - measured_m).powi(2)).collect();
    (!squares.is_empty()).then(|| (squares.iter().sum::<f64>() / squares.len() as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed, Unwatched};

    /// Nodes at random in 30 m, and the distances of those that are nearer than `reach_m`, with noise.
    fn problem(
        nodes: usize,
        anchors: usize,
        dimensions: usize,
        reach_m: f64,
        noise_m: f64,
    ) -> (DistanceProblem, Vec<Position>) {
        let draw = |node: usize, axis: u64| 30.0 * Seed(5).uniform(Purpose::new(8), [node as u64, axis, 1]);
        let z = |node: usize| if dimensions == 3 { draw(node, 2) } else { 0.0 };
        let places: Vec<Position> =
            (0..nodes).map(|node| Position::new(draw(node, 0), draw(node, 1), z(node))).collect();
        let mut pairs = Vec::new();
        for a in 0..nodes {
            for b in a + 1..nodes {
                let distance_m = places[a].distance_m(places[b]);
                if distance_m < reach_m {
                    let noise = noise_m * Seed(6).normal(Purpose::new(8), [a as u64, b as u64, 2]);
                    pairs.push(PairDistance { a, b, distance_m: (distance_m + noise).max(0.01) });
                }
            }
        }
        let anchors = (0..anchors).map(|node| (node, places[node])).collect();
        (DistanceProblem { nodes, pairs, anchors, dimensions }, places)
    }

    fn worst_m(found: &Localised, places: &[Position]) -> f64 {
        let errors = found.places.iter().zip(places).map(|(found, place)| found.unwrap().distance_m(*place));
        errors.fold(0.0, f64::max)
    }

    #[test]
    fn exact_distances_of_all_pairs_give_the_exact_places_by_each_method() {
        for dimensions in [2, 3] {
            let (problem, places) = problem(20, 5, dimensions, f64::INFINITY, 0.0);
            for method in [LocaliseMethod::Mds, LocaliseMethod::Smacof, LocaliseMethod::LeastSquares] {
                let found = localise(&problem, method, &Unwatched).unwrap();
                assert!(worst_m(&found, &places) < 1e-6, "{method:?}: {}", worst_m(&found, &places));
                assert!(found.in_world && found.residual_m.unwrap() < 1e-6);
            }
        }
    }

    #[test]
    fn least_squares_is_best_of_noisy_distances_of_neighbours_and_its_regions_hold_the_places() {
        let (problem, places) = problem(60, 6, 2, 12.0, 0.1);
        let mean = |method| {
            let found = localise(&problem, method, &Unwatched).unwrap();
            let errors = found.places.iter().zip(&places).map(|(found, place)| found.unwrap().distance_m(*place));
            errors.sum::<f64>() / 54.0
        };
        let means = [LocaliseMethod::LeastSquares, LocaliseMethod::Smacof, LocaliseMethod::Mds].map(mean);
        assert!(means[0] < 0.1 && means[0] <= means[1] && means[1] < means[2], "{means:?}");
        let found = localise(&problem, LocaliseMethod::LeastSquares, &Unwatched).unwrap();
        let held = (6..60).filter(|&node| {
            let apart = found.places[node].unwrap() - places[node];
            let [[xx, xy, _], [_, yy, _], _] = found.covariances[node].unwrap();
            let squared = (yy * apart.x_m.powi(2) - 2.0 * xy * apart.x_m * apart.y_m + xx * apart.y_m.powi(2))
                / (xx * yy - xy * xy);
            squared < 5.991
        });
        // 54 regions of 95 %: 46 or fewer hold with a probability of 1 %.
        assert!(held.count() > 46);
        assert_eq!(found.covariances[0], None);
    }

    #[test]
    fn without_anchors_places_have_the_distances_and_parts_are_apart() {
        let (mut problem, _) = problem(12, 0, 2, f64::INFINITY, 0.0);
        problem.pairs.retain(|pair| (pair.a < 6) == (pair.b < 6));
        let found = localise(&problem, LocaliseMethod::LeastSquares, &Unwatched).unwrap();
        assert!(!found.in_world && found.residual_m.unwrap() < 1e-6);
        assert_eq!(found.part_of, [0, 0, 0, 0, 0, 0, 1, 1, 1, 1, 1, 1]);
        // Anchors in one part place no other part.
        problem.anchors = (0..3).map(|node| (node, found.places[node].unwrap())).collect();
        let found = localise(&problem, LocaliseMethod::LeastSquares, &Unwatched).unwrap();
        assert!(found.places[..6].iter().all(Option::is_some) && found.places[6..].iter().all(Option::is_none));
    }

    #[test]
    fn numbers_that_are_not_allowed_are_named() {
        let told = |change: fn(&mut DistanceProblem)| {
            let (mut problem, _) = problem(5, 3, 2, f64::INFINITY, 0.0);
            change(&mut problem);
            localise(&problem, LocaliseMethod::Mds, &Unwatched).unwrap_err().to_string()
        };
        assert_eq!(told(|problem| problem.pairs[0].b = 9), "node 9; allowed: 0 to 4 for 5 nodes");
        assert!(told(|problem| problem.pairs[0].distance_m = -1.0).contains("is -1 m; allowed: a number above 0"));
        assert!(told(|problem| problem.anchors.truncate(2)).contains("2 anchors; allowed: none, or at least 3"));
        assert!(told(|problem| problem.anchors[1].0 = 0).contains("anchor 0"));
        assert_eq!(told(|problem| problem.dimensions = 4), "4 dimensions; allowed: 2 or 3");
    }
}
