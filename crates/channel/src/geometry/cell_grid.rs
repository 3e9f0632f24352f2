//! A grid of cubic cells, for spatial indices.

use crate::geometry::position::Position;

/// Cubic cells over the bounds of some places, numbered from zero, x fastest. Places outside the bounds belong to the
/// nearest cell.
#[derive(Clone, Debug)]
pub struct CellGrid {
    low: [f64; 3],
    per_m: f64,
    counts: [usize; 3],
}

impl CellGrid {
    /// Cells over the bounds of `places`. They are `cell_m` wide, or wider if this would give many more cells than
    /// places, also if `cell_m` is zero. One cell if there are no places, or if `cell_m` is infinite.
    #[must_use]
    pub fn covering(places: impl IntoIterator<Item = Position>, cell_m: f64) -> Self {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let mut number = 0_usize;
        for place in places {
            number += 1;
            for (axis, value) in <[f64; 3]>::from(place).into_iter().enumerate() {
                low[axis] = low[axis].min(value);
                high[axis] = high[axis].max(value);
            }
        }
        if number == 0 {
            return Self { low: [0.0; 3], per_m: 0.0, counts: [1; 3] };
        }
        let most = number.saturating_mul(4).saturating_add(64);
        let mut per_m = 1.0 / cell_m.max(f64::MIN_POSITIVE);
        let counts = loop {
            let counts = [0, 1, 2].map(|axis| whole((high[axis] - low[axis]) * per_m).saturating_add(1));
            if counts.iter().fold(1_usize, |product, &count| product.saturating_mul(count)) <= most {
                break counts;
            }
            per_m *= 0.5;
        };
        Self { low, per_m, counts }
    }

    /// Number of cells.
    #[must_use]
    pub fn cell_count(&self) -> usize {
        self.counts.iter().product()
    }

    /// Number of layers of cells along `axis` (0 to 2).
    ///
    /// # Panics
    /// If `axis` is above 2.
    #[must_use]
    #[inline]
    pub fn layers(&self, axis: usize) -> usize {
        self.counts[axis]
    }

    /// The layer along `axis` (0 to 2) that holds the coordinate `value_m`, or the nearest one.
    ///
    /// # Panics
    /// If `axis` is above 2.
    #[must_use]
    #[inline]
    pub fn layer(&self, axis: usize, value_m: f64) -> usize {
        whole((value_m - self.low[axis]) * self.per_m).min(self.counts[axis] - 1)
    }

    /// The layers along x, y and z that hold `place`.
    #[must_use]
    #[inline]
    pub fn layers_of(&self, place: Position) -> [usize; 3] {
        let place: [f64; 3] = place.into();
        [0, 1, 2].map(|axis| self.layer(axis, place[axis]))
    }

    /// The number of the cell in these layers.
    #[must_use]
    #[inline]
    pub fn cell(&self, [x, y, z]: [usize; 3]) -> usize {
        (z * self.counts[1] + y) * self.counts[0] + x
    }
}

/// The integer part of a number of cells; 0 if negative, because places below the first cell belong to it.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "the cast saturates, as intended")]
#[inline]
fn whole(cells: f64) -> usize {
    cells as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_inside_have_their_own_cell_and_places_outside_the_nearest() {
        let corners = [Position::new(-1.0, 2.0, 0.0), Position::new(4.0, 5.5, 0.0)];
        let grid = CellGrid::covering(corners, 1.0);
        assert_eq!([0, 1, 2].map(|axis| grid.layers(axis)), [6, 4, 1]);
        assert_eq!(grid.cell_count(), 24);
        assert_eq!(grid.layers_of(Position::new(0.5, 4.9, 0.0)), [1, 2, 0]);
        assert_eq!(grid.cell([1, 2, 0]), 13);
        assert_eq!(grid.layers_of(Position::new(-9.0, 99.0, 7.0)), [0, 3, 0]);
    }

    #[test]
    fn few_places_in_a_large_space_have_few_cells() {
        let far = [Position::ORIGIN, Position::new(1e9, 1e9, 1e9)];
        assert!(CellGrid::covering(far, 1e-3).cell_count() <= 72);
        assert_eq!(CellGrid::covering([], 1.0).cell_count(), 1);
        assert_eq!(CellGrid::covering(far, f64::INFINITY).cell_count(), 1);
    }
}
