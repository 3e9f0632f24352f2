//! Distances between all pairs of nodes from ranges between neighbours.
//!
//! The distance of two nodes that share neighbours follows from the ranges to these, without the detour over one of
//! them. Three neighbours in common that hear each other form, with the two nodes, a hexahedron of two tetrahedra on one
//! triangle: all its edges but one are known, and it gives the last one but for whether both nodes are on the same side
//! of the triangle. In the plane the same holds for two neighbours in common. Farther nodes are joined by shortest ways.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use nalgebra::{DMatrix, Vector3};
use sextant_kernel::{Interrupted, Watch, Work};

/// Maximum number of hexahedra for a pair of nodes.
const MOST_HEXAHEDRA: usize = 32;
/// Height of a triangle over its longest edge, below which it is a line.
const FLAT: f64 = 0.1;
/// Angle at a shared neighbour, if there is no hexahedron: that of an average bend (rad).
const BEND: f64 = std::f64::consts::TAU / 3.0;

/// Ranges between the neighbours of a part of a network.
#[derive(Clone, Debug)]
pub(super) struct NeighbourRanges {
    /// Of each node, its neighbours in rising order with their distances (m).
    of_node: Vec<Vec<(usize, f64)>>,
    /// Two nodes that are not neighbours are at least this far apart (m).
    apart_m: f64,
    dimensions: usize,
}

impl NeighbourRanges {
    /// The ranges of `pairs` of `nodes` nodes in two or three `dimensions`.
    pub(super) fn new(
        nodes: usize,
        pairs: impl Iterator<Item = (usize, usize, f64)>,
        apart_m: f64,
        dimensions: usize,
    ) -> Self {
        let mut of_node = vec![Vec::new(); nodes];
        for (a, b, distance_m) in pairs {
            of_node[a].push((b, distance_m));
            of_node[b].push((a, distance_m));
        }
        of_node.iter_mut().for_each(|neighbours| neighbours.sort_unstable_by_key(|&(node, _)| node));
        Self { of_node, apart_m, dimensions }
    }

    fn between(&self, a: usize, b: usize) -> Option<f64> {
        let found = self.of_node[a].binary_search_by_key(&b, |&(node, _)| node).ok()?;
        Some(self.of_node[a][found].1)
    }

    /// Shortest ways between all pairs of nodes over neighbours and nodes with a neighbour in common (m); infinite where
    /// there is none.
    pub(super) fn shortest_ways(
        &self,
        algorithm: &'static str,
        watch: &dyn Watch,
    ) -> Result<DMatrix<f64>, Interrupted> {
        let nodes = self.of_node.len();
        let edges: usize = self.of_node.iter().map(Vec::len).sum();
        #[expect(clippy::cast_precision_loss, reason = "numbers for people")]
        let operations = 4.0 * nodes as f64 * edges as f64;
        watch.begin(Work { name: algorithm, unit: "node", steps: 2 * nodes as u64, operations });
        let mut steps = self.of_node.clone();
        for node in 0..nodes {
            watch.check()?;
            watch.advance(1);
            for other in self.second_neighbours(node).into_iter().filter(|&other| other > node) {
                let distance_m = self.over_common_neighbours(node, other);
                steps[node].push((other, distance_m));
                steps[other].push((node, distance_m));
            }
        }
        let mut ways = DMatrix::from_element(nodes, nodes, f64::INFINITY);
        let mut queue = BinaryHeap::new();
        for source in 0..nodes {
            watch.check()?;
            watch.advance(1);
            let mut from_source = ways.column_mut(source);
            from_source[source] = 0.0;
            // Numbers above zero are ordered as their bits are.
            queue.push(Reverse((0.0_f64.to_bits(), source)));
            while let Some(Reverse((bits, node))) = queue.pop() {
                let way_m = f64::from_bits(bits);
                if way_m > from_source[node] {
                    continue;
                }
                for &(next, step_m) in &steps[node] {
                    let longer_m = way_m + step_m;
                    if longer_m < from_source[next] {
                        from_source[next] = longer_m;
                        queue.push(Reverse((longer_m.to_bits(), next)));
                    }
                }
            }
        }
        // Sums in two directions differ by rounding.
        Ok((&ways + ways.transpose()) * 0.5)
    }

