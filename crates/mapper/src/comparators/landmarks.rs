//! Nodes from which hops are counted.

use sextant_kernel::{Interrupted, Seed, SettingError, Watch};

use crate::purpose;

use super::graph::{Graph, UNREACHED};

/// How to choose the nodes from which hops are counted, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(rename_all = "snake_case"))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub enum LandmarksConfig {
    /// One after the other; each is as many hops as possible from those before.
    FarthestPoints(CountConfig),
    /// Nodes at the extremes of a coordinate that is defined by two random nodes (Dhanapala and Jayasumana 2014,
    /// "extreme node search"); if these are too few, farthest points are added.
    ExtremeNodeSearch(ExtremeConfig),
    /// At random.
    Random(CountConfig),
    /// The anchors. Their places are not used.
    Anchors {},
}

/// How many nodes, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CountConfig {
    /// Nodes in each connected part of the network: 4 or more.
    #[cfg_attr(feature = "schema", schemars(range(min = 4)))]
    pub count: usize,
}

impl Default for CountConfig {
    fn default() -> Self {
        Self { count: 20 }
    }
}

/// Extreme node search, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields, default))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExtremeConfig {
    /// Hops within which a node's coordinate must be the highest or the lowest: 1 or more.
    pub hops: u32,
}

impl Default for ExtremeConfig {
    fn default() -> Self {
        Self { hops: 3 }
    }
}

impl Default for LandmarksConfig {
    fn default() -> Self {
        Self::FarthestPoints(CountConfig::default())
    }
}

impl LandmarksConfig {
    /// Checks the numbers.
    pub(super) fn check(self) -> Result<(), SettingError> {
        match self {
            Self::FarthestPoints(CountConfig { count }) if count < 4 => {
                Err(SettingError::new("farthest_points.count", count, "4 or more"))
            }
            Self::Random(CountConfig { count }) if count < 4 => {
                Err(SettingError::new("random.count", count, "4 or more"))
            }
            Self::ExtremeNodeSearch(ExtremeConfig { hops: 0 }) => {
                Err(SettingError::new("extreme_node_search.hops", 0, "1 or more"))
            }
            _ => Ok(()),
        }
    }

    /// The nodes chosen in `part`, a connected part of the network: at least `least` of them, if it has as many.
    pub(super) fn choose(
        self,
        graph: &Graph,
        part: &[usize],
        seed: Seed,
        least: usize,
        anchors: &[usize],
        watch: &dyn Watch,
    ) -> Result<Vec<usize>, Interrupted> {
        let order = shuffled(part, seed);
        Ok(match self {
            Self::Random(CountConfig { count }) => order.into_iter().take(count).collect(),
            Self::FarthestPoints(CountConfig { count }) => {
                let hops = graph.hops_from(order[0]);
                let first = farthest(part, |node| hops[node]);
                spread(graph, part, vec![first], count, watch)?
            }
            Self::ExtremeNodeSearch(ExtremeConfig { hops }) => {
                let extremes = extremes(graph, part, &order, hops, watch)?;
                let count = extremes.len().max(least);
                let start = if extremes.is_empty() { vec![order[0]] } else { extremes };
                spread(graph, part, start, count, watch)?
            }
            Self::Anchors {} => anchors.iter().copied().filter(|node| part.binary_search(node).is_ok()).collect(),
        })
    }
}

/// The nodes of `part` in random order. Whether one node comes before another does not depend on the other nodes.
fn shuffled(part: &[usize], seed: Seed) -> Vec<usize> {
    let mut order: Vec<_> =
        part.iter().map(|&node| (seed.bits(purpose::MAPPER, [LANDMARKS, node as u64, 0]), node)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, node)| node).collect()
}

/// First word of the addresses of these draws.
const LANDMARKS: u64 = 1;

/// The node with the most `hops`; of several, the one with the lowest number.
fn farthest(part: &[usize], hops: impl Fn(usize) -> u32) -> usize {
    let mut best = part[0];
    for &node in part {
        if hops(node) > hops(best) {
            best = node;
        }
    }
    best
}

