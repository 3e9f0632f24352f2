//! The likelihood of one node, on the plane of the grid through its maximum.

use sextant_channel::Position;

use crate::recording::{DrawnLikelihood, GridPlane, Places, Solid};

use super::palette::{ACCENT, INK, PAPER, Ramp, THREAD};
use super::picture::{Area, Picture, Stroke};
use super::sheet::{ColourBar, Entry, Sheet, Symbol};
use super::silhouette::draw_rims;
use super::source::Source;
use super::view::{Extent, Panel, View, Views};

/// Number of powers of ten below the maximum that have different colours.
const DECADES: f64 = 12.0;
/// Number of different colours.
const SHADES: f64 = 48.0;

/// Width of the world that is shown around the surface (m).
const SURROUNDINGS_M: f64 = 1.0;

const TRUTH: Stroke = Stroke::new(ACCENT, 2.2);
const ESTIMATE: Stroke = Stroke::new(INK, 2.2);
const TRUTH_CASING: Stroke = Stroke::new(PAPER, 4.6);
const ESTIMATE_CASING: Stroke = Stroke::new(PAPER, 5.0);
const RIM: Stroke = Stroke::new(INK, 1.2);
const NOTHING: Stroke = Stroke::new(THREAD, 0.8);

/// The figure.
pub(super) fn draw(source: &Source<'_>, surface: &DrawnLikelihood) -> Picture {
    let DrawnLikelihood { map, node, plane } = surface;
    let id = source.node(node);
    let truth = id.and_then(|id| source.drawn.nodes.get(&id).copied());
    let places = source.drawn.maps.iter().find(|(name, _)| name == map).map(|(_, places)| places);
    let estimate = id.and_then(|id| places.unwrap_or(&Places::new()).get(&id).copied());
    let levels = levels(plane);
    let lowest = levels.iter().copied().filter(|level| level.is_finite()).fold(0.0, f64::min);
    let bar = ColourBar {
        name: "log\u{2081}\u{2080} (likelihood / maximum)".to_owned(),
        low: lowest.clamp(-DECADES, -1.0),
        high: 0.0,
        open_end: false,
        finest: 0.0,
        ramp: Ramp::Areas,
    };
    let extent = Extent::around(corners(plane).into_iter().chain(truth).chain(estimate)).unwrap_or_default();
    let extent = extent.widened(SURROUNDINGS_M);
    let near = |solid: &&Solid| {
        let around = Extent::around(solid.vertices.iter().copied());
        around.is_some_and(|around| around.is_seen_within(&extent, View::Top))
    };
    let solids: Vec<Solid> = source.solids().iter().filter(near).cloned().collect();
    let views = Views::new(&extent, &[View::Top]);
    let mut legend = Vec::new();
    if truth.is_some() {
        let symbol = Symbol::Plus { stroke: TRUTH, casing: TRUTH_CASING };
        legend.push(Entry { symbol, text: "true position".to_owned() });
    }
    if estimate.is_some() {
        let symbol = Symbol::Ring { stroke: ESTIMATE, casing: ESTIMATE_CASING };
        legend.push(Entry { symbol, text: "estimate".to_owned() });
    }
    legend.push(Entry { symbol: Symbol::Body { fill: PAPER, rim: NOTHING }, text: "impossible".to_owned() });
    if !solids.is_empty() {
        let symbol = Symbol::Line { stroke: RIM, pattern: &[] };
        legend.push(Entry { symbol, text: "outline of an obstacle".to_owned() });
    }
    let error = truth.zip(estimate).map(|(truth, estimate)| truth.distance_m(estimate));
    let error = error.map_or(String::new(), |error_m| format!(", error {error_m:.2} m"));
    let sheet = Sheet {
        title: format!("{map}: likelihood of node {node}"),
        note: format!("{}; plane z = {:.2} m, grid of {} m{error}", source.title, plane.first.z_m, plane.step_m),
        bar: Some(bar.clone()),
        legend,
    };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    for panel in views.panels(&areas) {
        draw_cells(&mut picture, &panel, plane, &levels, &bar);
        draw_rims(&mut picture, &panel, &solids, RIM);
        if let Some(place) = estimate {
            picture.ring(panel.at(place), 6.5, ESTIMATE_CASING);
            picture.ring(panel.at(place), 6.5, ESTIMATE);
        }
        if let Some(place) = truth {
            picture.plus(panel.at(place), 8.2, TRUTH_CASING);
            picture.plus(panel.at(place), 7.0, TRUTH);
        }
        panel.axes.draw(&mut picture);
    }
    picture
}