    /// The nodes that share a neighbour with `node` but are not neighbours of it, in rising order.
    fn second_neighbours(&self, node: usize) -> Vec<usize> {
        let of = |node: usize| self.of_node[node].iter().map(|&(other, _)| other);
        let mut found: Vec<usize> = of(node).flat_map(of).collect();
        found.sort_unstable();
        found.dedup();
        found.retain(|&other| other != node && self.between(node, other).is_none());
        found
    }

    /// The distance of two nodes that share neighbours (m).
    fn over_common_neighbours(&self, a: usize, b: usize) -> f64 {
        let shared: Vec<(usize, [f64; 2])> = self.of_node[a]
            .iter()
            .filter_map(|&(node, from_a)| Some((node, [from_a, self.between(node, b)?])))
            .collect();
        let mut candidates: Vec<[f64; 2]> = Vec::new();
        'enough: for (i, &(j, to_j)) in shared.iter().enumerate() {
            for (at, &(l, to_l)) in shared.iter().enumerate().skip(i + 1) {
                let Some(jl) = self.between(j, l) else { continue };
                if self.dimensions == 2 {
                    candidates.extend(opposite_corners([0.0, jl, 0.0], [to_j, to_l, [0.0; 2]]));
                } else {
                    for &(m, to_m) in &shared[at + 1..] {
                        if let (Some(jm), Some(lm)) = (self.between(j, m), self.between(l, m)) {
                            candidates.extend(hexahedron([jl, jm, lm], [to_j, to_l, to_m]));
                        }
                    }
                }
                if candidates.len() >= MOST_HEXAHEDRA {
                    break 'enough;
                }
            }
        }
        self.likeliest(&candidates).unwrap_or_else(|| {
            let bent = |&(_, [a, b]): &(usize, [f64; 2])| (a * a + b * b - 2.0 * a * b * libm::cos(BEND)).sqrt();
            shared.iter().map(bent).fold(f64::INFINITY, f64::min).max(self.apart_m)
        })
    }

    /// The candidate that is nearest to one of the two of each hexahedron (sum of the deviations), among those of nodes
    /// that do not hear each other if there are any; of several such candidates, the largest.
    fn likeliest(&self, candidates: &[[f64; 2]]) -> Option<f64> {
        let all = candidates.iter().flatten().copied();
        let largest = all.clone().fold(f64::NEG_INFINITY, f64::max);
        let misfit = |distance_m: f64| -> f64 {
            candidates.iter().map(|pair| (pair[0] - distance_m).abs().min((pair[1] - distance_m).abs())).sum()
        };
        let possible = all.filter(|&distance_m| distance_m > self.apart_m || largest <= self.apart_m);
        let better = |best: Option<(f64, f64)>, distance_m: f64| {
            let misfit = misfit(distance_m);
            match best {
                Some((least, longest_m))
                    if misfit > least + 1e-9 || misfit > least - 1e-9 && distance_m <= longest_m =>
                {
                    best
                }
                _ => Some((misfit, distance_m)),
            }
        };
        possible.fold(None, better).map(|(_, distance_m)| distance_m)
    }
}

/// The two possible distances of two nodes from the edges jl, jm, lm of a triangle and the ranges of its corners to both
/// nodes (m): on the same side of it, and on opposite sides. `None` if the triangle is almost a line.
pub(super) fn hexahedron([jl, jm, lm]: [f64; 3], ranges: [[f64; 2]; 3]) -> Option<[f64; 2]> {
    let along = (jl * jl + jm * jm - lm * lm) / (2.0 * jl);
    let height = (jm * jm - along * along).max(0.0).sqrt();
    if height < FLAT * jl.max(jm).max(lm) {
        return None;
    }
    opposite_corners([along, jl, height], ranges)
}

