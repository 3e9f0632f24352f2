//! The layout of a figure: title, plots, colour bar and legend.

use plotters::style::RGBColor;

use super::axes::{FRAME, LABEL_TEXT, NOTE_TEXT, TICK, TICK_TEXT, TITLE_TEXT};
use super::ticks::Ticks;
use crate::paint::palette::Ramp;
use crate::paint::picture::{Anchor, Area, Picture, Point, Stroke, shortened, text_width};

/// Space around everything (px).
const MARGIN: f64 = 14.0;
/// Space left of a plot, for numbers and the name of its axis (px).
const LEFT: f64 = 76.0;
/// Space below the lowest plot, for numbers and the name of its axis (px).
const BELOW: f64 = 46.0;
/// Space between two plots (px).
const BETWEEN: f64 = 18.0;
/// Space right of a plot for a colour bar (px).
const BAR_SPACE: f64 = 88.0;
/// Height of a row of the legend (px).
const ROW: f64 = 22.0;
/// Width of the symbol of an entry of the legend (px).
const SYMBOL: f64 = 26.0;
/// Maximum width of a title (px).
const LONGEST: f64 = 900.0;

/// An entry of the legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    pub(crate) symbol: Symbol,
    pub(crate) text: String,
}

/// The symbol of an entry of the legend.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Symbol {
    Disc { radius: f64, fill: RGBColor },
    RimmedDisc { radius: f64, fill: RGBColor, rim: Stroke },
    Square { side: f64, fill: RGBColor },
    Body { fill: RGBColor, rim: Stroke },
    Line { stroke: Stroke, pattern: &'static [f64] },
    Cross { stroke: Stroke },
    Plus { stroke: Stroke, casing: Stroke },
    Ring { stroke: Stroke, casing: Stroke },
    Circle { radius: f64, stroke: Stroke },
}

/// A colour bar: the numbers of a ramp of colours.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ColourBar {
    pub(crate) name: String,
    pub(crate) low: f64,
    /// The upper end, above `low`.
    pub(crate) high: f64,
    /// Whether there are numbers above `high`; they have its colour.
    pub(crate) open_end: bool,
    /// Minimum step between ticks.
    pub(crate) finest: f64,
    pub(crate) ramp: Ramp,
}

impl ColourBar {
    /// The colour of a number.
    pub(crate) fn color(&self, value: f64) -> RGBColor {
        self.ramp.color((value - self.low) / (self.high - self.low))
    }
}

/// The parts of a figure around the plots.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sheet {
    pub(crate) title: String,
    pub(crate) note: String,
    pub(crate) bar: Option<ColourBar>,
    pub(crate) legend: Vec<Entry>,
}

impl Sheet {
    /// Lays out plots of the given widths and heights (px), one above the other. Returns the picture and their areas.
    pub(crate) fn lay_out(&self, plots: &[(f64, f64)]) -> (Picture, Vec<Area>) {
        let title = shortened(&self.title, LONGEST, TITLE_TEXT);
        let note = shortened(&self.note, LONGEST, NOTE_TEXT);
        let plot_width = plots.iter().map(|plot| plot.0).fold(0.0, f64::max);
        let right = if self.bar.is_some() { BAR_SPACE } else { 10.0 };
        let widest = [LEFT + plot_width + right, text_width(&title, TITLE_TEXT), text_width(&note, NOTE_TEXT)];
        let width = 2.0 * MARGIN + widest.into_iter().fold(300.0, f64::max);
        let left = MARGIN + LEFT + (width - 2.0 * MARGIN - LEFT - plot_width - right) / 2.0;
        let mut y = MARGIN + 44.0;
        let mut areas = Vec::new();
        for &(width, height) in plots {
            areas.push(Area { left, top: y, width, height });
            y += height + BETWEEN;
        }
        y += BELOW - BETWEEN;
        let rows = self.rows(width - 2.0 * MARGIN);
        let height = y + rows.len() as f64 * ROW + MARGIN;
        let mut picture = Picture::new(width, height);
        picture.text(Point::new(MARGIN, MARGIN + 9.0), &title, Anchor::Start, TITLE_TEXT);
        picture.text(Point::new(MARGIN, MARGIN + 29.0), &note, Anchor::Start, NOTE_TEXT);
        if let (Some(bar), Some(area)) = (&self.bar, areas.first()) {
            bar.draw(&mut picture, *area);
        }
        for row in rows {
            y += ROW;
            for (x, entry) in row {
                let at = Point::new(MARGIN + x, y - ROW / 2.0);
                entry.symbol.draw(&mut picture, Point::new(at.x + SYMBOL / 2.0 - 3.0, at.y));
                picture.text(Point::new(at.x + SYMBOL, at.y), &entry.text, Anchor::Start, LABEL_TEXT);
            }
        }
        (picture, areas)
    }

