//! The map of obstacles: a plane of upright cells that absorb.

pub(crate) mod claims;

use sextant_channel::Position;

use crate::survey_frame::SurveyFrame;
use claims::NEGLIGIBLE;
pub use claims::ObstacleClaim;

/// Absorption estimated from receptions, in upright cells. Its unit is standard deviations of the shadowing per
/// metre, because signal strengths are not used, only how often packets are lost.
#[derive(Clone, Debug, PartialEq)]
pub struct AbsorptionMap {
    low: [f64; 2],
    cell_m: f64,
    counts: [usize; 2],
    /// Loss in each cell of a line as long as the cell is wide (standard deviations).
    pub(crate) cells: Vec<f64>,
    /// Number of absorbing cells below and left of a corner.
    absorbing: Vec<u32>,
    /// The obstacles that the log is evidence of.
    pub(crate) claims: Vec<ObstacleClaim>,
}

impl AbsorptionMap {
    /// Empty cells about `cell_m` wide from `low` to `high`; wider if there would be more than `most` cells.
    pub(crate) fn new(low: [f64; 2], high: [f64; 2], cell_m: f64, most: f64) -> Self {
        let size = [high[0] - low[0], high[1] - low[1]];
        let cell_m = cell_m.max((size[0] * size[1] / most).sqrt());
        let counts = size.map(|size| crate::numerics::whole(size / cell_m) + 1);
        let [columns, rows] = counts;
        let absorbing = vec![0; (columns + 1) * (rows + 1)];
        Self { low, cell_m, counts, cells: vec![0.0; columns * rows], absorbing, claims: Vec::new() }
    }

