//! The tree over which packets went: each node with a line to its parent.

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_kernel::NodeId;
use sextant_kernel::text::counted;
use sextant_recording::RecordedEdge;

use super::network::{SINK, SINK_SIDE};
use crate::paint::palette::{ACCENT, Ramp, THREAD};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;

/// A line to a parent.
const LINK: Stroke = Stroke::new(THREAD, 1.0);
/// The mark of a node without a way to a sink.
const WITHOUT: RGBColor = ACCENT;

/// The figure; `None` without a tree, or if the places of nodes are not known.
pub(crate) fn draw(source: &Source<'_>) -> Option<Picture> {
    let drawn = source.drawn;
    if drawn.tree.is_empty() || drawn.nodes.is_empty() {
        return None;
    }
    let deepest = drawn.tree.iter().filter_map(|edge| edge.depth).max().unwrap_or(1);
    let bar = ColourBar {
        name: "hops to a sink".to_owned(),
        low: 0.0,
        high: f64::from(deepest.max(1)),
        open_end: false,
        finest: 1.0,
        ramp: Ramp::Marks,
    };
    let views = source.views(drawn.sinks.values().copied());
    let radius = 0.9 * views.dot_radius(drawn.nodes.len());
    let (mut picture, areas) = sheet(source, &bar, radius).lay_out(&views.sizes());
    for panel in views.panels(&areas) {
        draw_solids(&mut picture, &panel, source.solids());
        for edge in &drawn.tree {
            if let (Some(&from), Some(to)) = (drawn.nodes.get(&edge.node), parent(source, edge)) {
                picture.line(panel.at(from), panel.at(to), LINK);
            }
        }
        for edge in &drawn.tree {
            let Some(&node) = drawn.nodes.get(&edge.node) else { continue };
            match edge.depth {
                Some(depth) => picture.disc(panel.at(node), radius, bar.color(f64::from(depth))),
                None => picture.cross(panel.at(node), radius, Stroke::new(WITHOUT, 1.6)),
            }
        }
        for &sink in drawn.sinks.values() {
            picture.square(panel.at(sink), SINK_SIDE, SINK);
        }
        panel.axes.draw(&mut picture);
    }
    Some(picture)
}

/// Where the parent of a node is: stations are the nodes, and then the sinks.
fn parent(source: &Source<'_>, edge: &RecordedEdge) -> Option<Position> {
    let station = NodeId(edge.parent?);
    let nodes = u32::try_from(source.drawn.tree.len()).ok()?;
    let place = match station.0.checked_sub(nodes) {
        None => source.drawn.nodes.get(&station),
        Some(sink) => source.drawn.sinks.get(&NodeId(sink)),
    };
    place.copied()
}

fn sheet(source: &Source<'_>, bar: &ColourBar, radius: f64) -> Sheet {
    let Source { title, drawn, .. } = *source;
    let fill = bar.color(1.0);
    let mut legend = vec![
        Entry { symbol: Symbol::Disc { radius, fill }, text: "node".to_owned() },
        Entry { symbol: Symbol::Line { stroke: LINK, pattern: &[] }, text: "line to its parent".to_owned() },
    ];
    let without = drawn.tree.iter().filter(|edge| edge.depth.is_none()).count();
    if without > 0 {
        let symbol = Symbol::Cross { stroke: Stroke::new(WITHOUT, 1.6) };
        legend.push(Entry { symbol, text: "node without a way".to_owned() });
    }
    if !drawn.sinks.is_empty() {
        let symbol = Symbol::Square { side: SINK_SIDE, fill: SINK };
        legend.push(Entry { symbol, text: "sink".to_owned() });
    }
    legend.extend(source.obstacle_entry());
    let depths: Vec<f64> = drawn.tree.iter().filter_map(|edge| edge.depth).map(f64::from).collect();
    let mut note = vec![counted(drawn.tree.len(), "node")];
    if !depths.is_empty() {
        #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
        let mean = depths.iter().sum::<f64>() / depths.len() as f64;
        note.push(format!("{mean:.1} hops in the mean, {} at most", depths.iter().fold(0.0_f64, |a, &b| a.max(b))));
    }
    if without > 0 {
        note.push(format!("{without} without a way"));
    }
    Sheet { title: format!("{title}: tree at the end"), note: note.join(", "), bar: Some(bar.clone()), legend }
}
