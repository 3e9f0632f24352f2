//! The distribution of the errors of the nodes in all maps.

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_kernel::{NodeId, Unwatched};
use sextant_mapper::{NeighbourhoodRule, PositionError, connectivity_error};

use crate::paint::palette::{CURVES, FAINT_INK, PATTERNS};
use crate::paint::picture::{Picture, Point, Stroke};
use crate::pictures::source::Source;
use crate::plot::axes::{Axes, Axis, Shown};
use crate::plot::sheet::{Entry, Sheet, Symbol};
use sextant_recording::Places;

/// Size of the plot (px).
const SIZE: (f64, f64) = (560.0, 360.0);
/// The line of half of the nodes.
const HALF: Stroke = Stroke::new(FAINT_INK, 1.0);
/// Radius of the neighbourhood for the connectivity error (m).
const NEIGHBOURHOOD_M: f64 = 5.0;

/// Curves with more steps than this are drawn with one step for each place ...
const MOST_STEPS: usize = 5000;
/// ... that can be distinguished in a file (px).
const FINEST: f64 = 0.1;

/// An error of a node in a map.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum NodeError {
    /// The distance from its true position.
    Position,
    /// The share of its neighbours that it loses.
    Connectivity,
}

impl NodeError {
    /// The name of the error, without its unit.
    fn name(self) -> String {
        match self {
            Self::Position => "position error".to_owned(),
            Self::Connectivity => format!("connectivity error of a node ({NEIGHBOURHOOD_M} m)"),
        }
    }

    /// The unit after a number.
    fn unit(self) -> &'static str {
        match self {
            Self::Position => " m",
            Self::Connectivity => "",
        }
    }

    /// The nodes that are counted.
    fn nodes(self) -> &'static str {
        match self {
            Self::Position => "mapped nodes",
            Self::Connectivity => "nodes with neighbours",
        }
    }

    /// The errors of the nodes of a map, where they are defined.
    fn of(self, source: &Source<'_>, places: &Places) -> Vec<f64> {
        match self {
            Self::Position => source.errors(places).iter().map(|&(_, error_m)| error_m).collect(),
            Self::Connectivity => {
                let truth: Vec<Position> = source.drawn.nodes.values().copied().collect();
                let place = |node: &NodeId| places.get(node).copied();
                let map: Vec<Option<Position>> = source.drawn.nodes.keys().map(place).collect();
                let error = connectivity_error(&truth, &map, NEIGHBOURHOOD_M, NeighbourhoodRule::Affine, &Unwatched);
                error.map_or_else(|_| Vec::new(), |error| error.per_node.into_iter().flatten().collect())
            }
        }
    }
}

/// The curve of one map.
struct Curve {
    /// Errors in ascending order.
    errors: Vec<f64>,
    median: f64,
    color: RGBColor,
    pattern: &'static [f64],
}

