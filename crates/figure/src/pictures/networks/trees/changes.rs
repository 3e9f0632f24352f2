//! How a tree changed: the tree at three instants, beside each other.

use sextant_kernel::SimTime;
use sextant_recording::RecordedEdge;

use super::{CHANGED, DrawnTree, hops_bar, legend};
use crate::paint::picture::{Anchor, Area, Picture, Point};
use crate::pictures::source::Source;
use crate::plot::axes::LABEL_TEXT;
use crate::plot::sheet::{Entry, Sheet, Symbol};

/// The instants, as tenths of the simulated time.
const INSTANTS: [u32; 3] = [1, 5, 10];
/// Width of a plot, compared with that of a tree alone.
const SIZE: f64 = 0.52;
/// Space between two plots, for the numbers of the right one (px).
const BETWEEN: f64 = 72.0;
/// Space above the plots, for their instants (px).
const ABOVE: f64 = 20.0;

/// The figure; `None` if the tree was always the same.
pub(super) fn draw(source: &Source<'_>) -> Option<Picture> {
    let drawn = source.drawn;
    let changes = drawn.parents.iter().filter(|chosen| chosen.is_change).count();
    if changes == 0 && drawn.deaths.is_empty() {
        return None;
    }
    let end = drawn.tree_end;
    let times = INSTANTS.map(|tenths| SimTime::ZERO + (end - SimTime::ZERO) * tenths / 10);
    let trees = times.map(|time| drawn.tree_at(time));
    let all: Vec<&RecordedEdge> = trees.iter().flatten().collect();
    let bar = hops_bar(all.iter().copied());
    let views = source.views_from_above(drawn.sinks.values().copied()).enlarged(SIZE);
    let radius = 0.9 * views.dot_radius(drawn.nodes.len());
    let (width, height) = views.sizes().first().copied()?;
    let mut legend = legend(source, &all, &bar, radius);
    if changes > 0 {
        let symbol = Symbol::Line { stroke: CHANGED, pattern: &[] };
        legend.insert(2, Entry { symbol, text: "another parent than in the plot before".to_owned() });
    }
    let deaths = drawn.deaths.len();
    let note = [(changes, "change of parents", "changes of parents"), (deaths, "node that died", "nodes that died")]
        .into_iter()
        .filter(|&(count, ..)| count > 0)
        .map(|(count, one, several)| format!("{count} {}", if count == 1 { one } else { several }));
    let note = note.collect::<Vec<_>>().join(", ");
    let sheet = Sheet { title: format!("{}: tree over time", source.title), note, bar: Some(bar.clone()), legend };
    let (mut picture, areas) = sheet.lay_out(&[(3.0 * width + 2.0 * BETWEEN, height + ABOVE)]);
    let mut left = areas.first()?.left;
    for (number, time) in times.iter().enumerate() {
        let area = Area { left, top: areas[0].top + ABOVE, width, height };
        let before = number.checked_sub(1).map(|before| trees[before].as_slice());
        let tree = DrawnTree { edges: &trees[number], before, radius, bar: &bar };
        for panel in views.panels(&[area]) {
            tree.draw(source, &panel, &mut picture);
        }
        let at = Point::new(area.left + width / 2.0, area.top - 12.0);
        picture.text(at, &format!("after {} s", (*time - SimTime::ZERO).as_secs_f64()), Anchor::Middle, LABEL_TEXT);
        left += width + BETWEEN;
    }
    Some(picture)
}