/// Adds to `chosen` the node with the most hops to the nearest of them until there are `count` (farthest-point
/// sampling, Gonzalez 1985), or all nodes are chosen.
fn spread(
    graph: &Graph,
    part: &[usize],
    mut chosen: Vec<usize>,
    count: usize,
    watch: &dyn Watch,
) -> Result<Vec<usize>, Interrupted> {
    let mut nearest = vec![UNREACHED; graph.node_count()];
    let cover = |nearest: &mut Vec<u32>, node: usize| {
        for (nearest, hops) in nearest.iter_mut().zip(graph.hops_from(node)) {
            *nearest = hops.min(*nearest);
        }
    };
    for &node in &chosen {
        watch.check()?;
        cover(&mut nearest, node);
    }
    while chosen.len() < count.min(part.len()) {
        watch.check()?;
        let next = farthest(part, |node| nearest[node]);
        cover(&mut nearest, next);
        chosen.push(next);
    }
    Ok(chosen)
}

/// The nodes whose directional coordinate `(h₁² − h₂²)/(2 h₁₂)` is strictly the highest or strictly the lowest within
/// `hops` hops, h₁ and h₂ being the hops to two random nodes.
fn extremes(
    graph: &Graph,
    part: &[usize],
    order: &[usize],
    hops: u32,
    watch: &dyn Watch,
) -> Result<Vec<usize>, Interrupted> {
    let &[first, second, ..] = order else { return Ok(order.to_vec()) };
    let (from_first, from_second) = (graph.hops_from(first), graph.hops_from(second));
    let square = |hops: u32| f64::from(hops) * f64::from(hops);
    let span = 2.0 * f64::from(from_first[second]);
    let coordinate = |node: usize| (square(from_first[node]) - square(from_second[node])) / span;
    let is_extreme = |&node: &usize| {
        let own = coordinate(node);
        let near = neighbourhood(graph, node, hops);
        near.iter().all(|&other| coordinate(other) < own) || near.iter().all(|&other| coordinate(other) > own)
    };
    let mut extremes = Vec::new();
    for &node in part {
        watch.check()?;
        if is_extreme(&node) {
            extremes.push(node);
        }
    }
    Ok(extremes)
}

/// The nodes within `hops` hops of `node`, itself left out.
fn neighbourhood(graph: &Graph, node: usize, hops: u32) -> Vec<usize> {
    let mut is_found = vec![false; graph.node_count()];
    is_found[node] = true;
    let mut found = Vec::new();
    let mut ring = vec![node];
    for _ in 0..hops {
        let mut next = Vec::new();
        for &node in &ring {
            for &other in graph.neighbours(node) {
                if !std::mem::replace(&mut is_found[other as usize], true) {
                    found.push(other as usize);
                    next.push(other as usize);
                }
            }
        }
        ring = next;
    }
    found
}

#[cfg(test)]
mod tests {
    use sextant_kernel::Unwatched;

    use super::*;
    use crate::comparators::graph::tests::heard_within;
    use sextant_channel::Position;

    fn line(count: u32) -> Graph {
        let places: Vec<Position> = (0..count).map(|i| Position::new(f64::from(i), 0.0, 0.0)).collect();
        Graph::of(&heard_within(&places, 1.1), 0.5)
    }

    fn chosen(config: LandmarksConfig, graph: &Graph, least: usize) -> Vec<usize> {
        let part: Vec<usize> = (0..graph.node_count()).collect();
        config.choose(graph, &part, Seed(1), least, &[3, 7], &Unwatched).unwrap()
    }

    #[test]
    fn farthest_points_of_a_line_are_its_ends_then_its_middle() {
        let graph = line(9);
        let mut found = chosen(LandmarksConfig::FarthestPoints(CountConfig { count: 3 }), &graph, 0);
        found[..2].sort_unstable();
        assert_eq!(found, [0, 8, 4]);
    }

    #[test]
    fn the_extremes_of_a_line_lie_at_its_ends() {
        // Between the two random nodes the coordinate rises by one a hop, beyond them it stays: the extremes are
        // where it is strict, filled up with farthest points, the ends among them.
        let graph = line(30);
        let found = chosen(LandmarksConfig::ExtremeNodeSearch(ExtremeConfig { hops: 3 }), &graph, 6);
        assert!(found.len() >= 6 && (found.contains(&0) || found.contains(&29)), "{found:?}");
    }

    #[test]
    fn random_nodes_are_distinct_and_anchors_are_those_in_the_part() {
        let graph = line(10);
        let mut found = chosen(LandmarksConfig::Random(CountConfig { count: 6 }), &graph, 0);
        found.sort_unstable();
        found.dedup();
        assert_eq!(found.len(), 6);
        assert_eq!(chosen(LandmarksConfig::Anchors {}, &graph, 0), [3, 7]);
        assert_eq!(chosen(LandmarksConfig::Random(CountConfig { count: 60 }), &graph, 0).len(), 10);
    }
}
