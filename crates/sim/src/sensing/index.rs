//! A spatial index of the nodes that detect targets.

use std::collections::BTreeMap;

use sextant_channel::{CellGrid, Position};
use sextant_kernel::NodeId;

use crate::world::target::Leg;

/// The nodes that detect targets, in cells as wide as their radius.
pub(super) struct NodeIndex {
    radius_m: f64,
    grid: CellGrid,
    cells: Vec<Vec<NodeId>>,
    places: BTreeMap<NodeId, Position>,
}

impl NodeIndex {
    pub(super) fn new(nodes: impl Iterator<Item = (NodeId, Position)>, radius_m: f64) -> Self {
        let places: BTreeMap<NodeId, Position> = nodes.collect();
        let grid = CellGrid::covering(places.values().copied(), radius_m);
        let mut cells = vec![Vec::new(); grid.cell_count()];
        for (&node, &place) in &places {
            cells[grid.cell(grid.layers_of(place))].push(node);
        }
        Self { radius_m, grid, cells, places }
    }

    /// Radius of detection (m).
    pub(super) fn radius_m(&self) -> f64 {
        self.radius_m
    }

    /// The nodes.
    pub(super) fn nodes(&self) -> impl Iterator<Item = NodeId> {
        self.places.keys().copied()
    }

    /// Where a node is (m).
    pub(super) fn place(&self, node: NodeId) -> Position {
        self.places[&node]
    }

    /// Adds all nodes within their radius of a leg to `found`, and some that are farther away; then sorts it.
    pub(super) fn add_near(&self, leg: &Leg, found: &mut Vec<NodeId>) {
        // In pieces, so that the boxes around them hold few cells. There are more nodes than pieces, so that a long
        // leg costs no more than a look at all nodes.
        let step = leg.to - leg.from;
        let whole = (step.length_m() / (2.0 * self.radius_m)).ceil().clamp(1.0, 1.0 + self.places.len() as f64);
        let mut done = 0.0;
        while done < whole {
            let ends = [done / whole, (done + 1.0) / whole].map(|share| leg.from + step * share);
            self.add_around(ends, found);
            done += 1.0;
        }
        found.sort_unstable();
        found.dedup();
    }

    /// Adds the nodes in the cells that the box around a piece of a leg touches, the radius on all sides included.
    fn add_around(&self, [from, to]: [Position; 2], found: &mut Vec<NodeId>) {
        // A little more, so that rounding moves no node out of reach.
        let reach_m = self.radius_m * (1.0 + 1e-9);
        let (from, to) = (<[f64; 3]>::from(from), <[f64; 3]>::from(to));
        let [xs, ys, zs] = [0, 1, 2].map(|axis| {
            let low = self.grid.layer(axis, from[axis].min(to[axis]) - reach_m);
            low..=self.grid.layer(axis, from[axis].max(to[axis]) + reach_m)
        });
        for z in zs {
            for y in ys.clone() {
                for x in xs.clone() {
                    found.extend(&self.cells[self.grid.cell([x, y, z])]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use sextant_kernel::SimTime;

    proptest! {
        #[test]
        fn all_nodes_within_the_radius_of_a_leg_are_found(
            places in proptest::collection::vec([-40.0..40.0, -25.0..25.0, -3.0..3.0_f64], 1..80),
            ends in [[-70.0..70.0, -70.0..70.0, -9.0..9.0_f64], [-70.0..70.0, -70.0..70.0, -9.0..9.0_f64]],
            radius_m in 0.1..40.0_f64,
        ) {
            let [from, to] = ends.map(Position::from);
            let nodes = || places.iter().enumerate().map(|(i, &place)| (NodeId::from_index(i), Position::from(place)));
            let mut found = Vec::new();
            let leg = Leg { from, to, start: SimTime::ZERO, end: SimTime::ZERO };
            NodeIndex::new(nodes(), radius_m).add_near(&leg, &mut found);
            let step = to - from;
            for (node, place) in nodes() {
                let share = ((place - from).dot(step) / step.dot(step)).clamp(0.0, 1.0);
                if place.distance_m(from + step * share) <= radius_m {
                    prop_assert!(found.contains(&node));
                }
            }
        }
    }

    #[test]
    fn a_short_leg_looks_at_few_of_many_nodes() {
        let node = |i: u32| (NodeId(i), Position::new(f64::from(i % 100), f64::from(i / 100), 0.0));
        let index = NodeIndex::new((0..10_000).map(node), 1.5);
        let mut found = Vec::new();
        let end = Position::new(60.0, 50.0, 0.0);
        let leg = Leg { from: Position::new(40.0, 40.0, 0.0), to: end, start: SimTime::ZERO, end: SimTime::ZERO };
        index.add_near(&leg, &mut found);
        // The leg is 22 m long, and the nodes within 1.5 m of it are about 75.
        assert!(found.len() > 60 && found.len() < 400, "{}", found.len());
    }
}
