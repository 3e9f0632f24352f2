//! The place with the least mean distance to nodes.

use nalgebra::{Matrix3, Vector3};
use sextant_channel::Position;

/// Most rounds of each iteration.
const ROUNDS: usize = 200;
/// How near to a node a place is at it, and the shortest step (as shares of the spread).
const AT_NODE: f64 = 1e-9;
/// How often a step is halved that leads too far.
const HALVINGS: usize = 30;

/// The place with the least mean distance to `nodes` (geometric median), by the iteration of Weiszfeld (1937) with the step
/// of Vardi and Zhang (2000) at a node.
pub(super) fn geometric_median(nodes: &[Position]) -> Option<Position> {
    let mean = |weighted: &mut dyn Iterator<Item = (Position, f64)>| {
        let (sum, weights) = weighted.fold((Position::ORIGIN, 0.0), |(sum, all), (p, w)| (sum + p * w, all + w));
        (weights > 0.0).then(|| sum * (1.0 / weights))
    };
    let mut place = mean(&mut nodes.iter().map(|&node| (node, 1.0)))?;
    let spread_m = nodes.iter().map(|node| node.distance_m(place)).fold(0.0, f64::max);
    for _ in 0..ROUNDS {
        let is_here = |node: &&Position| node.distance_m(place) <= AT_NODE * spread_m;
        let here = nodes.iter().filter(is_here).count() as f64;
        let others = || nodes.iter().filter(|node| !is_here(node));
        let Some(next) = mean(&mut others().map(|&node| (node, 1.0 / node.distance_m(place)))) else {
            return Some(place);
        };
        let pull =
            others().fold(Position::ORIGIN, |pull, &node| pull + (node - place) * (1.0 / node.distance_m(place)));
        let pull = pull.length_m();
        if pull <= here {
            return Some(place);
        }
        let step = (next - place) * (1.0 - here / pull);
        place = place + step;
        if step.length_m() <= AT_NODE * spread_m {
            return Some(place);
        }
    }
    Some(improved(nodes, place))
}

/// A place from which the steps of Weiszfeld lead on only slowly, because the nodes are almost on a line or the best place
/// is almost at a node, moved by Newton's method to the best place.
fn improved(nodes: &[Position], mut place: Position) -> Position {
    let sum_m = |place: Position| nodes.iter().map(|node| node.distance_m(place)).sum::<f64>();
    let mut least_m = sum_m(place);
    for _ in 0..ROUNDS {
        let Some(step) = newton_step(nodes, place) else { break };
        let shares = std::iter::successors(Some(1.0), |share| Some(0.5 * share)).take(HALVINGS);
        let mut tries = shares.map(|share| place + step * share).map(|next| (next, sum_m(next)));
        let Some(better) = tries.find(|&(_, sum_m)| sum_m < least_m) else { break };
        (place, least_m) = better;
    }
    // Newton's method does not end at a node, where the sum has no derivative. If all are on a line, the best place is one.
    let of_nodes = nodes.iter().map(|&node| (node, sum_m(node)));
    let best = of_nodes.min_by(|a, b| a.1.total_cmp(&b.1));
    best.filter(|&(_, sum_m)| sum_m <= least_m).map_or(place, |(node, _)| node)
}

/// The step to where the sum of the distances to `nodes` would be least if it were a quadratic function; `None` if that is
/// nowhere.
fn newton_step(nodes: &[Position], place: Position) -> Option<Position> {
    let (mut slope, mut curvature) = (Vector3::zeros(), Matrix3::zeros());
    for node in nodes {
        let apart: [f64; 3] = (place - *node).into();
        let apart = Vector3::from(apart);
        let distance_m = apart.norm();
        if distance_m > 0.0 {
            let direction = apart / distance_m;
            slope += direction;
            curvature += (Matrix3::identity() - direction * direction.transpose()) / distance_m;
        }
    }
    let step = -curvature.cholesky()?.solve(&slope);
    let step = Position::new(step.x, step.y, step.z);
    step.length_m().is_finite().then_some(step)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn at(x: f64, y: f64) -> Position {
        Position::new(x, y, 0.0)
    }

    fn mean_distance_m(nodes: &[Position], place: Position) -> f64 {
        nodes.iter().map(|node| node.distance_m(place)).sum::<f64>() / nodes.len() as f64
    }

    proptest! {
        #[test]
        fn no_other_place_has_a_smaller_mean_distance_than_the_median(
            nodes in prop::collection::vec((-30.0..30.0_f64, -9.0..9.0_f64), 1..30),
            height_m in prop_oneof![Just(9.0), Just(1e-3), Just(1e-9), Just(0.0)],
            off in (-3.0..3.0_f64, -3.0..3.0_f64),
        ) {
            // Also nodes that are almost on a line, which is not an axis.
            let turned = |(x, y): (f64, f64)| at(0.8 * x - 0.6 * y, 0.6 * x + 0.8 * y);
            let nodes: Vec<Position> = nodes.into_iter().map(|(x, y)| turned((x, y * height_m / 9.0))).collect();
            let median = geometric_median(&nodes).expect("nodes");
            let least = mean_distance_m(&nodes, median);
            for scale in [1.0, 0.1, 0.01] {
                let other = median + turned(off) * scale;
                prop_assert!(mean_distance_m(&nodes, other) >= least - 1e-7 * (1.0 + least), "{median}, not {other}");
            }
        }
    }

    #[test]
    fn the_median_of_a_cross_is_its_middle_and_of_most_nodes_in_one_place_that_place() {
        let cross = [at(-3.0, 1.0), at(5.0, 1.0), at(0.0, -7.0), at(0.0, 2.0)];
        assert!(geometric_median(&cross).expect("nodes").distance_m(at(0.0, 1.0)) < 1e-6);
        let heavy = [at(2.0, 2.0), at(2.0, 2.0), at(2.0, 2.0), at(9.0, 0.0), at(-4.0, 1.0)];
        assert!(geometric_median(&heavy).expect("nodes").distance_m(at(2.0, 2.0)) < 1e-6);
        assert_eq!(geometric_median(&[]), None);
    }

    #[test]
    fn the_median_of_a_flat_quadrilateral_is_where_its_diagonals_cross() {
        // 200 steps of Weiszfeld end 0.2 m from there.
        let [a, b, c, d] = [at(-30.0, 0.1), at(-20.0, -0.1), at(29.0, -0.1), at(25.0, 0.1)];
        let (along, across) = (c - a, d - b);
        let cross = |p: Position, q: Position| p.x_m * q.y_m - p.y_m * q.x_m;
        let expected = a + along * (cross(b - a, across) / cross(along, across));
        let found = geometric_median(&[a, b, c, d]).expect("nodes");
        assert!(found.distance_m(expected) < 1e-4, "{found}, not {expected}");
    }
}
