//! The tree at an instant: each node with a line to its parent.

use sextant_kernel::SimTime;
use sextant_kernel::text::counted;
use sextant_recording::RecordedEdge;

use super::{DrawnTree, hops_bar, legend};
use crate::paint::picture::Picture;
use crate::pictures::source::Source;
use crate::plot::sheet::Sheet;

/// The figure at `time`, or at the end.
pub(super) fn draw(source: &Source<'_>, time: Option<SimTime>) -> Picture {
    let drawn = source.drawn;
    let edges = drawn.tree_at(time.unwrap_or(drawn.tree_end));
    let bar = hops_bar(&edges);
    let views = source.views(drawn.sinks.values().copied());
    let radius = 0.9 * views.dot_radius(drawn.nodes.len());
    let when = time
        .map_or_else(|| "at the end".to_owned(), |time| format!("after {} s", (time - SimTime::ZERO).as_secs_f64()));
    let sheet = Sheet {
        title: format!("{}: tree {when}", source.title),
        note: note(&edges),
        bar: Some(bar.clone()),
        legend: legend(source, &edges.iter().collect::<Vec<_>>(), &bar, radius),
    };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    let tree = DrawnTree { edges: &edges, before: None, radius, bar: &bar };
    for panel in views.panels(&areas) {
        tree.draw(source, &panel, &mut picture);
    }
    picture
}

/// A tree in words.
pub(super) fn note(edges: &[RecordedEdge]) -> String {
    let living = || edges.iter().filter(|edge| !edge.is_dead);
    let depths: Vec<f64> = living().filter_map(|edge| edge.depth).map(f64::from).collect();
    let mut note = vec![counted(edges.len(), "node")];
    if !depths.is_empty() {
        #[expect(clippy::cast_precision_loss, reason = "a number of nodes")]
        let mean = depths.iter().sum::<f64>() / depths.len() as f64;
        let most = depths.iter().fold(0.0_f64, |a, &b| a.max(b));
        note.push(format!("{} with a way: {mean:.1} hops in the mean, {most} at most", depths.len()));
    }
    let without = living().filter(|edge| edge.depth.is_none()).count();
    if without > 0 {
        note.push(format!("{without} without a way"));
    }
    let dead = edges.iter().filter(|edge| edge.is_dead).count();
    if dead > 0 {
        note.push(format!("{dead} dead"));
    }
    note.join(", ")
}
