//! How the position errors of all maps are distributed.

use plotters::style::RGBColor;
use sextant_mapper::PositionError;

use super::PATTERNS;
use super::axes::{Axes, Axis, Shown};
use super::palette::{CURVES, FAINT_INK};
use super::picture::{Picture, Point, Stroke};
use super::sheet::{Entry, Sheet, Symbol};
use super::source::Source;

/// Size of the plot [px].
const SIZE: (f64, f64) = (560.0, 360.0);
/// The line of half of the nodes.
const HALF: Stroke = Stroke::new(FAINT_INK, 1.0);

/// The curve of one map.
struct Curve {
    /// Errors from small to large [m].
    errors_m: Vec<f64>,
    median_m: f64,
    color: RGBColor,
    pattern: &'static [f64],
}

/// The figure; `None` if no error of any map is known.
pub(super) fn draw(source: &Source<'_>) -> Option<Picture> {
    let mut curves = Vec::new();
    let mut legend = Vec::new();
    for (i, (name, places)) in source.drawn.maps.iter().enumerate() {
        let mut errors_m: Vec<f64> = source.errors(places).iter().map(|&(_, error_m)| error_m).collect();
        errors_m.sort_unstable_by(f64::total_cmp);
        let Some(PositionError { mean, median, .. }) = PositionError::of(&errors_m) else {
            continue;
        };
        let (color, pattern) = (CURVES[i % CURVES.len()], PATTERNS[i % PATTERNS.len()]);
        let mapped = format!("{} of {} nodes", places.len(), source.log.node_count());
        legend.push(Entry {
            symbol: Symbol::Line { stroke: Stroke::new(color, 2.0), pattern },
            text: format!("{name}: median {median:.2} m, mean {mean:.2} m, {mapped}"),
        });
        curves.push(Curve { errors_m, median_m: median, color, pattern });
    }
    let largest_m = curves.iter().filter_map(|curve| curve.errors_m.last().copied()).fold(f64::NAN, f64::max);
    if largest_m.is_nan() {
        return None;
    }
    let title = format!("{}: position error", source.title);
    let note = "share of the mapped nodes whose error is at most this; a dot marks the median".to_owned();
    let (mut picture, areas) = Sheet { title, note, bar: None, legend }.lay_out(&[SIZE]);
    let name = |text: &str| text.to_owned();
    let axes = Axes {
        across: Axis {
            low: 0.0,
            high: 1.04 * largest_m.max(1e-3),
            name: name("position error [m]"),
            shown: Shown::All,
        },
        up: Axis { low: 0.0, high: 1.02, name: name("share of mapped nodes"), shown: Shown::All },
        area: areas[0],
    };
    axes.draw_grid(&mut picture);
    picture.dashed(&[axes.at(axes.across.low, 0.5), axes.at(axes.across.high, 0.5)], &[2.0, 3.0], HALF);
    for curve in &curves {
        picture.dashed(&curve.steps(&axes), curve.pattern, Stroke::new(curve.color, 2.0));
    }
    for curve in &curves {
        let median = axes.at(curve.median_m, 0.5);
        let foot = axes.at(curve.median_m, 0.0);
        picture.dashed(&[median, foot], &[2.0, 3.0], Stroke::new(curve.color, 1.2));
        picture.disc(median, 4.5, curve.color);
    }
    axes.draw(&mut picture);
    Some(picture)
}

impl Curve {
    /// The share that is not above, as a staircase from 0 to the right end of the plot.
    fn steps(&self, axes: &Axes) -> Vec<Point> {
        #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
        let share = |count: usize| count as f64 / self.errors_m.len() as f64;
        let mut points = vec![axes.at(0.0, 0.0)];
        for (i, &error_m) in self.errors_m.iter().enumerate() {
            points.push(axes.at(error_m, share(i)));
            points.push(axes.at(error_m, share(i + 1)));
        }
        points.push(axes.at(axes.across.high, 1.0));
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::picture::Area;

    #[test]
    fn a_curve_climbs_by_one_share_at_each_error() {
        let axis = |high: f64| Axis { low: 0.0, high, name: String::new(), shown: Shown::All };
        let area = Area { left: 0.0, top: 0.0, width: 4.0, height: 1.0 };
        let axes = Axes { across: axis(4.0), up: axis(1.0), area };
        let curve = Curve { errors_m: vec![1.0, 3.0], median_m: 2.0, color: CURVES[0], pattern: &[] };
        let expected = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (3.0, 0.5), (3.0, 1.0), (4.0, 1.0)];
        assert_eq!(curve.steps(&axes), expected.map(|(x, share)| Point::new(x, 1.0 - share)));
    }
}
