//! A spatial index: objects stored by the cell of space that they are in.

use sextant_channel::{CellGrid, Position};

/// Objects in cubic cells that are at least as wide as the reach of a look-up, so that all objects within reach
/// of a place are in its own cell and the adjacent cells. Places outside the bounds belong to the nearest cell.
#[derive(Clone, Debug)]
pub(crate) struct Cells<T> {
    grid: CellGrid,
    items: Vec<Vec<T>>,
}

impl<T> Cells<T> {
    /// Empty cells over the bounds of `places` for look-ups within `reach_m`.
    pub(crate) fn covering(places: impl Iterator<Item = Position>, reach_m: f64) -> Self {
        // A little wider, so that rounding moves no object out of reach.
        let grid = CellGrid::covering(places, (reach_m * (1.0 + 1e-9)).max(f64::MIN_POSITIVE));
        let items = (0..grid.cell_count()).map(|_| Vec::new()).collect();
        Self { grid, items }
    }

    /// The objects in the cell of `place`.
    pub(crate) fn at(&mut self, place: Position) -> &mut Vec<T> {
        &mut self.items[self.grid.cell(self.grid.layers_of(place))]
    }

    /// The cells that hold all objects within reach of `place`, in a fixed order.
    pub(crate) fn near(&mut self, place: Position, mut visit: impl FnMut(&mut Vec<T>)) {
        let centre = self.grid.layers_of(place);
        let range = |axis: usize| centre[axis].saturating_sub(1)..(centre[axis] + 2).min(self.grid.layers(axis));
        let (xs, ys, zs) = (range(0), range(1), range(2));
        for z in zs {
            for y in ys.clone() {
                for x in xs.clone() {
                    visit(&mut self.items[self.grid.cell([x, y, z])]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn places() -> impl Strategy<Value = Vec<[f64; 3]>> {
        proptest::collection::vec([-40.0..40.0, -25.0..25.0, -3.0..3.0_f64], 1..60)
    }

    proptest! {
        #[test]
        fn a_look_up_finds_all_objects_within_reach_even_from_outside(
            places in places(), from in [-70.0..70.0, -70.0..70.0, -9.0..9.0_f64], reach in 0.5..90.0_f64,
        ) {
            let places: Vec<Position> = places.into_iter().map(Position::from).collect();
            let from = Position::from(from);
            let mut cells = Cells::covering(places.iter().copied(), reach);
            for (i, &place) in places.iter().enumerate() {
                cells.at(place).push(i);
            }
            let mut found = Vec::new();
            cells.near(from, |cell| found.extend(cell.iter().copied()));
            for (i, &place) in places.iter().enumerate() {
                if place.distance_m(from) <= reach {
                    prop_assert!(found.contains(&i));
                }
            }
        }
    }
}
