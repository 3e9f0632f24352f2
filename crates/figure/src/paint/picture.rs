//! A picture as a list of marks, in pixels of 1/96 inch from the upper left corner. Later marks cover earlier ones.

use std::sync::Once;

use plotters::style::{FontDesc, FontFamily, FontStyle, RGBColor, register_font};

/// How far the sides of a ring are from the circle at most (px).
const RING_SAG: f64 = 0.05;

/// A point of the picture (px); y points down.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Point {
    pub(crate) x: f64,
    pub(crate) y: f64,
}

impl Point {
    pub(crate) const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    fn toward(self, other: Self, share: f64) -> Self {
        Self::new(self.x + (other.x - self.x) * share, self.y + (other.y - self.y) * share)
    }

    pub(crate) fn distance(self, other: Self) -> f64 {
        libm::hypot(other.x - self.x, other.y - self.y)
    }
}

/// A rectangle (px).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Area {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Area {
    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) color: RGBColor,
    /// Width (px).
    pub(crate) width: f64,
}

impl Stroke {
    pub(crate) const fn new(color: RGBColor, width: f64) -> Self {
        Self { color, width }
    }
}

/// Which part of a text is at its point. Vertically it is always the middle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// The style of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TextStyle {
    /// Height of an em (px).
    pub(crate) em: f64,
    pub(crate) weight: Weight,
    pub(crate) color: RGBColor,
}

/// The weight of a font.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Weight {
    Regular,
    Bold,
}

/// The direction of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Run {
    Across,
    Upwards,
}

/// An element of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Mark {
    Path { points: Vec<Point>, stroke: Stroke },
    Polygon { points: Vec<Point>, fill: RGBColor },
    Rectangle { area: Area, fill: RGBColor },
    Disc { center: Point, radius: f64, fill: RGBColor },
    Text { at: Point, text: String, style: TextStyle, anchor: Anchor, run: Run },
}

/// A picture: its size and its marks.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Picture {
    /// Width (px).
    pub(crate) width: f64,
    /// Height (px).
    pub(crate) height: f64,
    pub(crate) marks: Vec<Mark>,
}