/// The figure; `None` if no error of any map is known.
pub(crate) fn draw(source: &Source<'_>, what: NodeError) -> Option<Picture> {
    let mut curves = Vec::new();
    let mut legend = Vec::new();
    let unit = what.unit();
    for (i, (name, places)) in source.drawn.maps.iter().enumerate() {
        let mut errors = what.of(source, places);
        errors.sort_unstable_by(f64::total_cmp);
        let Some(PositionError { mean, median, .. }) = PositionError::of(&errors) else {
            continue;
        };
        let (color, pattern) = (CURVES[i % CURVES.len()], PATTERNS[i % PATTERNS.len()]);
        let mapped = format!("{} of {} nodes", places.len(), source.log.node_count());
        legend.push(Entry {
            symbol: Symbol::Line { stroke: Stroke::new(color, 2.0), pattern },
            text: format!("{name}: median {median:.2}{unit}, mean {mean:.2}{unit}, {mapped}"),
        });
        curves.push(Curve { errors, median, color, pattern });
    }
    let largest = curves.iter().filter_map(|curve| curve.errors.last().copied()).fold(f64::NAN, f64::max);
    if largest.is_nan() {
        return None;
    }
    let title = format!("{}: {}", source.title, what.name());
    let note = format!("share of the {} with at most this error; a dot marks the median", what.nodes());
    let (mut picture, areas) = Sheet { title, note, bar: None, legend }.lay_out(&[SIZE]);
    let across = if unit.is_empty() { what.name() } else { format!("{} [{}]", what.name(), unit.trim()) };
    let axes = Axes {
        across: Axis { low: 0.0, high: 1.04 * largest.max(1e-3), name: across, shown: Shown::All },
        up: Axis { low: 0.0, high: 1.02, name: format!("share of {}", what.nodes()), shown: Shown::All },
        area: areas[0],
    };
    axes.draw_grid(&mut picture);
    picture.dashed(&[axes.at(axes.across.low, 0.5), axes.at(axes.across.high, 0.5)], &[2.0, 3.0], HALF);
    for curve in &curves {
        picture.dashed(&curve.steps(&axes), curve.pattern, Stroke::new(curve.color, 2.0));
    }
    for curve in &curves {
        let median = axes.at(curve.median, 0.5);
        let foot = axes.at(curve.median, 0.0);
        picture.dashed(&[median, foot], &[2.0, 3.0], Stroke::new(curve.color, 1.2));
        picture.disc(median, 4.5, curve.color);
    }
    axes.draw(&mut picture);
    Some(picture)
}

impl Curve {
    /// The cumulative distribution as a step function from 0 to the right end of the plot.
    fn steps(&self, axes: &Axes) -> Vec<Point> {
        let share = |count: usize| count as f64 / self.errors.len() as f64;
        let mut points = vec![axes.at(0.0, 0.0)];
        // Errors that are drawn at the same place are one step.
        let is_one_step = |a: &f64, b: &f64| {
            let place = |error: f64| (axes.at(error, 0.0).x / FINEST).round();
            self.errors.len() > MOST_STEPS && place(*a).total_cmp(&place(*b)).is_eq()
        };
        let mut before = 0;
        for step in self.errors.chunk_by(is_one_step) {
            points.push(axes.at(step[0], share(before)));
            before += step.len();
            points.push(axes.at(step[0], share(before)));
        }
        points.push(axes.at(axes.across.high, 1.0));
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paint::picture::Area;

    #[test]
    fn a_curve_of_many_errors_has_one_step_for_each_place() {
        let axis = |high: f64| Axis { low: 0.0, high, name: String::new(), shown: Shown::All };
        let area = Area { left: 0.0, top: 0.0, width: 40.0, height: 10.0 };
        let axes = Axes { across: axis(4.0), up: axis(1.0), area };
        let errors: Vec<f64> = (0..20_000).map(|i| f64::from(i) / 5000.0).collect();
        let curve = Curve { errors: errors.clone(), median: 2.0, color: CURVES[0], pattern: &[] };
        let points = curve.steps(&axes);
        assert!(points.len() < 900, "{}", points.len());
        // No error is farther from the curve than a place is wide.
        for (i, error) in errors.iter().enumerate() {
            let exact = axes.at(*error, (i + 1) as f64 / 20_000.0);
            let nearest = points.iter().map(|point| point.distance(exact)).fold(f64::INFINITY, f64::min);
            assert!(nearest < 2.0 * FINEST, "{error}: {nearest} px");
        }
    }

    #[test]
    fn a_curve_has_one_step_per_error() {
        let axis = |high: f64| Axis { low: 0.0, high, name: String::new(), shown: Shown::All };
        let area = Area { left: 0.0, top: 0.0, width: 4.0, height: 1.0 };
        let axes = Axes { across: axis(4.0), up: axis(1.0), area };
        let curve = Curve { errors: vec![1.0, 3.0], median: 2.0, color: CURVES[0], pattern: &[] };
        let expected = [(0.0, 0.0), (1.0, 0.0), (1.0, 0.5), (3.0, 0.5), (3.0, 1.0), (4.0, 1.0)];
        assert_eq!(curve.steps(&axes), expected.map(|(x, share)| Point::new(x, 1.0 - share)));
    }
}
