//! The likelihood of one node, on the plane of the grid through its maximum.

use sextant_recording::{GridPlane, Places, RecordedLikelihood, Solid};

use crate::paint::palette::{ACCENT, INK, PAPER, Ramp, THREAD};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::cells;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_rims;
use crate::plot::view::{Extent, View, Views};

/// Number of powers of ten below the maximum that have different colours.
const DECADES: f64 = 12.0;

/// Width of the world that is shown around the surface (m).
const SURROUNDINGS_M: f64 = 1.0;

const TRUTH: Stroke = Stroke::new(ACCENT, 2.2);
const ESTIMATE: Stroke = Stroke::new(INK, 2.2);
const TRUTH_CASING: Stroke = Stroke::new(PAPER, 4.6);
const ESTIMATE_CASING: Stroke = Stroke::new(PAPER, 5.0);
const RIM: Stroke = Stroke::new(INK, 1.2);
const NOTHING: Stroke = Stroke::new(THREAD, 0.8);

/// The figure.
pub(crate) fn draw(source: &Source<'_>, surface: &RecordedLikelihood) -> Picture {
    let RecordedLikelihood { map, node, plane } = surface;
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
    let extent = Extent::around(cells::corners(plane).into_iter().chain(truth).chain(estimate)).unwrap_or_default();
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
    let shares: Vec<f64> = levels.iter().map(|level| (level - bar.low) / (bar.high - bar.low)).collect();
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    for panel in views.panels(&areas) {
        cells::draw(&mut picture, &panel, plane, &shares, bar.ramp);
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

#[cfg(test)]
mod tests {
    use super::*;
    use sextant_channel::Position;

    fn plane(log_likelihood: Vec<f64>) -> GridPlane {
        GridPlane { first: Position::new(1.0, 2.0, 0.0), step_m: 0.5, columns: 3, values: log_likelihood }
    }

    #[test]
    fn levels_are_powers_of_ten_below_the_maximum() {
        let log = vec![-7.0, -7.0 - 100_f64.ln(), f64::NEG_INFINITY];
        let levels = levels(&plane(log));
        assert!(levels[0].abs() < 1e-12 && (levels[1] + 2.0).abs() < 1e-12 && levels[2] == f64::NEG_INFINITY);
    }
}
