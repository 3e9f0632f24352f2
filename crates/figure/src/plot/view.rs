//! Views of the world from above and from the side, with the same scale in all directions.

use sextant_channel::Position;

use super::axes::{Axes, Axis, Shown};
use crate::paint::picture::{Area, Point};

/// Maximum width of a plot (px).
const WIDEST: f64 = 600.0;
/// Maximum height of all plots together (px).
const HIGHEST: f64 = 760.0;
/// Minimum width and height of a plot (px).
const LEAST: f64 = 100.0;
/// Border between the outermost marks and the frame, as a share of the size of the world.
const BORDER: f64 = 0.03;

/// A direction of sight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum View {
    /// From above: x to the right, y upwards.
    Top,
    /// Along y: x to the right, z upwards.
    Side,
}

impl View {
    /// A position as seen in this view (m).
    pub(crate) fn project(self, place: Position) -> (f64, f64) {
        match self {
            Self::Top => (place.x_m, place.y_m),
            Self::Side => (place.x_m, place.z_m),
        }
    }
}

/// A part of the world.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Extent {
    low: Position,
    high: Position,
}

impl Extent {
    /// The smallest box around `places`; `None` without any.
    pub(crate) fn around(places: impl IntoIterator<Item = Position>) -> Option<Self> {
        let mut places = places.into_iter();
        let first = places.next()?;
        Some(places.fold(Self { low: first, high: first }, |extent, p| Self {
            low: Position::new(extent.low.x_m.min(p.x_m), extent.low.y_m.min(p.y_m), extent.low.z_m.min(p.z_m)),
            high: Position::new(extent.high.x_m.max(p.x_m), extent.high.y_m.max(p.y_m), extent.high.z_m.max(p.z_m)),
        }))
    }

    /// The part enlarged by `by` on each side (m).
    pub(crate) fn widened(&self, by: f64) -> Self {
        let by = Position::new(by, by, by);
        Self { low: self.low - by, high: self.high + by }
    }

    /// Whether it overlaps with `other` in `view`.
    pub(crate) fn is_seen_within(&self, other: &Self, view: View) -> bool {
        let pairs = self.ranges(view).into_iter().zip(other.ranges(view));
        pairs.into_iter().all(|(own, other)| own.0 < other.1 && own.1 > other.0)
    }

    /// Whether it has no height.
    pub(crate) fn is_flat(&self) -> bool {
        self.high.z_m - self.low.z_m < 1e-6
    }

    /// The horizontal and the vertical range in `view` (m).
    fn ranges(&self, view: View) -> [(f64, f64); 2] {
        let (low, high) = (view.project(self.low), view.project(self.high));
        [(low.0, high.0), (low.1, high.1)]
    }
}

/// Plots of one part of the world, before the layout.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Views {
    panels: Vec<(View, [(f64, f64); 2])>,
    px_per_m: f64,
}

/// A plot of the world in the picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    pub(crate) view: View,
    pub(crate) axes: Axes,
}

impl Views {
    /// The `views` of `extent`, one above the other.
    pub(crate) fn new(extent: &Extent, views: &[View]) -> Self {
        let ranges: Vec<_> = views.iter().map(|&view| extent.ranges(view)).collect();
        let length = |range: (f64, f64)| range.1 - range.0;
        let widest = ranges.iter().flatten().map(|&range| length(range)).fold(1.0, f64::max);
        let border = widest * BORDER;
        let with_border = |range: (f64, f64)| (range.0 - border, range.1 + border);
        let ranges: Vec<_> = ranges.into_iter().map(|range| range.map(with_border)).collect();
        let across = ranges.iter().map(|range| length(range[0])).fold(0.0, f64::max);
        let up: f64 = ranges.iter().map(|range| length(range[1])).sum();
        let px_per_m = (WIDEST / across).min(HIGHEST / up);
        let widened = |range: (f64, f64)| {
            let missing = (LEAST / px_per_m - length(range)).max(0.0) / 2.0;
            (range.0 - missing, range.1 + missing)
        };
        let panels = views.iter().copied().zip(ranges.into_iter().map(|range| range.map(widened))).collect();
        Self { panels, px_per_m }
    }

