//! Plots of curves.

use plotters::style::RGBColor;

use super::axes::{Axes, Axis, Shown};
use super::sheet::{Entry, Sheet, Symbol};
use crate::paint::file::Figure;
use crate::paint::palette::{CURVES, FAINT_INK, PATTERNS};
use crate::paint::picture::{Picture, Point, Stroke};

/// Size of the plot (px).
const SIZE: (f64, f64) = (560.0, 360.0);

/// Largest number of points of a curve that are marked.
const MOST_MARKS: usize = 40;

/// Distance of the points of different curves that are drawn side by side (px).
const APART: f64 = 4.0;
/// Largest width of all of them together (px).
const WIDEST: f64 = 28.0;

/// A curve and its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Its points, in the order of the line.
    pub points: Vec<(f64, f64)>,
    /// The interval at each point, from its low to its high end; none is drawn where it is absent or has no height. Of a curve
    /// without intervals the list may be empty.
    pub intervals: Vec<Option<[f64; 2]>>,
}

impl Series {
    /// Each point with its interval, which has no height where there is none.
    pub(super) fn spans(&self) -> impl Iterator<Item = ((f64, f64), [f64; 2])> {
        let intervals = self.intervals.iter().copied().chain(std::iter::repeat(None));
        self.points.iter().zip(intervals).map(|(&point, interval)| (point, interval.unwrap_or([point.1; 2])))
    }
}

/// Several curves with common axes; the vertical axis has 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Curves {
    /// The title.
    pub title: String,
    /// The note below the title.
    pub note: String,
    /// Name of the horizontal axis, with its unit.
    pub across: String,
    /// Name of the vertical axis, with its unit.
    pub up: String,
    /// The curves.
    pub series: Vec<Series>,
}

/// How curves are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Style {
    /// Marks at the points.
    Marked,
    /// Marks at the points, those of different curves side by side, so that intervals do not hide each other.
    Apart,
    /// As apart, and with room for intervals that reach below 0.
    Differences,
    /// Lines only.
    Lines,
}

impl Curves {
    /// The figure; `name` is the name of its file.
    #[must_use]
    pub fn figure(self, name: &str) -> Figure {
        Figure { name: name.to_owned(), picture: self.draw() }
    }

    /// The figure with the points and intervals of different curves side by side.
    #[must_use]
    pub fn figure_apart(self, name: &str) -> Figure {
        Figure { name: name.to_owned(), picture: self.draw_as(&CURVES, Style::Apart) }
    }

    /// The figure of numbers of either sign, such as differences: intervals are drawn whole, also below 0.
    #[must_use]
    pub fn figure_of_differences(self, name: &str) -> Figure {
        Figure { name: name.to_owned(), picture: self.draw_as(&CURVES, Style::Differences) }
    }

    /// The figure without marks at the points: for stairs.
    #[must_use]
    pub fn figure_of_lines(self, name: &str) -> Figure {
        Figure { name: name.to_owned(), picture: self.draw_as(&CURVES, Style::Lines) }
    }

    pub(crate) fn draw(self) -> Picture {
        self.draw_in(&CURVES)
    }

    /// The picture with these colours, in the order of the curves.
    pub(crate) fn draw_in(self, colors: &[RGBColor]) -> Picture {
        self.draw_as(colors, Style::Marked)
    }

