//! Axes of a plot: converts values to points of the picture, and draws frame, ticks and numbers.

use super::ticks::Ticks;
use crate::paint::palette::{FAINT_INK, GRID, INK};
use crate::paint::picture::{Anchor, Area, Picture, Point, Stroke, TextStyle, Weight, text_width};

/// Numbers at ticks.
pub(crate) const TICK_TEXT: TextStyle = TextStyle { em: 12.0, weight: Weight::Regular, color: INK };
/// Names of axes and entries of legends.
pub(crate) const LABEL_TEXT: TextStyle = TextStyle { em: 13.0, weight: Weight::Regular, color: INK };
/// Titles.
pub(crate) const TITLE_TEXT: TextStyle = TextStyle { em: 16.0, weight: Weight::Bold, color: INK };
/// Note below a title.
pub(crate) const NOTE_TEXT: TextStyle = TextStyle { em: 13.0, weight: Weight::Regular, color: FAINT_INK };
/// Frames and ticks.
pub(crate) const FRAME: Stroke = Stroke::new(INK, 1.0);
/// Length of a tick (px).
pub(crate) const TICK: f64 = 5.0;
/// Minimum distance of the ticks of an axis (px).
const TICK_DISTANCE: f64 = 62.0;

/// The range of an axis and its name.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    pub(crate) low: f64,
    pub(crate) high: f64,
    pub(crate) name: String,
    pub(crate) shown: Shown,
}

/// Which parts of an axis are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shown {
    /// Ticks, numbers and name.
    All,
    /// Ticks only; a panel below has the numbers.
    Ticks,
}

/// Two axes around an area of the picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axes {
    pub(crate) across: Axis,
    pub(crate) up: Axis,
    pub(crate) area: Area,
}

impl Axes {
    /// The point of the picture for a pair of values.
    pub(crate) fn at(&self, x: f64, y: f64) -> Point {
        let Self { across, up, area } = self;
        Point::new(
            area.left + (x - across.low) / (across.high - across.low) * area.width,
            area.bottom() - (y - up.low) / (up.high - up.low) * area.height,
        )
    }

    /// The ticks of both axes, with equal steps if both axes have the same scale.
    fn ticks(&self) -> (Ticks, Ticks) {
        let Self { across, up, area } = self;
        let most = |length: f64| (length / TICK_DISTANCE).max(1.0);
        let step = |axis: &Axis, length: f64| (axis.high - axis.low) / length;
        let equal = (step(across, area.width) / step(up, area.height) - 1.0).abs() < 1e-6;
        if !equal {
            return (
                Ticks::new(across.low, across.high, most(area.width), 0.0),
                Ticks::new(up.low, up.high, most(area.height), 0.0),
            );
        }
        // A low plot needs finer ticks on its vertical axis.
        let px = step(across, area.width);
        let ticks = |axis: &Axis, distance: f64| Ticks::new(axis.low, axis.high, f64::MAX, px * distance);
        (ticks(across, TICK_DISTANCE), ticks(up, TICK_DISTANCE.min(area.height / 3.5)))
    }

    /// Draws thin lines at the ticks. Call it before the data is drawn.
    pub(crate) fn draw_grid(&self, picture: &mut Picture) {
        let (across, up) = self.ticks();
        let stroke = Stroke::new(GRID, 1.0);
        for x in across.values {
            picture.line(self.at(x, self.up.low), self.at(x, self.up.high), stroke);
        }
        for y in up.values {
            picture.line(self.at(self.across.low, y), self.at(self.across.high, y), stroke);
        }
    }

    /// Draws the frame with its ticks, numbers and names.
    pub(crate) fn draw(&self, picture: &mut Picture) {
        let (across, up) = self.ticks();
        let area = self.area;
        picture.frame(area, FRAME);
        let bottom = area.bottom();
        for &value in &across.values {
            let x = self.at(value, self.up.low).x;
            picture.line(Point::new(x, bottom), Point::new(x, bottom + TICK), FRAME);
            if self.across.shown == Shown::All {
                picture.text(Point::new(x, bottom + TICK + 10.0), &across.label(value), Anchor::Middle, TICK_TEXT);
            }
        }
        let mut widest: f64 = 26.0;
        for &value in &up.values {
            let y = self.at(self.across.low, value).y;
            widest = widest.max(text_width(&up.label(value), TICK_TEXT));
            picture.line(Point::new(area.left, y), Point::new(area.left - TICK, y), FRAME);
            picture.text(Point::new(area.left - TICK - 4.0, y), &up.label(value), Anchor::End, TICK_TEXT);
        }
        if self.across.shown == Shown::All {
            let middle = area.left + area.width / 2.0;
            picture.text(Point::new(middle, bottom + 32.0), &self.across.name, Anchor::Middle, LABEL_TEXT);
        }
        let middle = area.top + area.height / 2.0;
        picture.upward_text(Point::new(area.left - TICK - 4.0 - widest - 14.0, middle), &self.up.name, LABEL_TEXT);
    }
}