    /// The same plots, larger by `factor`.
    pub(crate) fn enlarged(self, factor: f64) -> Self {
        Self { px_per_m: factor * self.px_per_m, ..self }
    }

    /// Widths and heights (px).
    pub(crate) fn sizes(&self) -> Vec<(f64, f64)> {
        let size = |range: (f64, f64)| (range.1 - range.0) * self.px_per_m;
        self.panels.iter().map(|(_, [across, up])| (size(*across), size(*up))).collect()
    }

    /// The plots in the given areas.
    pub(crate) fn panels(&self, areas: &[Area]) -> Vec<Panel> {
        let count = self.panels.len();
        let mut panels = Vec::new();
        for (&(view, [across, up]), &area) in self.panels.iter().zip(areas) {
            let shown = if panels.len() + 1 < count { Shown::Ticks } else { Shown::All };
            let name = match view {
                View::Top => "y [m]",
                View::Side => "z [m]",
            };
            let across = Axis { low: across.0, high: across.1, name: "x [m]".to_owned(), shown };
            let up = Axis { low: up.0, high: up.1, name: name.to_owned(), shown: Shown::All };
            panels.push(Panel { view, axes: Axes { across, up, area } });
        }
        panels
    }

    /// Mean distance of `count` dots (px).
    pub(crate) fn dot_distance(&self, count: usize) -> f64 {
        let (width, height) = self.sizes().first().copied().unwrap_or((WIDEST, WIDEST));
        (width * height / count.max(1) as f64).sqrt()
    }

    /// A radius (px) for `count` dots that leaves space between them.
    pub(crate) fn dot_radius(&self, count: usize) -> f64 {
        (0.15 * self.dot_distance(count)).clamp(1.2, 3.6)
    }

    /// Pixels per metre.
    pub(crate) fn px_per_m(&self) -> f64 {
        self.px_per_m
    }
}

impl Panel {
    /// Pixels per metre.
    pub(crate) fn px_per_m(&self) -> f64 {
        self.axes.area.width / (self.axes.across.high - self.axes.across.low)
    }

    /// The point of the picture for a position in the world.
    pub(crate) fn at(&self, place: Position) -> Point {
        let (x, y) = self.view.project(place);
        self.axes.at(x, y)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_axes_have_the_same_scale() {
        let corners = [Position::new(-3.0, 2.0, 0.0), Position::new(40.0, 9.0, 6.0)];
        let extent = Extent::around(corners).unwrap();
        let views = Views::new(&extent, &[View::Top, View::Side]);
        let areas: Vec<_> =
            views.sizes().iter().map(|&(width, height)| Area { left: 5.0, top: 7.0, width, height }).collect();
        for panel in views.panels(&areas) {
            let origin = panel.at(Position::ORIGIN);
            let across = panel.at(Position::new(1.0, 0.0, 0.0)).x - origin.x;
            let up = origin.y - panel.at(Position::new(0.0, 1.0, 1.0)).y;
            assert!((across - up).abs() < 1e-9 && across > 0.0, "{across} {up}");
        }
    }

    #[test]
    fn all_positions_are_within_the_frame() {
        for corners in [
            [Position::new(0.0, 0.0, 0.0), Position::new(0.0, 0.0, 0.0)],
            [Position::new(0.0, 0.0, 0.0), Position::new(1000.0, 1.0, 0.0)],
            [Position::new(0.0, -50.0, 0.0), Position::new(1.0, 1000.0, 3.0)],
        ] {
            let views = Views::new(&Extent::around(corners).unwrap(), &[View::Top, View::Side]);
            let area = |&(width, height): &(f64, f64)| Area { left: 0.0, top: 0.0, width, height };
            let areas: Vec<_> = views.sizes().iter().map(area).collect();
            for (panel, area) in views.panels(&areas).iter().zip(&areas) {
                assert!(area.width >= LEAST - 1e-9 && area.height >= LEAST - 1e-9 && area.width <= WIDEST + 1e-9);
                for corner in corners {
                    let Point { x, y } = panel.at(corner);
                    assert!(x > 0.0 && x < area.width && y > 0.0 && y < area.height, "{x} {y} {area:?}");
                }
            }
        }
    }
}
