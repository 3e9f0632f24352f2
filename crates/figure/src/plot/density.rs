//! Many points as cells of colour: how many are in each cell, or the mean of a value over them.

use sextant_channel::Position;

use super::sheet::ColourBar;
use super::view::Views;
use crate::paint::palette::Ramp;
use crate::paint::picture::{Area, Picture, Point};

/// Side of a cell (px).
const CELL: f64 = 4.0;
/// Number of different colours.
const SHADES: f64 = 48.0;

/// When points are drawn as cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Crowding {
    /// Points that are closer than this on average (px) are drawn as cells.
    pub(crate) least_distance: f64,
}

impl Default for Crowding {
    /// Dots of the smallest size, and lines at them, overlap when they are closer.
    fn default() -> Self {
        Self { least_distance: 4.0 }
    }
}

impl Crowding {
    /// Whether so many points in `views` are drawn as cells.
    pub(crate) fn is_crowded(self, count: usize, views: &Views) -> bool {
        count > 1 && views.dot_distance(count) < self.least_distance
    }
}

/// The points in a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Cell {
    /// Number of points.
    pub(crate) count: u32,
    /// Sum of their values.
    pub(crate) sum: f64,
}

impl Cell {
    /// Number of points; `None` if there are none.
    pub(crate) fn points(&self) -> Option<f64> {
        (self.count > 0).then(|| self.count.into())
    }

    /// Mean of the values; `None` without points.
    pub(crate) fn mean(&self) -> Option<f64> {
        (self.count > 0).then(|| self.sum / f64::from(self.count))
    }
}

/// The cells of a plot.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Density {
    columns: usize,
    cells: Vec<Cell>,
}

impl Density {
    /// The cells of each plot of `views`. `points` are places and values.
    pub(crate) fn all(views: &Views, points: impl Iterator<Item = (Position, f64)> + Clone) -> Vec<Self> {
        let areas: Vec<Area> =
            views.sizes().into_iter().map(|(width, height)| Area { left: 0.0, top: 0.0, width, height }).collect();
        let of = |(panel, area): (super::view::Panel, &Area)| {
            let mut density = Self::empty(*area);
            points.clone().for_each(|(place, value)| density.add(panel.at(place), value));
            density
        };
        views.panels(&areas).into_iter().zip(&areas).map(of).collect()
    }

    fn empty(area: Area) -> Self {
        let (columns, rows) = (cell(area.width).max(1), cell(area.height).max(1));
        Self { columns, cells: vec![Cell::default(); columns * rows] }
    }

    /// Adds a point; one outside the plot belongs to the nearest cell.
    fn add(&mut self, at: Point, value: f64) {
        let rows = self.cells.len() / self.columns;
        let (column, row) = (cell(at.x).min(self.columns - 1), cell(at.y).min(rows - 1));
        let cell = &mut self.cells[row * self.columns + column];
        cell.count += 1;
        cell.sum += value;
    }

    /// The cells, row by row.
    pub(crate) fn cells(&self) -> &[Cell] {
        &self.cells
    }

    /// Draws the cells in the plot `area`: one rectangle for each run of cells of equal shade. `value` is the number of a
    /// cell that `bar` has a colour for; a cell without one stays empty.
    pub(crate) fn draw(
        &self,
        picture: &mut Picture,
        area: Area,
        bar: &ColourBar,
        value: impl Fn(&Cell) -> Option<f64>,
    ) {
        let shade = |cell: &Cell| {
            value(cell).map(|value| ((value - bar.low) / (bar.high - bar.low) * SHADES).round().clamp(0.0, SHADES))
        };
        self.draw_runs(
            picture,
            area,
            |cell| shade(cell),
            |picture, area, shade| {
                picture.rectangle(area, bar.ramp.color(shade / SHADES));
            },
        );
    }

    /// Calls `draw` with the rectangle of each run of cells of a row with the same number, but those without a number.
    fn draw_runs(
        &self,
        picture: &mut Picture,
        area: Area,
        number: impl Fn(&Cell) -> Option<f64>,
        draw: impl Fn(&mut Picture, Area, f64),
    ) {
        let mut top = area.top;
        for row in self.cells.chunks(self.columns) {
            let numbers: Vec<Option<f64>> = row.iter().map(&number).collect();
            let bottom = (top + CELL).min(area.bottom());
            let mut left = area.left;
            for run in numbers.chunk_by(|a, b| a == b) {
                let right = left + CELL * run.len() as f64;
                if let Some(number) = run[0] {
                    let width = right.min(area.right()) - left;
                    draw(picture, Area { left, top, width, height: bottom - top }, number);
                }
                left = right;
            }
            top += CELL;
        }
    }