    /// The legend in rows of at most `width` (px); each entry with its horizontal position.
    fn rows(&self, width: f64) -> Vec<Vec<(f64, Entry)>> {
        const GAP: f64 = 20.0;
        let mut rows: Vec<Vec<(f64, Entry)>> = Vec::new();
        let mut x = f64::INFINITY;
        for entry in &self.legend {
            let text = shortened(&entry.text, width - SYMBOL, LABEL_TEXT);
            let own = SYMBOL + text_width(&text, LABEL_TEXT);
            if x + own > width {
                rows.push(Vec::new());
                x = 0.0;
            }
            if let Some(row) = rows.last_mut() {
                row.push((x, Entry { symbol: entry.symbol, text }));
            }
            x += own + GAP;
        }
        rows
    }
}

impl Symbol {
    fn draw(self, picture: &mut Picture, at: Point) {
        match self {
            Self::Disc { radius, fill } => picture.disc(at, radius, fill),
            Self::RimmedDisc { radius, fill, rim } => {
                picture.disc(at, radius, fill);
                picture.ring(at, radius, rim);
            }
            Self::Square { side, fill } => picture.square(at, side, fill),
            Self::Body { fill, rim } => {
                let area = Area { left: at.x - 8.0, top: at.y - 6.0, width: 16.0, height: 12.0 };
                picture.rectangle(area, fill);
                picture.frame(area, rim);
            }
            Self::Line { stroke, pattern } => {
                let ends = [Point::new(at.x - 10.0, at.y), Point::new(at.x + 10.0, at.y)];
                picture.dashed(&ends, pattern, stroke);
            }
            Self::Cross { stroke } => picture.cross(at, 3.5, stroke),
            Self::Plus { stroke, casing } => {
                picture.plus(at, 7.0 + (casing.width - stroke.width) / 2.0, casing);
                picture.plus(at, 7.0, stroke);
            }
            Self::Circle { radius, stroke } => picture.ring(at, radius - stroke.width / 2.0, stroke),
            Self::Ring { stroke, casing } => {
                picture.ring(at, 6.5, casing);
                picture.ring(at, 6.5, stroke);
            }
        }
    }
}

impl ColourBar {
    /// Draws the bar to the right of the plot in `beside`.
    fn draw(&self, picture: &mut Picture, beside: Area) {
        const STEPS: u8 = 100;
        let height = beside.height.clamp(110.0, 420.0);
        let area = Area { left: beside.right() + 18.0, top: beside.top, width: 14.0, height };
        let step = height / f64::from(STEPS);
        for i in 0..STEPS {
            let share = (f64::from(i) + 0.5) / f64::from(STEPS);
            let top = area.bottom() - f64::from(i + 1) * step;
            // The step is slightly larger, so that no gap is visible to the one before it.
            picture.rectangle(Area { top, height: step + 0.5, ..area }, self.ramp.color(share));
        }
        picture.frame(area, FRAME);
        let ticks = Ticks::new(self.low, self.high, height / 48.0, self.finest);
        let mut widest: f64 = 0.0;
        let place = |value: f64| area.bottom() - (value - self.low) / (self.high - self.low) * height;
        let mut numbers: Vec<_> = ticks.values.iter().map(|&value| (place(value), ticks.label(value))).collect();
        if self.open_end {
            numbers.retain(|(y, _)| *y > area.top + 16.0);
            numbers.push((area.top, format!("\u{2265} {}", ticks.label(self.high))));
        }
        for (y, text) in numbers {
            picture.line(Point::new(area.right(), y), Point::new(area.right() + TICK, y), FRAME);
            picture.text(Point::new(area.right() + TICK + 4.0, y), &text, Anchor::Start, TICK_TEXT);
            widest = widest.max(text_width(&text, TICK_TEXT));
        }
        let x = (area.right() + TICK + 4.0 + widest + 14.0).min(beside.right() + BAR_SPACE);
        picture.upward_text(Point::new(x, area.top + height / 2.0), &self.name, LABEL_TEXT);
    }
}