    /// The same in the axes of the log, if it was made in `frame`: cells as wide, each with what absorbs at its middle.
    pub(crate) fn of_log(&self, frame: &SurveyFrame) -> Self {
        let ends = [0, 1].map(|axis| [self.low[axis], self.low[axis] + self.cell_m * self.counts[axis] as f64]);
        let corner = |k: usize| frame.place(Position::new(ends[0][k % 2], ends[1][k / 2], 0.0));
        let along = |pick: fn(f64, f64) -> f64| {
            let corners = (0..4).map(corner).map(|corner| [corner.x_m, corner.y_m]);
            corners.reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])]).unwrap_or_default()
        };
        let mut of_log = Self::new(along(f64::min), along(f64::max), self.cell_m, f64::INFINITY);
        let mut claim_of = vec![None; self.cells.len()];
        for (number, claim) in self.claims.iter().enumerate() {
            claim.cells.iter().for_each(|&[i, j]| claim_of[j * self.counts[0] + i] = Some(number));
        }
        let mut claims: Vec<ObstacleClaim> =
            self.claims.iter().map(|claim| ObstacleClaim { cells: Vec::new(), ..claim.clone() }).collect();
        let [columns, rows] = of_log.counts;
        for [i, j] in (0..rows).flat_map(|j| (0..columns).map(move |i| [i, j])) {
            if let Some(cell) = self.cell(frame.in_survey(of_log.centre([i, j]))) {
                of_log.cells[j * columns + i] = self.cells[cell];
                claim_of[cell].iter().for_each(|&number: &usize| claims[number].cells.push([i, j]));
            }
        }
        of_log.claims = claims;
        of_log.count();
        of_log
    }

    /// Width of a cell (m).
    #[must_use]
    pub fn cell_m(&self) -> f64 {
        self.cell_m
    }

    /// Number of cells along x and y.
    #[must_use]
    pub fn counts(&self) -> [usize; 2] {
        self.counts
    }

    /// Centre of the cell in column `i` and row `j`, at height 0 (m).
    #[must_use]
    pub fn centre(&self, [i, j]: [usize; 2]) -> Position {
        let [x, y] =
            [(0, i), (1, j)].map(|(axis, index): (usize, usize)| self.low[axis] + self.cell_m * (index as f64 + 0.5));
        Position::new(x, y, 0.0)
    }

    /// Absorption in the cell in column `i` and row `j` (standard deviations of the shadowing per metre).
    ///
    /// # Panics
    /// If there is no such cell.
    #[must_use]
    pub fn absorption_per_m(&self, [i, j]: [usize; 2]) -> f64 {
        self.cells[j * self.counts[0] + i] / self.cell_m
    }

    /// The obstacles that the log is evidence of: regions of cells whose absorption is clearly above zero and that are crossed
    /// in several directions. Cells that absorb beside them make the map better, but are no evidence of an obstacle there.
    #[must_use]
    pub fn claims(&self) -> &[ObstacleClaim] {
        &self.claims
    }

    /// These obstacles, each with whether the log is sure of it, as rectangles: least x, least y, largest x, largest y (m).
    /// There is one rectangle for each run of cells along x.
    pub fn claims_m(&self) -> impl Iterator<Item = (bool, Vec<[f64; 4]>)> {
        let half_m = 0.5 * self.cell_m;
        let rectangle = move |run: &[[usize; 2]]| {
            let (low, high) = (self.centre(*run.first()?), self.centre(*run.last()?));
            Some([low.x_m - half_m, low.y_m - half_m, high.x_m + half_m, high.y_m + half_m])
        };
        self.claims.iter().map(move |claim| {
            let runs = claim.cells.chunk_by(|a, b| a[1] == b[1] && a[0] + 1 == b[0]);
            (claim.is_sure, runs.filter_map(rectangle).collect())
        })
    }

    /// Area of the obstacles of which the log is sure (m²).
    #[must_use]
    pub fn sure_m2(&self) -> f64 {
        self.claims.iter().filter(|claim| claim.is_sure).map(|claim| claim.area_m2).sum()
    }

    /// Area of the obstacles of which the log is not sure (m²).
    #[must_use]
    pub(crate) fn unsure_m2(&self) -> f64 {
        self.claims.iter().filter(|claim| !claim.is_sure).map(|claim| claim.area_m2).sum()
    }

    /// The loss of the straight line between two places (standard deviations of the shadowing).
    #[must_use]
    pub fn absorbed(&self, from: Position, to: Position) -> f64 {
        self.absorbed_level(from, to) * slant(to - from)
    }

    /// The loss of the projection of the line on the plane.
    pub(crate) fn absorbed_level(&self, from: Position, to: Position) -> f64 {
        let mut sum = 0.0;
        self.crossings(from, to, |cell, enter, leave| sum += self.cells[cell] * (leave - enter));
        sum
    }

    /// Calls `visit` with each cell that the projection of the line on the plane crosses, in order, and where along
    /// the projection the line enters and leaves the cell, in widths of a cell.
    pub(crate) fn crossings(&self, from: Position, to: Position, mut visit: impl FnMut(usize, f64, f64)) {
        let per_m = 1.0 / self.cell_m;
        let start = [(from.x_m - self.low[0]) * per_m, (from.y_m - self.low[1]) * per_m];
        let way = [(to.x_m - from.x_m) * per_m, (to.y_m - from.y_m) * per_m];
        let length = (way[0] * way[0] + way[1] * way[1]).sqrt();
        if length < 1e-9 {
            return;
        }
        let (mut enter, mut leave) = (0.0_f64, length);
        let direction = way.map(|way| way / length);
        for axis in 0..2 {
            let end = self.counts[axis] as f64;
            if direction[axis].abs() < 1e-12 {
                if !(start[axis] >= 0.0 && start[axis] < end) {
                    return;
                }
            } else {
                let to_low = -start[axis] / direction[axis];
                let to_high = (end - start[axis]) / direction[axis];
                enter = enter.max(to_low.min(to_high));
                leave = leave.min(to_low.max(to_high));
            }
        }
        if enter >= leave {
            return;
        }
        let mut cell = [0; 2];
        let mut next = [f64::INFINITY; 2];
        let mut span = [f64::INFINITY; 2];
        for axis in 0..2 {
            cell[axis] = crate::numerics::whole(start[axis] + direction[axis] * enter).min(self.counts[axis] - 1);
            if direction[axis].abs() >= 1e-12 {
                let border = cell[axis] as f64 + f64::from(u8::from(direction[axis] > 0.0));
                next[axis] = (border - start[axis]) / direction[axis];
                span[axis] = 1.0 / direction[axis].abs();
            }
        }
        let mut here = enter;
        while here < leave {
            let axis = usize::from(next[1] < next[0]);
            let until = next[axis].min(leave);
            if until > here {
                visit(cell[1] * self.counts[0] + cell[0], here, until);
                here = until;
            }
            next[axis] += span[axis];
            let moved = if direction[axis] > 0.0 { cell[axis].checked_add(1) } else { cell[axis].checked_sub(1) };
            match moved.filter(|&moved| moved < self.counts[axis]) {
                Some(moved) => cell[axis] = moved,
                None => return,
            }
        }
    }

    /// The cell that holds `place`.
    pub(crate) fn cell(&self, place: Position) -> Option<usize> {
        let [x, y] = [place.x_m - self.low[0], place.y_m - self.low[1]].map(|along| along / self.cell_m);
        let (i, j) = (crate::numerics::whole(x), crate::numerics::whole(y));
        (x >= 0.0 && y >= 0.0 && i < self.counts[0] && j < self.counts[1]).then(|| j * self.counts[0] + i)
    }

    /// Whether no cell absorbs.
    #[must_use]
    pub fn is_clear(&self) -> bool {
        self.absorbing.last().is_none_or(|&absorbing| absorbing == 0)
    }

    /// Whether nothing absorbs in the cells that a box touches, as of the last [`count`](Self::count).
    pub(crate) fn is_clear_within(&self, low: [f64; 2], high: [f64; 2]) -> bool {
        let mut from = [0; 2];
        let mut to = [0; 2];
        for axis in 0..2 {
            let along = |value: f64| (value - self.low[axis]) / self.cell_m;
            if along(high[axis]) < 0.0 {
                return true;
            }
            from[axis] = crate::numerics::whole(along(low[axis])).min(self.counts[axis]);
            to[axis] = (crate::numerics::whole(along(high[axis])) + 1).min(self.counts[axis]);
        }
        let width = self.counts[0] + 1;
        let corner = |i: usize, j: usize| self.absorbing[j * width + i];
        corner(to[0], to[1]) + corner(from[0], from[1]) == corner(from[0], to[1]) + corner(to[0], from[1])
    }

    /// Counts the cells that absorb.
    pub(crate) fn count(&mut self) {
        let [columns, rows] = self.counts;
        for j in 0..rows {
            let mut row = 0;
            for i in 0..columns {
                row += u32::from(self.cells[j * columns + i] > NEGLIGIBLE);
                self.absorbing[(j + 1) * (columns + 1) + i + 1] = self.absorbing[j * (columns + 1) + i + 1] + row;
            }
        }
    }
}