impl Picture {
    /// An empty picture.
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { width: width.ceil(), height: height.ceil(), marks: Vec::new() }
    }

    pub(crate) fn path(&mut self, points: Vec<Point>, stroke: Stroke) {
        if points.len() > 1 {
            self.marks.push(Mark::Path { points, stroke });
        }
    }

    pub(crate) fn line(&mut self, from: Point, to: Point, stroke: Stroke) {
        self.path(vec![from, to], stroke);
    }

    /// Draws the part of a path that is within `area`.
    pub(crate) fn path_within(&mut self, area: Area, points: &[Point], stroke: Stroke) {
        for pair in points.windows(2) {
            if let Some([from, to]) = clipped(area, [pair[0], pair[1]]) {
                self.line(from, to, stroke);
            }
        }
    }

    /// Draws a path as dashes; `pattern` are the lengths of dashes and gaps in turn (px). Without a pattern the line is
    /// solid.
    pub(crate) fn dashed(&mut self, points: &[Point], pattern: &[f64], stroke: Stroke) {
        if pattern.is_empty() {
            self.path(points.to_vec(), stroke);
            return;
        }
        for dash in dashes(points, pattern) {
            self.path(dash, stroke);
        }
    }

    pub(crate) fn polygon(&mut self, points: Vec<Point>, fill: RGBColor) {
        if points.len() > 2 {
            self.marks.push(Mark::Polygon { points, fill });
        }
    }

    pub(crate) fn rectangle(&mut self, area: Area, fill: RGBColor) {
        self.marks.push(Mark::Rectangle { area, fill });
    }

    /// Draws the outline of a rectangle.
    pub(crate) fn frame(&mut self, area: Area, stroke: Stroke) {
        let (l, t, r, b) = (area.left, area.top, area.right(), area.bottom());
        let corners = [(l, t), (r, t), (r, b), (l, b), (l, t), (r, t)];
        self.path(corners.map(|(x, y)| Point::new(x, y)).into(), stroke);
    }

    /// Draws a square around `center` with the given side (px).
    pub(crate) fn square(&mut self, center: Point, side: f64, fill: RGBColor) {
        let half = side / 2.0;
        self.rectangle(Area { left: center.x - half, top: center.y - half, width: side, height: side }, fill);
    }

    pub(crate) fn disc(&mut self, center: Point, radius: f64, fill: RGBColor) {
        self.marks.push(Mark::Disc { center, radius, fill });
    }

    /// Draws a circle as a polygon whose sides are nowhere more than [`RING_SAG`] from it.
    pub(crate) fn ring(&mut self, center: Point, radius: f64, stroke: Stroke) {
        let half_side_rad = libm::acos((1.0 - RING_SAG / radius).max(0.0));
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a small number of sides")]
        let sides = libm::ceil(std::f64::consts::PI / half_side_rad).clamp(8.0, 250.0) as u8;
        let at = |i: u8| {
            let (sin, cos) = libm::sincos(f64::from(i) * std::f64::consts::TAU / f64::from(sides));
            Point::new(center.x + radius * cos, center.y + radius * sin)
        };
        // The last side covers the first one, so that no gap is visible.
        self.path((0..=sides + 1).map(at).collect(), stroke);
    }

    /// Draws an upright cross with arms of length `arm` (px).
    pub(crate) fn plus(&mut self, center: Point, arm: f64, stroke: Stroke) {
        let Point { x, y } = center;
        self.line(Point::new(x - arm, y), Point::new(x + arm, y), stroke);
        self.line(Point::new(x, y - arm), Point::new(x, y + arm), stroke);
    }

    /// Draws a diagonal cross that reaches `arm` to each side (px).
    pub(crate) fn cross(&mut self, center: Point, arm: f64, stroke: Stroke) {
        let Point { x, y } = center;
        self.line(Point::new(x - arm, y - arm), Point::new(x + arm, y + arm), stroke);
        self.line(Point::new(x - arm, y + arm), Point::new(x + arm, y - arm), stroke);
    }

    /// Draws a horizontal text.
    pub(crate) fn text(&mut self, at: Point, text: &str, anchor: Anchor, style: TextStyle) {
        self.marks.push(Mark::Text { at, text: text.to_owned(), style, anchor, run: Run::Across });
    }

    /// Draws a vertical text with its middle at `at`.
    pub(crate) fn upward_text(&mut self, at: Point, text: &str, style: TextStyle) {
        let text = text.to_owned();
        self.marks.push(Mark::Text { at, text, style, anchor: Anchor::Middle, run: Run::Upwards });
    }
}

/// The part of a line that is within `area` (Liang and Barsky, 1984).
fn clipped(area: Area, [from, to]: [Point; 2]) -> Option<[Point; 2]> {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for (start, change, low, high) in
        [(from.x, to.x - from.x, area.left, area.right()), (from.y, to.y - from.y, area.top, area.bottom())]
    {
        if change.abs() < 1e-12 {
            if start < low || start > high {
                return None;
            }
            continue;
        }
        let (a, b) = ((low - start) / change, (high - start) / change);
        enter = enter.max(a.min(b));
        leave = leave.min(a.max(b));
    }
    (enter < leave).then(|| [from.toward(to, enter), from.toward(to, leave)])
}

/// The dashes of a path; `pattern` are the lengths of dashes and gaps in turn (px).
fn dashes(points: &[Point], pattern: &[f64]) -> Vec<Vec<Point>> {
    let mut pieces = Vec::new();
    let (mut step, mut left) = (0, pattern[0]);
    let mut piece: Vec<Point> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        while from.distance(to) > left {
            from = from.toward(to, left / from.distance(to));
            if step % 2 == 0 {
                piece.push(from);
                pieces.push(std::mem::take(&mut piece));
            } else {
                piece = vec![from];
            }
            step = (step + 1) % pattern.len();
            left = pattern[step].max(0.1);
        }
        left -= from.distance(to);
        if step % 2 == 0 {
            piece.push(to);
        }
    }
    if step % 2 == 0 {
        pieces.push(piece);
    }
    pieces
}

