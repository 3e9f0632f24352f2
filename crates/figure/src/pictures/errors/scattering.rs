//! The error of neighbour scattering of nodes that computed a map, and how far they are from where they believe to be
//! (Gunathillake 2018, figure 5.3).

use sextant_kernel::NodeId;

use crate::paint::palette::{ACCENT, CURVES};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::axes::{Axes, Axis, Shown};
use crate::plot::sheet::{Entry, Sheet, Symbol};
use sextant_recording::RecordedNode;

/// Size of the plot (px).
const SIZE: (f64, f64) = (560.0, 360.0);
/// Radius of the disc of a node (px).
const RADIUS: f64 = 2.2;
/// Width of the bins over which the mean is taken.
const STEP: f64 = 0.05;
/// The mean.
const MEAN: Stroke = Stroke::new(ACCENT, 2.5);

/// The figure; `None` if no node that computed its place has neighbours and a known true place.
pub(crate) fn draw(source: &Source<'_>) -> Option<Picture> {
    let name = source.map_of_nodes()?;
    let (_, places) = source.drawn.maps.iter().find(|(other, _)| other == name)?;
    let errors = source.errors(places);
    let error_m = |node: NodeId| errors.binary_search_by_key(&node, |&(node, _)| node).ok().map(|at| errors[at].1);
    let point = |node: &RecordedNode| Some((node.scattering?, error_m(node.node)?));
    let points: Vec<(f64, f64)> = source.drawn.mapped_nodes.iter().filter_map(point).collect();
    let (widest, largest_m) = points.iter().copied().reduce(|(x, y), (a, b)| (x.max(a), y.max(b)))?;
    let legend = vec![
        Entry { symbol: Symbol::Disc { radius: RADIUS, fill: CURVES[0] }, text: "node".to_owned() },
        Entry { symbol: Symbol::Line { stroke: MEAN, pattern: &[] }, text: format!("mean in bins of {STEP}") },
    ];
    let title = format!("{}: neighbour scattering", source.title);
    let note = format!("{name}: share of the neighbours of a node beyond the radius of communication, at the end");
    let (mut picture, areas) = Sheet { title, note, bar: None, legend }.lay_out(&[SIZE]);
    let high = f64::max(widest, STEP);
    let across = "error of neighbour scattering".to_owned();
    let up = "position error [m]".to_owned();
    let axes = Axes {
        across: Axis { low: -0.02 * high, high: 1.03 * high, name: across, shown: Shown::All },
        up: Axis { low: 0.0, high: 1.04 * largest_m.max(1e-3), name: up, shown: Shown::All },
        area: areas[0],
    };
    axes.draw_grid(&mut picture);
    for &(share, error_m) in &points {
        picture.disc(axes.at(share, error_m), RADIUS, CURVES[0]);
    }
    for (low, width, mean_m) in bins(&points) {
        picture.line(axes.at(low, mean_m), axes.at((low + width).min(high), mean_m), MEAN);
    }
    axes.draw(&mut picture);
    Some(picture)
}

/// The lower edge, the width and the mean error of each bin with nodes. A bin has its upper edge, the first one both.
fn bins(points: &[(f64, f64)]) -> Vec<(f64, f64, f64)> {
    let count = (1.0 / STEP).round();
    let mut bins = Vec::new();
    let mut low = 0.0;
    while low < count {
        let is_in = |share: f64| share <= STEP * (low + 1.0) + 1e-9 && (share > STEP * low + 1e-9 || low < 0.5);
        let errors_m: Vec<f64> =
            points.iter().filter(|(share, _)| is_in(*share)).map(|&(_, error_m)| error_m).collect();
        if !errors_m.is_empty() {
            bins.push((STEP * low, STEP, errors_m.iter().sum::<f64>() / errors_m.len() as f64));
        }
        low += 1.0;
    }
    bins
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_node_is_in_one_bin() {
        let found = bins(&[(0.0, 1.0), (0.05, 3.0), (0.06, 5.0), (1.0, 7.0)]);
        let expected = [(0.0, 2.0), (0.05, 5.0), (0.95, 7.0)];
        assert_eq!(found.len(), expected.len());
        for ((low, _, mean_m), (at, error_m)) in found.into_iter().zip(expected) {
            assert!((low - at).abs() < 1e-9 && (mean_m - error_m).abs() < 1e-9, "{low}, {mean_m}");
        }
    }
}