/// Length of a line divided by that of its projection on the plane; 1 for an upright line.
pub(crate) fn slant(way: Position) -> f64 {
    let level = (way.x_m * way.x_m + way.y_m * way.y_m).sqrt();
    if level > 1e-9 { way.length_m() / level } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map() -> AbsorptionMap {
        AbsorptionMap::new([-1.0, 0.0], [2.9, 2.9], 0.5, 1e4)
    }

    #[test]
    fn a_line_is_cut_into_the_lengths_that_a_fine_walk_finds() {
        let map = map();
        let places = [[-3.0, -1.0], [0.3, 1.1], [2.2, 0.2], [5.0, 4.0], [0.3, 9.0], [-0.5, 1.0], [2.5, 1.0]];
        for from in places {
            for to in places {
                let (from, to) = (Position::new(from[0], from[1], 0.0), Position::new(to[0], to[1], 0.0));
                let mut lengths = vec![0.0; map.cells.len()];
                map.crossings(from, to, |cell, enter, leave| lengths[cell] += leave - enter);
                let steps = 20_000;
                let piece = from.distance_m(to) / f64::from(steps) / map.cell_m;
                for i in 0..steps {
                    let place = from + (to - from) * ((f64::from(i) + 0.5) / f64::from(steps));
                    if let Some(cell) = map.cell(place) {
                        lengths[cell] -= piece;
                    }
                }
                let worst = lengths.iter().fold(0.0, |worst: f64, length| worst.max(length.abs()));
                // A line along a border may count for either side.
                assert!(worst < 3.0 * piece.max(1e-9), "{from:?} to {to:?}: {worst}");
            }
        }
    }

    #[test]
    fn boxes_without_absorbing_cells_are_clear() {
        let mut map = map();
        assert!(map.is_clear());
        let cell = map.cell(Position::new(0.7, 1.2, 0.0)).unwrap();
        map.cells[cell] = 1.0;
        map.count();
        assert!(!map.is_clear() && !map.is_clear_within([0.6, 1.1], [0.6, 1.1]));
        assert!(!map.is_clear_within([-9.0, -9.0], [9.0, 9.0]));
        for (low, high) in [([-9.0, -9.0], [0.4, 9.0]), ([1.1, -9.0], [9.0, 9.0]), ([-9.0, 1.6], [9.0, 9.0])] {
            assert!(map.is_clear_within(low, high));
        }
        let through = map.absorbed(Position::new(0.7, -1.0, 0.0), Position::new(0.7, 5.0, 0.0));
        assert!((through - 1.0).abs() < 1e-12);
        let climbing = map.absorbed(Position::new(0.7, 0.0, 0.0), Position::new(0.7, 3.0, 4.0));
        assert!((climbing - 5.0 / 3.0).abs() < 1e-12);
    }
}