/// Logarithm (base 10) of the likelihood relative to the maximum, at each vertex.
fn levels(plane: &GridPlane) -> Vec<f64> {
    let highest = plane.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if !highest.is_finite() {
        return vec![f64::NEG_INFINITY; plane.values.len()];
    }
    plane.values.iter().map(|&log| (log - highest) / std::f64::consts::LN_10).collect()
}

/// Two opposite corners of the area of all cells.
fn corners(plane: &GridPlane) -> [Position; 2] {
    let rows = plane.values.len() / plane.columns as usize;
    let (across, up) = (f64::from(plane.columns), rows as f64);
    let half = Position::new(0.5, 0.5, 0.0) * plane.step_m;
    let first = plane.first - half;
    [first, first + Position::new(across, up, 0.0) * plane.step_m]
}

/// Draws one rectangle for each run of cells of equal shade along x, and nothing where the likelihood is zero.
fn draw_cells(picture: &mut Picture, panel: &Panel, plane: &GridPlane, levels: &[f64], bar: &ColourBar) {
    let shade = |level: f64| {
        let shade = ((level - bar.low) / (bar.high - bar.low) * SHADES).round().clamp(0.0, SHADES);
        (level > f64::NEG_INFINITY).then_some(shade)
    };
    let [first, _] = corners(plane);
    for (row, levels) in (0_u32..).zip(levels.chunks_exact(plane.columns as usize)) {
        let shades: Vec<Option<f64>> = levels.iter().map(|&level| shade(level)).collect();
        let mut column = 0_u32;
        for run in shades.chunk_by(|a, b| a == b) {
            let end = column + u32::try_from(run.len()).expect("a run has at most as many cells as columns");
            let corner = |column: u32, row: u32| {
                panel.at(first + Position::new(f64::from(column), f64::from(row), 0.0) * plane.step_m)
            };
            let (low, high) = (corner(column, row), corner(end, row + 1));
            if let Some(shade) = run[0] {
                let (width, height) = (high.x - low.x, low.y - high.y);
                // The rectangle is slightly larger, so that no gap is visible to its neighbours.
                let area = Area { left: low.x, top: high.y - 0.6, width: width + 0.6, height: height + 0.6 };
                picture.rectangle(area, bar.ramp.color(shade / SHADES));
            }
            column = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(log_likelihood: Vec<f64>) -> GridPlane {
        GridPlane { first: Position::new(1.0, 2.0, 0.0), step_m: 0.5, columns: 3, values: log_likelihood }
    }

    #[test]
    fn levels_are_powers_of_ten_below_the_maximum() {
        let log = vec![-7.0, -7.0 - 100_f64.ln(), f64::NEG_INFINITY];
        let levels = levels(&plane(log));
        assert!(levels[0].abs() < 1e-12 && (levels[1] + 2.0).abs() < 1e-12 && levels[2] == f64::NEG_INFINITY);
    }

    #[test]
    fn cells_reach_half_a_step_beyond_the_vertices() {
        let [low, high] = corners(&plane(vec![0.0; 6]));
        assert!(low.distance_m(Position::new(0.75, 1.75, 0.0)) < 1e-12);
        assert!(high.distance_m(Position::new(2.25, 2.75, 0.0)) < 1e-12);
    }
}