/// The same with j at the origin, l at `jl` on the x-axis and m at (`along`, `height`). Without a height, in the plane.
fn opposite_corners([along, jl, height]: [f64; 3], [to_j, to_l, to_m]: [[f64; 2]; 3]) -> Option<[f64; 2]> {
    if jl <= 0.0 {
        return None;
    }
    let [a, b] = [0, 1].map(|node| {
        let (j, l, m) = (to_j[node], to_l[node], to_m[node]);
        let x = (j * j - l * l + jl * jl) / (2.0 * jl);
        let y = if height > 0.0 {
            (j * j - m * m + along * along + height * height - 2.0 * along * x) / (2.0 * height)
        } else {
            0.0
        };
        // Ranges with errors may be too short to meet.
        Vector3::new(x, y, (j * j - x * x - y * y).max(0.0).sqrt())
    });
    let apart = a - b;
    let across = apart.x * apart.x + apart.y * apart.y;
    Some([(across + apart.z * apart.z).sqrt(), (across + (a.z + b.z).powi(2)).sqrt()])
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::Position;
    use sextant_kernel::{Purpose, Seed, Unwatched};

    fn ranges(places: &[Position], range_m: f64, dimensions: usize) -> NeighbourRanges {
        let pairs = (0..places.len()).flat_map(|a| (a + 1..places.len()).map(move |b| (a, b)));
        let linked = pairs.map(|(a, b)| (a, b, places[a].distance_m(places[b]))).filter(|&(.., d)| d <= range_m);
        NeighbourRanges::new(places.len(), linked, range_m, dimensions)
    }

    #[test]
    fn a_hexahedron_of_five_points_gives_the_distance_of_its_tips() {
        for seed in 0..200 {
            let draw = |i: u64, axis| Seed(seed).uniform(Purpose::new(8), [i, axis, 3]) - 0.5;
            let point = |i| Position::new(draw(i, 0), draw(i, 1), draw(i, 2));
            let [j, l, m] = [0, 1, 2].map(point);
            for (a, b, side) in [
                (point(3), point(4) + Position::new(0.0, 0.0, 9.0), "any"),
                (Position::new(0.1, 0.2, 2.0), Position::new(-0.3, 0.1, -1.5), "opposite"),
            ] {
                let to = |corner: Position| [a.distance_m(corner), b.distance_m(corner)];
                let edges = [j.distance_m(l), j.distance_m(m), l.distance_m(m)];
                if let Some(candidates) = hexahedron(edges, [to(j), to(l), to(m)]) {
                    let expected = a.distance_m(b);
                    let miss = candidates.map(|found| (found - expected).abs());
                    assert!(miss[0].min(miss[1]) < 1e-6, "seed {seed}, {side}: {candidates:?} for {expected}");
                    assert!(candidates[0] <= candidates[1]);
                }
            }
        }
        // Two unit tetrahedra on one triangle: the tips are twice the height of sqrt(2/3) apart.
        let candidates = hexahedron([1.0; 3], [[1.0; 2]; 3]).unwrap();
        assert!(candidates[0].abs() < 1e-12 && (candidates[1] - 2.0 * (2.0_f64 / 3.0).sqrt()).abs() < 1e-12);
        assert_eq!(hexahedron([1.0, 0.5, 0.5], [[1.0; 2]; 3]), None, "a triangle that is a line");
    }

    #[test]
    fn most_nodes_with_neighbours_in_common_have_their_exact_distance() {
        for dimensions in [2, 3] {
            let draw = |i: u64, axis| Seed(2).uniform(Purpose::new(8), [i, axis, 4]);
            let height = if dimensions == 3 { 1.0 } else { 0.0 };
            let places: Vec<Position> =
                (0..60).map(|i| Position::new(draw(i, 0), draw(i, 1), height * draw(i, 2))).collect();
            let ranges = ranges(&places, 0.8, dimensions);
            let ways = ranges.shortest_ways("dr-mds", &Unwatched).unwrap();
            let (mut exact, mut all) = (0, 0);
            for a in 0..60 {
                for b in ranges.second_neighbours(a) {
                    all += 1;
                    exact += u32::from((ways[(a, b)] - places[a].distance_m(places[b])).abs() < 1e-6);
                }
            }
            // The others share too few neighbours to tell the sides of a triangle apart.
            assert!(all > 100 && f64::from(exact) > 0.9 * f64::from(all), "{dimensions}: {exact} of {all}");
        }
    }

    #[test]
    fn without_a_hexahedron_the_way_bends_by_a_third_of_a_turn() {
        let places = [0.0, 1.0, 2.0].map(|x| Position::new(x, 0.0, 0.0));
        let ways = ranges(&places, 1.0, 3).shortest_ways("dr-mds", &Unwatched).unwrap();
        assert!((ways[(0, 2)] - 3.0_f64.sqrt()).abs() < 1e-12);
        let apart = ranges(&[Position::ORIGIN, Position::new(9.0, 0.0, 0.0)], 1.0, 3);
        assert!(apart.shortest_ways("dr-mds", &Unwatched).unwrap()[(0, 1)].is_infinite());
    }
}
