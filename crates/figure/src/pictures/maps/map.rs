//! A map compared with the truth: the position of each node, and its distance from the true position.

use plotters::style::RGBColor;
use sextant_kernel::NodeId;
use sextant_mapper::PositionError;

use sextant_recording::{NodeRole, Places};

use super::claims;
use crate::paint::palette::{ACCENT, CURVES, INK, Ramp, THREAD};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;

/// Lines from true positions to mapped positions.
pub(crate) const ERROR: Stroke = Stroke::new(THREAD, 1.0);
/// A node that knew its place, in a map that the nodes computed.
const INITIAL_ANCHOR: RGBColor = ACCENT;
/// The rim of a node that became an anchor.
const NEW_ANCHOR: Stroke = Stroke::new(INK, 1.3);
/// A node that is not on the map.
const ABSENT: Stroke = Stroke::new(ACCENT, 1.6);

/// The figure of the map `name`.
pub(crate) fn draw(source: &Source<'_>, name: &str, places: &Places) -> Picture {
    let truth = &source.drawn.nodes;
    let errors = source.errors(places);
    let distribution = PositionError::of(&errors.iter().map(|&(_, error_m)| error_m).collect::<Vec<_>>());
    let bar = distribution.map(|distribution| colour_bar(&distribution));
    let views = source.views(places.values().copied());
    let radius = views.dot_radius(source.log.node_count());
    let absent: Vec<NodeId> = truth.keys().copied().filter(|node| !places.contains_key(node)).collect();
    let mut legend = Vec::new();
    let fill = bar.as_ref().map_or(CURVES[0], |bar| bar.color(0.6 * bar.high));
    legend.push(Entry { symbol: Symbol::Disc { radius, fill }, text: "mapped node".to_owned() });
    if !errors.is_empty() {
        let symbol = Symbol::Line { stroke: ERROR, pattern: &[] };
        legend.push(Entry { symbol, text: "line to its true position".to_owned() });
    }
    let anchors = Anchors::of(source, name, places);
    anchors.explain(radius, fill, &mut legend);
    if !absent.is_empty() {
        let text = "node that is not mapped".to_owned();
        legend.push(Entry { symbol: Symbol::Cross { stroke: ABSENT }, text });
    }
    legend.extend(source.obstacle_entry());
    let claims = source.claims_of(name);
    legend.extend(claims::entries(claims));
    let (title, note) = heading(source, name, places.len(), distribution);
    let sheet = Sheet { title, note, bar, legend };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    let mut order = errors;
    // The largest errors are drawn last, on top.
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    for panel in views.panels(&areas) {
        draw_solids(&mut picture, &panel, source.solids());
        claims::draw(&mut picture, &panel, claims);
        for (node, _) in &order {
            picture.line(panel.at(truth[node]), panel.at(places[node]), ERROR);
        }
        for node in &absent {
            picture.cross(panel.at(truth[node]), 3.5, ABSENT);
        }
        for (_, &place) in places.iter().filter(|(node, _)| !truth.contains_key(node)) {
            picture.disc(panel.at(place), radius, CURVES[0]);
        }
        for &(node, error_m) in &order {
            let fill = sheet.bar.as_ref().map_or(CURVES[0], |bar| bar.color(error_m));
            picture.disc(panel.at(places[&node]), radius, fill);
        }
        for node in &anchors.new {
            picture.ring(panel.at(places[node]), radius, NEW_ANCHOR);
        }
        for node in &anchors.initial {
            picture.square(panel.at(places[node]), 2.0 * radius, INITIAL_ANCHOR);
        }
        panel.axes.draw(&mut picture);
    }
    picture
}

/// The colour bar, from 0 to the largest error, or to the 95th percentile if a few errors are much larger.
pub(crate) fn colour_bar(distribution: &PositionError) -> ColourBar {
    let open_end = distribution.max > 1.5 * distribution.p95 && distribution.p95 > 0.0;
    let high = if open_end { distribution.p95 } else { distribution.max };
    let name = "position error [m]".to_owned();
    ColourBar { name, low: 0.0, high: high.max(1e-3), open_end, finest: 0.0, ramp: Ramp::Marks }
}

/// Title and note.
pub(crate) fn heading(
    source: &Source<'_>,
    name: &str,
    mapped: usize,
    distribution: Option<PositionError>,
) -> (String, String) {
    let total = source.log.node_count();
    let share = format!("{name}: {mapped} of {total} nodes mapped");
    match distribution {
        Some(PositionError { mean, median, p90, max, .. }) => (
            format!("{share}, mean error {mean:.2} m"),
            format!("{}; median {median:.2} m, 90 % below {p90:.2} m, largest {max:.2} m", source.title),
        ),
        None => (share, format!("{}; true positions unknown", source.title)),
    }
}

/// The anchors on a map that the nodes computed.
#[derive(Default)]
struct Anchors {
    initial: Vec<NodeId>,
    new: Vec<NodeId>,
}

impl Anchors {
    /// Those on the map `name`; none if the nodes did not compute it.
    fn of(source: &Source<'_>, name: &str, places: &Places) -> Self {
        if source.map_of_nodes() != Some(name) {
            return Self::default();
        }
        let with = |role| {
            let nodes = source.drawn.mapped_nodes.iter().filter(move |node| node.role == role);
            nodes.map(|node| node.node).filter(|node| places.contains_key(node)).collect()
        };
        Self { initial: with(NodeRole::InitialAnchor), new: with(NodeRole::NewAnchor) }
    }

    /// Their entries in the legend; other nodes have a disc of `radius`, filled with `fill`.
    fn explain(&self, radius: f64, fill: RGBColor, legend: &mut Vec<Entry>) {
        if !self.initial.is_empty() {
            let symbol = Symbol::Square { side: 2.0 * radius, fill: INITIAL_ANCHOR };
            legend.push(Entry { symbol, text: "anchor from the beginning".to_owned() });
        }
        if !self.new.is_empty() {
            let symbol = Symbol::RimmedDisc { radius, fill, rim: NEW_ANCHOR };
            legend.push(Entry { symbol, text: "node that became an anchor".to_owned() });
        }
    }
}
