//! Finding the points near a place.

use crate::geometry::cell_grid::CellGrid;
use crate::geometry::position::Position;

/// Points sorted into cubic cells. The points of a cell are adjacent in memory.
#[derive(Debug)]
pub struct CellIndex {
    grid: CellGrid,
    first: Vec<usize>,
    points: Vec<(Position, u32)>,
}

impl CellIndex {
    /// The index of `points` in cells about `cell_m` wide. Cells are wider if a few points lie in a large space, so
    /// that there are at most a few times as many cells as points.
    ///
    /// # Panics
    /// If `cell_m` is not positive.
    #[must_use]
    pub fn new(points: &[Position], cell_m: f64) -> Self {
        let grid = CellGrid::covering(points.iter().copied(), cell_m);
        let mut first = vec![0; grid.cell_count() + 1];
        let cells: Vec<usize> = points.iter().map(|&point| grid.cell(grid.layers_of(point))).collect();
        for &cell in &cells {
            first[cell + 1] += 1;
        }
        for cell in 1..first.len() {
            first[cell] += first[cell - 1];
        }
        let mut next = first.clone();
        let mut sorted = vec![(Position::ORIGIN, 0); points.len()];
        for (id, (&point, &cell)) in (0..).zip(points.iter().zip(&cells)) {
            sorted[next[cell]] = (point, id);
            next[cell] += 1;
        }
        Self { grid, first, points: sorted }
    }

    /// The points in the cells that touch the box from `low` to `high`, in slices: a superset of those in the
    /// box, in a fixed order.
    #[inline]
    pub fn near_box(&self, low: [f64; 3], high: [f64; 3]) -> impl Iterator<Item = &[(Position, u32)]> {
        let [x0, y0, z0] = self.grid.layers_of(low.into());
        let [x1, y1, z1] = self.grid.layers_of(high.into());
        (z0..=z1)
            .flat_map(move |z| (y0..=y1).map(move |y| self.grid.cell([0, y, z])))
            .map(move |row| &self.points[self.first[row + x0]..self.first[row + x1 + 1]])
    }

    /// Number of points in the cells that touch the box from `low` to `high`.
    pub fn count_near_box(&self, low: [f64; 3], high: [f64; 3]) -> usize {
        self.near_box(low, high).map(<[_]>::len).sum()
    }

    /// Calls `found` with each point within `radius_m` of `place`, itself included.
    pub fn within(&self, place: Position, radius_m: f64, mut found: impl FnMut(u32)) {
        let reach = Position::new(radius_m, radius_m, radius_m);
        for &(point, id) in self.near_box((place - reach).into(), (place + reach).into()).flatten() {
            let apart = point - place;
            if apart.dot(apart) <= radius_m * radius_m {
                found(id);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_kernel::{Purpose, Seed};

    #[test]
    fn the_points_within_a_radius_are_those_of_a_full_scan() {
        let draw = |i: u64, axis| 20.0 * Seed(3).uniform(Purpose::new(8), [i, axis, 0]) - 10.0;
        let points: Vec<Position> = (0..300).map(|i| Position::new(draw(i, 0), draw(i, 1), draw(i, 2))).collect();
        for cell_m in [0.01, 1.0, 3.0, 100.0] {
            let index = CellIndex::new(&points, cell_m);
            for (i, &place) in points.iter().enumerate().step_by(17) {
                for radius_m in [0.0, 2.5, 7.0, 60.0] {
                    let mut found = Vec::new();
                    index.within(place, radius_m, |id| found.push(id as usize));
                    found.sort_unstable();
                    let scan = |&j: &usize| points[j].distance_m(points[i]) <= radius_m;
                    let expected: Vec<usize> = (0..points.len()).filter(scan).collect();
                    assert_eq!(found, expected, "cells of {cell_m} m, radius {radius_m} m, point {i}");
                }
            }
        }
    }

    #[test]
    fn an_index_may_have_no_points_or_coinciding_points() {
        let none = CellIndex::new(&[], 1.0);
        none.within(Position::ORIGIN, 5.0, |_| panic!("there is nothing to find"));
        let same = CellIndex::new(&[Position::ORIGIN; 5], 1.0);
        let mut count = 0;
        same.within(Position::ORIGIN, 0.0, |_| count += 1);
        assert_eq!(count, 5);
    }
}