/// The font of all text. Its embedded copy is used for widths and for PNG files; an SVG viewer uses its own font.
pub(crate) fn font(style: TextStyle, scale: f64) -> FontDesc<'static> {
    static REGISTERED: Once = Once::new();
    REGISTERED.call_once(|| {
        let fonts = [(FontStyle::Normal, dejavu::sans::regular()), (FontStyle::Bold, dejavu::sans::bold())];
        for (style, font) in fonts {
            assert!(register_font("sans-serif", style, font).is_ok(), "the embedded font is valid");
        }
    });
    // In plotters the size of a font is the height of a line, 1.24 em.
    let face = match style.weight {
        Weight::Regular => FontStyle::Normal,
        Weight::Bold => FontStyle::Bold,
    };
    FontDesc::new(FontFamily::SansSerif, style.em * 1.24 * scale, face)
}

/// Width of a text (px).
pub(crate) fn text_width(text: &str, style: TextStyle) -> f64 {
    const FINE: f64 = 16.0;
    let width = font(style, FINE).layout_box(text).map_or(0, |((left, _), (right, _))| right - left);
    f64::from(width) / FINE
}

/// `text` shortened to at most `width` (px), with an ellipsis if it was cut.
pub(crate) fn shortened(text: &str, width: f64, style: TextStyle) -> String {
    if text_width(text, style) <= width {
        return text.to_owned();
    }
    let mut short = String::new();
    for letter in text.chars() {
        short.push(letter);
        if text_width(&format!("{short}…"), style) > width {
            short.pop();
            break;
        }
    }
    short + "…"
}

#[cfg(test)]
mod tests {
    use super::*;

    const STYLE: TextStyle = TextStyle { em: 12.0, weight: Weight::Regular, color: RGBColor(0, 0, 0) };

    #[test]
    fn dashes_continue_around_corners() {
        let corner = [Point::new(0.0, 0.0), Point::new(3.0, 0.0), Point::new(3.0, 4.0)];
        let pieces = dashes(&corner, &[4.0, 2.0]);
        assert_eq!(pieces[0], [Point::new(0.0, 0.0), Point::new(3.0, 0.0), Point::new(3.0, 1.0)]);
        assert_eq!(pieces[1], [Point::new(3.0, 3.0), Point::new(3.0, 4.0)]);
        assert_eq!(pieces.len(), 2);
    }

    #[test]
    fn a_line_is_clipped_to_an_area() {
        let area = Area { left: 0.0, top: 0.0, width: 10.0, height: 4.0 };
        let line = |a: (f64, f64), b: (f64, f64)| clipped(area, [Point::new(a.0, a.1), Point::new(b.0, b.1)]);
        assert_eq!(line((-5.0, 2.0), (15.0, 2.0)), Some([Point::new(0.0, 2.0), Point::new(10.0, 2.0)]));
        assert_eq!(line((5.0, 2.0), (5.0, 8.0)), Some([Point::new(5.0, 2.0), Point::new(5.0, 4.0)]));
        assert_eq!(line((1.0, 1.0), (2.0, 3.0)), Some([Point::new(1.0, 1.0), Point::new(2.0, 3.0)]));
        assert_eq!(line((-5.0, -2.0), (15.0, -2.0)), None);
        assert_eq!(line((-4.0, 2.0), (2.0, -4.0)), None);
    }

    #[test]
    fn a_long_text_is_shortened_to_the_width() {
        let long = "a name that nobody should give to a scenario ".repeat(50);
        let short = shortened(&long, 200.0, STYLE);
        assert!(short.ends_with('…') && text_width(&short, STYLE) <= 200.0 && short.len() > 15, "{short}");
        assert_eq!(shortened("short", 200.0, STYLE), "short");
    }

    #[test]
    fn bold_text_is_wider() {
        let bold = TextStyle { weight: Weight::Bold, ..STYLE };
        assert!(text_width("sextant", bold) > text_width("sextant", STYLE));
    }
}
