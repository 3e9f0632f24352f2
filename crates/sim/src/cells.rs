//! A spatial index: things filed by the cell of the space that they are in.

use sextant_channel::Position;

/// Cells per axis at most; coarser cells only cost a longer look.
const MAX_CELLS: f64 = 1024.0;

/// Things filed under cubic cells at least as wide as the reach of a look-up, so that all within reach
/// of a place are found in its own and the adjacent cells. Places outside the bounds belong to the nearest cell.
#[derive(Clone, Debug)]
pub(crate) struct Cells<T> {
    origin: Position,
    side_m: f64,
    counts: [usize; 3],
    items: Vec<Vec<T>>,
}

impl<T> Cells<T> {
    /// Empty cells over the bounds of `places` for look-ups within `reach_m`.
    pub(crate) fn covering(places: impl Iterator<Item = Position> + Clone, reach_m: f64) -> Self {
        let infinite = Position::new(f64::INFINITY, f64::INFINITY, f64::INFINITY);
        let low =
            places.clone().fold(infinite, |a, p| Position::new(a.x_m.min(p.x_m), a.y_m.min(p.y_m), a.z_m.min(p.z_m)));
        let high =
            places.fold(infinite * -1.0, |a, p| Position::new(a.x_m.max(p.x_m), a.y_m.max(p.y_m), a.z_m.max(p.z_m)));
        let extent = high - low;
        let widest = extent.x_m.max(extent.y_m).max(extent.z_m);
        if !widest.is_finite() || !reach_m.is_finite() {
            return Self { origin: Position::ORIGIN, side_m: f64::INFINITY, counts: [1; 3], items: vec![Vec::new()] };
        }
        let side_m = reach_m.max(widest / MAX_CELLS).max(f64::MIN_POSITIVE);
        let counts = [extent.x_m, extent.y_m, extent.z_m].map(|length| index(length / side_m) + 1);
        let items = (0..counts.iter().product()).map(|_| Vec::new()).collect();
        Self { origin: low, side_m, counts, items }
    }

    fn coordinates(&self, place: Position) -> [usize; 3] {
        let offset = place - self.origin;
        let mut cell = [offset.x_m, offset.y_m, offset.z_m].map(|length| index(length / self.side_m));
        for (coordinate, &count) in cell.iter_mut().zip(&self.counts) {
            *coordinate = (*coordinate).min(count - 1);
        }
        cell
    }

    fn flat(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }

    /// The things in the cell of `place`.
    pub(crate) fn at(&mut self, place: Position) -> &mut Vec<T> {
        let cell = self.flat(self.coordinates(place));
        &mut self.items[cell]
    }

    /// The cells that hold all things within reach of `place`, in a fixed order.
    pub(crate) fn near(&mut self, place: Position, mut visit: impl FnMut(&mut Vec<T>)) {
        let centre = self.coordinates(place);
        let range = |axis: usize| centre[axis].saturating_sub(1)..(centre[axis] + 2).min(self.counts[axis]);
        let (xs, ys, zs) = (range(0), range(1), range(2));
        for z in zs {
            for y in ys.clone() {
                for x in xs.clone() {
                    let cell = self.flat([x, y, z]);
                    visit(&mut self.items[cell]);
                }
            }
        }
    }
}

/// The cell number of a length in cells; what lies below the first cell belongs to it.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates, which is meant")]
fn index(length: f64) -> usize {
    length as usize
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
        fn a_look_up_finds_all_within_reach_also_from_outside(
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
