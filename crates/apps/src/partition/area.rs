//! How much of an area is free, box by box.

use sextant_channel::{Bounds, ObstacleField, Position};
use sextant_sim::layout::Region;

use crate::route::{number, whole};

/// Number of cells along the longer side.
const CELLS: f64 = 256.0;
/// Halvings to find where a box is cut: to the last bit of its sides.
const HALVINGS: u32 = 60;

/// The free part of a region, in cells: each counts as a whole if its middle is in the region and in no obstacle.
#[derive(Clone, Debug)]
pub struct FreeArea {
    bounds: Bounds,
    /// Sides of a cell (m).
    cell: [f64; 2],
    /// Number of cells along x and y.
    count: [usize; 2],
    /// Free cells below and left of each corner, row by row.
    below: Vec<f64>,
}

/// An axis of the plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Axis {
    X,
    Y,
}

impl FreeArea {
    /// The part of `region` without obstacles, seen from above, at the height `z_m`.
    #[must_use]
    pub fn new(region: &Region, obstacles: &ObstacleField, z_m: f64) -> Self {
        let bounds = region.bounds();
        let size = bounds.max - bounds.min;
        let side = size.x_m.max(size.y_m) / CELLS;
        let count = [size.x_m, size.y_m].map(|length_m| whole((length_m / side).ceil().clamp(1.0, CELLS)));
        let cell = [size.x_m / number(count[0]), size.y_m / number(count[1])];
        let plane_m = bounds.center().z_m;
        let row = count[0] + 1;
        let mut below = vec![0.0; row * (count[1] + 1)];
        for y in 0..count[1] {
            let mut along = 0.0;
            for x in 0..count[0] {
                let middle = Position::new(
                    bounds.min.x_m + (number(x) + 0.5) * cell[0],
                    bounds.min.y_m + (number(y) + 0.5) * cell[1],
                    plane_m,
                );
                let is_free = region.contains(middle) && obstacles.containing(Position { z_m, ..middle }).is_none();
                along += f64::from(u8::from(is_free));
                below[(y + 1) * row + x + 1] = below[y * row + x + 1] + along;
            }
        }
        Self { bounds, cell, count, below }
    }

    /// The box of the region.
    #[must_use]
    pub fn bounds(&self) -> Bounds {
        self.bounds
    }

    /// The free area in a box (m²); parts of cells count by their area.
    #[must_use]
    pub fn area_m2(&self, of: &Bounds) -> f64 {
        let cells = self.below(of.max.x_m, of.max.y_m)
            - self.below(of.min.x_m, of.max.y_m)
            - self.below(of.max.x_m, of.min.y_m)
            + self.below(of.min.x_m, of.min.y_m);
        cells * self.cell[0] * self.cell[1]
    }

    /// Free cells below and left of a place.
    fn below(&self, x_m: f64, y_m: f64) -> f64 {
        let split = |along_m: f64, cell_m: f64, count: usize| {
            let at = (along_m / cell_m).clamp(0.0, number(count));
            let cell = whole(at.floor()).min(count - 1);
            (cell, at - number(cell))
        };
        let (x, right) = split(x_m - self.bounds.min.x_m, self.cell[0], self.count[0]);
        let (y, up) = split(y_m - self.bounds.min.y_m, self.cell[1], self.count[1]);
        let at = |x: usize, y: usize| self.below[y * (self.count[0] + 1) + x];
        (1.0 - up) * ((1.0 - right) * at(x, y) + right * at(x + 1, y))
            + up * ((1.0 - right) * at(x, y + 1) + right * at(x + 1, y + 1))
    }

    /// Where a box is cut so that this share of its free area is on the side of lower coordinates (m).
    pub(super) fn cut_m(&self, of: &Bounds, axis: Axis, share: f64) -> f64 {
        let wanted = share * self.area_m2(of);
        let (mut low, mut high) = axis.range(of);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (low + high);
            if self.area_m2(&axis.below(of, middle)) < wanted {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }

    /// The part of a box that holds all that is free in it, with a margin of a cell, because cells are free or not by their
    /// middles.
    #[must_use]
    pub(crate) fn tight(&self, of: &Bounds) -> Bounds {
        let mut tight = *of;
        for (axis, cell_m) in [(Axis::X, self.cell[0]), (Axis::Y, self.cell[1])] {
            let (low, high) = axis.range(&tight);
            let all = self.area_m2(&tight);
            let rounding = 1e-9 * all.max(f64::MIN_POSITIVE);
            let below = |at: f64| self.area_m2(&axis.below(&tight, at));
            let edge = |is_before: &dyn Fn(f64) -> bool| {
                let (mut low, mut high) = (low, high);
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (low + high);
                    if is_before(middle) { low = middle } else { high = middle }
                }
                0.5 * (low + high)
            };
            let first = edge(&|at| below(at) <= rounding);
            let last = edge(&|at| below(at) < all - rounding);
            let (first, last) = ((first - cell_m).max(low), (last + cell_m).min(high));
            if first < last {
                tight = axis.below(&axis.above(&tight, first), last);
            }
        }
        tight
    }

    /// The middles of the free cells in a box, at the height `z_m`.
    pub fn places(&self, of: Bounds, z_m: f64) -> impl Iterator<Item = Position> {
        let middle = move |x: usize, y: usize| {
            let min = self.bounds.min;
            Position::new(min.x_m + (number(x) + 0.5) * self.cell[0], min.y_m + (number(y) + 0.5) * self.cell[1], z_m)
        };
        let row = self.count[0] + 1;
        let is_free = move |x: usize, y: usize| {
            let at = |x: usize, y: usize| self.below[y * row + x];
            at(x + 1, y + 1) - at(x, y + 1) - at(x + 1, y) + at(x, y) > 0.5
        };
        let holds = move |place: &Position| {
            (of.min.x_m..=of.max.x_m).contains(&place.x_m) && (of.min.y_m..=of.max.y_m).contains(&place.y_m)
        };
        (0..self.count[1])
            .flat_map(move |y| (0..self.count[0]).filter(move |&x| is_free(x, y)).map(move |x| middle(x, y)))
            .filter(holds)
    }
}

impl Axis {
    /// The longer axis of a box seen from above.
    pub(super) fn longer(of: &Bounds) -> Self {
        let size = of.max - of.min;
        if size.y_m > size.x_m { Self::Y } else { Self::X }
    }

    fn range(self, of: &Bounds) -> (f64, f64) {
        match self {
            Self::X => (of.min.x_m, of.max.x_m),
            Self::Y => (of.min.y_m, of.max.y_m),
        }
    }

    /// The part of a box below a coordinate.
    pub(super) fn below(self, of: &Bounds, at_m: f64) -> Bounds {
        let max = match self {
            Self::X => Position { x_m: at_m, ..of.max },
            Self::Y => Position { y_m: at_m, ..of.max },
        };
        Bounds { max, ..*of }
    }

    /// The part of a box above a coordinate.
    pub(super) fn above(self, of: &Bounds, at_m: f64) -> Bounds {
        let min = match self {
            Self::X => Position { x_m: at_m, ..of.min },
            Self::Y => Position { y_m: at_m, ..of.min },
        };
        Bounds { min, ..*of }
    }
}