    fn draw_as(self, colors: &[RGBColor], drawn: Style) -> Picture {
        let style = |i: usize| (Stroke::new(colors[i % colors.len()], 2.0), PATTERNS[i % PATTERNS.len()]);
        let points = || self.series.iter().flat_map(|series| &series.points);
        let low = points().map(|point| point.0).fold(f64::INFINITY, f64::min);
        let high = points().map(|point| point.0).fold(f64::NEG_INFINITY, f64::max);
        let reach = |series: &Series| series.spans().map(|(_, [_, high])| high).fold(0.0, f64::max);
        let top = self.series.iter().map(reach).fold(0.0, f64::max);
        let depth = |series: &Series| {
            // Intervals alone do not need an axis below 0, unless its sign is the question.
            let is_below = drawn == Style::Differences || series.points.iter().any(|point| point.1 < 0.0);
            let lowest = series.spans().map(|(_, [low, _])| low).fold(0.0, f64::min);
            if is_below { lowest } else { 0.0 }
        };
        let bottom = self.series.iter().map(depth).fold(0.0, f64::min);
        let (floor, ceiling) = if bottom < 0.0 {
            let room = 0.05 * (top - bottom);
            (bottom - room, top + room)
        } else {
            (0.0, 1.05 * top.max(1e-9))
        };
        // An axis needs a width even if there is only one value.
        let (low, high) = if low < high { (low, high) } else { (low.min(0.0) - 0.5, high.max(0.0) + 0.5) };
        let legend = self.series.iter().enumerate().map(|(i, series)| {
            let (stroke, pattern) = style(i);
            Entry { symbol: Symbol::Line { stroke, pattern }, text: series.name.clone() }
        });
        let sheet = Sheet { title: self.title.clone(), note: self.note.clone(), bar: None, legend: legend.collect() };
        let (mut picture, areas) = sheet.lay_out(&[SIZE]);
        let margin = 0.03 * (high - low);
        let axes = Axes {
            across: Axis { low: low - margin, high: high + margin, name: self.across.clone(), shown: Shown::All },
            up: Axis { low: floor, high: ceiling, name: self.up.clone(), shown: Shown::All },
            area: areas[0],
        };
        axes.draw_grid(&mut picture);
        if floor < 0.0 {
            picture.line(axes.at(axes.across.low, 0.0), axes.at(axes.across.high, 0.0), Stroke::new(FAINT_INK, 1.0));
        }
        let curves = self.series.len() as f64;
        let apart = APART.min(WIDEST / curves);
        for (i, series) in self.series.iter().enumerate() {
            let (stroke, pattern) = style(i);
            let aside = match drawn {
                Style::Apart | Style::Differences => apart * (i as f64 - (curves - 1.0) / 2.0),
                Style::Marked | Style::Lines => 0.0,
            };
            let at = |x: f64, y: f64| {
                let place = axes.at(x, y);
                Point::new(place.x + aside, place.y)
            };
            let places: Vec<_> = series.points.iter().map(|&(x, y)| at(x, y)).collect();
            picture.dashed(&places, pattern, stroke);
            for ((x, _), [low, high]) in series.spans().filter(|(_, [low, high])| low < high) {
                picture.line(at(x, low.max(floor)), at(x, high), Stroke::new(stroke.color, 1.0));
            }
            // Many marks would hide the line.
            let has_marks = drawn != Style::Lines && series.points.len() <= MOST_MARKS;
            for place in places.into_iter().filter(|_| has_marks) {
                picture.disc(place, 3.0, stroke.color);
            }
        }
        axes.draw(&mut picture);
        picture
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::picture::Mark;

    /// Two curves of one point with an interval, one of them below 0.
    fn two() -> Curves {
        let series = |name: &str, y: f64| Series {
            name: name.into(),
            points: vec![(1.0, y), (2.0, y)],
            intervals: vec![Some([y - 0.5, y + 0.5]); 2],
        };
        let series = vec![series("a", -1.0), series("b", 2.0)];
        Curves { title: "t".into(), note: String::new(), across: "x".into(), up: "y".into(), series }
    }

    #[test]
    fn curves_apart_have_their_points_side_by_side_and_lines_have_none() {
        let discs = |figure: Figure, color| -> Vec<f64> {
            let marks = figure.picture.marks.into_iter();
            marks
                .filter_map(|mark| match mark {
                    Mark::Disc { center, fill, .. } if fill == color => Some(center.x),
                    _ => None,
                })
                .collect()
        };
        let (a, b) = (discs(two().figure_apart("t"), CURVES[0]), discs(two().figure_apart("t"), CURVES[1]));
        assert!((b[0] - a[0] - APART).abs() < 1e-9 && (b[1] - a[1] - APART).abs() < 1e-9, "{a:?} {b:?}");
        assert_eq!(discs(two().figure("t"), CURVES[0]), discs(two().figure("t"), CURVES[1]));
        assert!(discs(two().figure_of_lines("t"), CURVES[0]).is_empty());
    }

    #[test]
    fn an_interval_below_zero_is_drawn_whole_where_its_sign_is_the_question() {
        let above = || {
            let mut curves = two();
            curves.series.remove(0);
            curves.series[0].intervals = vec![Some([-3.0, 7.0]); 2];
            curves
        };
        let ticks = |figure: Figure| -> Vec<String> {
            let texts = figure.picture.marks.into_iter().filter_map(|mark| match mark {
                Mark::Text { text, .. } => Some(text),
                _ => None,
            });
            texts.filter(|text| text.starts_with('\u{2212}')).collect()
        };
        assert_eq!(ticks(above().figure("t")), [""; 0]);
        assert!(!ticks(above().figure_of_differences("t")).is_empty());
    }

    #[test]
    fn an_interval_that_is_not_symmetric_is_drawn_from_its_low_to_its_high_end() {
        let mut curves = two();
        curves.series.remove(0);
        curves.series[0] = Series {
            name: "b".into(),
            points: vec![(1.0, 2.0), (2.0, 1.0)],
            intervals: vec![Some([1.0, 2.0]), None],
        };
        let marks = curves.draw().marks;
        let places: Vec<f64> = marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Disc { center, fill, .. } if *fill == CURVES[0] => Some(center.y),
                _ => None,
            })
            .collect();
        let ends: Vec<Vec<f64>> = marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Path { points, stroke, .. } if stroke.color == CURVES[0] && stroke.width < 1.5 => {
                    Some(points.iter().map(|point| point.y).collect())
                }
                _ => None,
            })
            .collect();
        // It ends at the first point, and begins as low as the second.
        assert_eq!(ends.len(), 1, "{ends:?}");
        assert!(
            (ends[0][0] - places[1]).abs() < 1e-9 && (ends[0][1] - places[0]).abs() < 1e-9,
            "{ends:?} {places:?}"
        );
    }

    #[test]
    fn differences_below_zero_are_within_the_frame() {
        let picture = two().draw();
        let height = picture.height;
        let inside = |y: f64| (0.0..height).contains(&y);
        let discs = picture.marks.iter().filter_map(|mark| match mark {
            Mark::Disc { center, .. } => Some(center.y),
            _ => None,
        });
        assert!(discs.clone().count() == 4 && discs.clone().all(inside));
        let texts: Vec<&str> = picture
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Text { text, .. } => Some(text.as_str()),
                _ => None,
            })
            .collect();
        assert!(texts.contains(&"\u{2212}1") && texts.contains(&"2"), "{texts:?}");
    }

    #[test]
    fn each_point_is_marked_in_the_colour_of_its_curve() {
        let series = |name: &str, y: f64| Series {
            name: name.into(),
            points: vec![(0.0, y), (1.0, 2.0 * y)],
            intervals: vec![],
        };
        let curves = Curves {
            title: "t".into(),
            note: String::new(),
            across: "x".into(),
            up: "y".into(),
            series: vec![series("a", 1.0), series("b", 2.0)],
        };
        let picture = curves.draw();
        let discs = |color| {
            picture.marks.iter().filter(|mark| matches!(mark, Mark::Disc { fill, .. } if *fill == color)).count()
        };
        assert_eq!((discs(CURVES[0]), discs(CURVES[1])), (2, 2));
    }
}