    /// The middle of each cell with points, in the plot `area`.
    pub(crate) fn middles(&self, area: Area) -> impl Iterator<Item = Point> {
        let with_points = self.cells.iter().enumerate().filter(|(_, cell)| cell.count > 0);
        with_points.map(move |(i, _)| {
            let (column, row) = ((i % self.columns) as f64, (i / self.columns) as f64);
            Point::new(area.left + (column + 0.5) * CELL, area.top + (row + 0.5) * CELL)
        })
    }
}

/// Side of a cell in the world (m).
pub(crate) fn cell_m(views: &Views) -> f64 {
    CELL / views.px_per_m()
}

/// The colour bar of `values`, which may be in any order: from 0 to the largest one, or to the 95th percentile if a few are
/// much larger.
pub(crate) fn bar(name: String, mut values: Vec<f64>, finest: f64) -> ColourBar {
    values.sort_unstable_by(f64::total_cmp);
    let max = values.last().copied().unwrap_or(0.0);
    let p95 = values.get(values.len() * 95 / 100).copied().unwrap_or(max);
    let open_end = max > 1.5 * p95 && p95 > 0.0;
    let high = if open_end { p95 } else { max };
    ColourBar { name, low: 0.0, high: high.max(finest.max(1e-3)), open_end, finest, ramp: Ramp::Areas }
}

/// Number of whole cells in a distance (px).
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a plot has a few hundred cells a row")]
fn cell(px: f64) -> usize {
    (px / CELL).max(0.0) as usize
}

#[cfg(test)]
mod tests {
    use super::super::view::{Extent, View};
    use super::*;
    use crate::paint::picture::Mark;

    fn square(side: u32) -> Vec<Position> {
        let site = |i: u32| Position::new(f64::from(i % side), f64::from(i / side), f64::from(i % 3));
        (0..side * side).map(site).collect()
    }

    #[test]
    fn each_point_is_in_one_cell_of_each_plot() {
        let places = square(60);
        let views = Views::new(&Extent::around(places.iter().copied()).unwrap(), &[View::Top, View::Side]);
        let densities = Density::all(&views, places.iter().map(|&place| (place, 0.5)));
        assert_eq!(densities.len(), 2);
        for density in &densities {
            let count: u32 = density.cells().iter().map(|cell| cell.count).sum();
            let sum: f64 = density.cells().iter().map(|cell| cell.sum).sum();
            assert_eq!(count, 3600);
            assert!((sum - 1800.0).abs() < 1e-9);
        }
    }

    #[test]
    fn points_are_crowded_when_they_are_close_to_each_other() {
        let places = square(10);
        let views = Views::new(&Extent::around(places).unwrap(), &[View::Top]);
        let crowding = Crowding::default();
        assert!(!crowding.is_crowded(100, &views) && crowding.is_crowded(1_000_000, &views));
        assert!(!crowding.is_crowded(1, &views));
        assert!(Crowding { least_distance: 1000.0 }.is_crowded(100, &views));
    }

    #[test]
    fn rectangles_cover_the_cells_with_points_and_no_others() {
        let area = Area { left: 10.0, top: 20.0, width: 5.0 * CELL, height: 2.0 * CELL };
        let mut density = Density::empty(area);
        for (x, y) in [(0.1, 0.1), (1.2, 0.5), (1.9, 0.9), (4.5, 1.5)] {
            density.add(Point::new(x * CELL, y * CELL), 1.0);
        }
        let values = density.cells().iter().filter_map(Cell::points).collect();
        let bar = bar("points".to_owned(), values, 1.0);
        let mut picture = Picture::new(100.0, 100.0);
        density.draw(&mut picture, area, &bar, Cell::points);
        let covered: f64 = picture
            .marks
            .iter()
            .map(|mark| match mark {
                Mark::Rectangle { area, .. } => area.width * area.height,
                _ => 0.0,
            })
            .sum();
        assert!((covered - 3.0 * CELL * CELL).abs() < 1e-9, "{covered}");
        assert_eq!(density.middles(area).count(), 3);
    }
}
