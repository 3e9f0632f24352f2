//! Which nodes the halos cover, by cells.

use std::collections::BTreeMap;

use sextant_channel::{CellGrid, Position};
use sextant_kernel::StationId;

/// Which nodes are within the halo of a listener. Halos consist of whole cells.
pub(super) struct Cover {
    grid: CellGrid,
    /// Radius of the cells that a halo has (m): that of the halo and a step.
    radius_m: f64,
    /// The middle and the largest distance from it of the nodes in each cell.
    bounds: Vec<Bounds>,
    /// The cell of each node.
    cell_of: Vec<u32>,
    /// The nodes by cell, ...
    nodes: Vec<u32>,
    /// ... and where those of each cell begin; one more at the end.
    starts: Vec<u32>,
    /// Number of halos over each cell.
    halos: Vec<u16>,
    /// The cells of each halo, in ascending order.
    drawn: BTreeMap<StationId, Vec<u32>>,
}

/// A ball that holds all nodes of a cell.
#[derive(Clone, Copy, Debug)]
struct Bounds {
    middle: Position,
    radius_m: f64,
}

impl Cover {
    /// No halo yet among nodes at `places`; halos are to have `radius_m`, and hold while a listener moves by `step_m`.
    pub(super) fn new(places: impl Iterator<Item = Position> + Clone, radius_m: f64, step_m: f64) -> Self {
        let grid = CellGrid::covering(places.clone(), step_m);
        let cell = |place| u32::try_from(grid.cell(grid.layers_of(place))).expect("fewer cells than 2^32");
        let cell_of: Vec<u32> = places.clone().map(cell).collect();
        let mut starts = vec![0_u32; grid.cell_count() + 1];
        cell_of.iter().for_each(|&cell| starts[cell as usize + 1] += 1);
        for cell in 1..starts.len() {
            starts[cell] += starts[cell - 1];
        }
        let mut next = starts.clone();
        let mut nodes = vec![0; cell_of.len()];
        for (node, &cell) in (0..).zip(&cell_of) {
            nodes[next[cell as usize] as usize] = node;
            next[cell as usize] += 1;
        }
        let places: Vec<Position> = places.collect();
        let bounds = starts.windows(2).map(|ends| bounds(&nodes[ends[0] as usize..ends[1] as usize], &places));
        let bounds = bounds.collect();
        let halos = vec![0; grid.cell_count()];
        let radius_m = radius_m + step_m;
        Self { grid, radius_m, bounds, cell_of, nodes, starts, halos, drawn: BTreeMap::new() }
    }

    /// How far nodes in a halo may be from the place that it was drawn round (m).
    pub(super) fn reach_m(&self) -> f64 {
        self.radius_m + 2.0 * self.bounds.iter().map(|bounds| bounds.radius_m).fold(0.0, f64::max)
    }

    /// Whether a node is in a halo.
    #[inline]
    pub(super) fn holds(&self, node: StationId) -> bool {
        self.halos[self.cell_of[node.index()] as usize] > 0
    }

    /// Draws the halo of a listener round `place`, instead of where it was. Appends the nodes that were in no halo before
    /// to `reached`.
    pub(super) fn draw(&mut self, listener: StationId, place: Position, reached: &mut Vec<StationId>) {
        let cells = self.cells_near(place);
        let before = self.drawn.insert(listener, cells.clone()).unwrap_or_default();
        for &cell in &cells {
            let halos = &mut self.halos[cell as usize];
            *halos += 1;
            if *halos == 1 {
                let ends = [self.starts[cell as usize], self.starts[cell as usize + 1]];
                reached.extend(self.nodes[ends[0] as usize..ends[1] as usize].iter().map(|&node| StationId(node)));
            }
        }
        // After the new ones, so that a cell in both is never left in between.
        before.iter().for_each(|&cell| self.halos[cell as usize] -= 1);
    }

    /// Removes the halo of a listener.
    pub(super) fn lift(&mut self, listener: StationId) {
        let cells = self.drawn.remove(&listener).unwrap_or_default();
        cells.iter().for_each(|&cell| self.halos[cell as usize] -= 1);
    }

    /// The cells with nodes that may be within the radius of `place`, in ascending order.
    fn cells_near(&self, place: Position) -> Vec<u32> {
        let reach = Position::new(self.radius_m, self.radius_m, self.radius_m);
        let (low, high) = (self.grid.layers_of(place - reach), self.grid.layers_of(place + reach));
        let mut cells = Vec::new();
        for z in low[2]..=high[2] {
            for y in low[1]..=high[1] {
                for x in low[0]..=high[0] {
                    let cell = self.grid.cell([x, y, z]);
                    let Bounds { middle, radius_m } = self.bounds[cell];
                    if middle.distance_m(place) <= self.radius_m + radius_m {
                        cells.push(u32::try_from(cell).expect("fewer cells than 2^32"));
                    }
                }
            }
        }
        cells
    }
}

/// A ball that holds these nodes; its radius is minus infinity if there is none.
fn bounds(nodes: &[u32], places: &[Position]) -> Bounds {
    let places = || nodes.iter().map(|&node| places[node as usize]);
    let none = Bounds { middle: Position::ORIGIN, radius_m: f64::NEG_INFINITY };
    let Some(first) = places().next() else { return none };
    let (mut low, mut high) = (<[f64; 3]>::from(first), <[f64; 3]>::from(first));
    for place in places() {
        for (axis, value) in <[f64; 3]>::from(place).into_iter().enumerate() {
            low[axis] = low[axis].min(value);
            high[axis] = high[axis].max(value);
        }
    }
    let middle = (Position::from(low) + Position::from(high)) * 0.5;
    let radius_m = places().map(|place| place.distance_m(middle)).fold(0.0, f64::max);
    // Rounding must leave no node outside.
    Bounds { middle, radius_m: radius_m * (1.0 + 1e-12) + 1e-12 }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn all_nodes_within_the_radius_of_a_listener_are_covered_until_it_has_moved_by_a_step(
            places in proptest::collection::vec([-60.0..60.0_f64, -30.0..30.0, -2.0..2.0], 1..80),
            way in proptest::collection::vec([-70.0..70.0_f64, -40.0..40.0, 0.0..1.0], 1..8),
            radius_m in 0.5..50.0_f64, step_m in 0.1..9.0_f64,
        ) {
            let places: Vec<Position> = places.into_iter().map(Position::from).collect();
            let mut cover = Cover::new(places.iter().copied(), radius_m, step_m);
            let (robot, sink) = (StationId(1000), StationId(1001));
            let sink_place = Position::new(10.0, 0.0, 0.0);
            let mut reached = Vec::new();
            cover.draw(sink, sink_place, &mut reached);
            let mut known: Vec<bool> = vec![false; places.len()];
            for stop in way.into_iter().map(Position::from) {
                cover.draw(robot, stop, &mut reached);
                for node in reached.drain(..) {
                    prop_assert!(!known[node.index()], "a node is reached once until it is left");
                    known[node.index()] = true;
                }
                for (i, &place) in places.iter().enumerate() {
                    let node = StationId::from_index(i);
                    let near_m = place.distance_m(stop).min(place.distance_m(sink_place));
                    if near_m <= radius_m + step_m {
                        prop_assert!(cover.holds(node));
                    }
                    prop_assert!(!cover.holds(node) || known[i]);
                    known[i] &= cover.holds(node);
                }
            }
        }
    }
}
