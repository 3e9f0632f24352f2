//! The trees over which packets went: one at an instant, and how it changed.

mod changes;
mod one;

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_kernel::{NodeId, SimTime};
use sextant_recording::RecordedEdge;

use super::network::{SINK, SINK_SIDE};
use crate::paint::file::Figure;
use crate::paint::palette::{ACCENT, OBSTACLE_RIM, Ramp, THREAD};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::sheet::{ColourBar, Entry, Symbol};
use crate::plot::silhouette::draw_solids;
use crate::plot::view::Panel;

/// A line to a parent.
const LINK: Stroke = Stroke::new(THREAD, 1.0);
/// A line to a parent that a node did not have at the instant before.
const CHANGED: Stroke = Stroke::new(ACCENT, 2.0);
/// The mark of a node without a way to a sink.
const WITHOUT: RGBColor = ACCENT;
/// The mark of a node that died.
const DEAD: RGBColor = OBSTACLE_RIM;

/// The figures of the tree over which packets went: `tree`, as it was at `time` or else at the end, and `tree-changes` if nodes
/// changed their parents or died: the tree at three instants. None without a tree, or if the places of nodes are not known.
#[must_use]
pub fn of_tree(source: &Source<'_>, time: Option<SimTime>) -> Vec<Figure> {
    if source.drawn.tree.is_empty() || source.drawn.nodes.is_empty() {
        return Vec::new();
    }
    let figure = |name: &str, picture| Figure { name: name.to_owned(), picture };
    let mut figures = vec![figure("tree", one::draw(source, time))];
    figures.extend(changes::draw(source).map(|picture| figure("tree-changes", picture)));
    figures
}

/// A tree in a plot.
struct DrawnTree<'a> {
    edges: &'a [RecordedEdge],
    /// The tree before, whose links are not marked.
    before: Option<&'a [RecordedEdge]>,
    radius: f64,
    bar: &'a ColourBar,
}

impl DrawnTree<'_> {
    fn draw(&self, source: &Source<'_>, panel: &Panel, picture: &mut Picture) {
        let drawn = source.drawn;
        draw_solids(picture, panel, source.solids());
        let (changed, kept): (Vec<&RecordedEdge>, Vec<&RecordedEdge>) =
            self.edges.iter().filter(|edge| !edge.is_dead).partition(|edge| self.is_changed(edge));
        for (edges, stroke) in [(kept, LINK), (changed, CHANGED)] {
            for edge in edges {
                if let (Some(&from), Some(to)) = (drawn.nodes.get(&edge.node), parent(source, edge)) {
                    picture.line(panel.at(from), panel.at(to), stroke);
                }
            }
        }
        for edge in self.edges {
            let Some(&node) = drawn.nodes.get(&edge.node) else { continue };
            let at = panel.at(node);
            match edge.depth {
                _ if edge.is_dead => picture.ring(at, self.radius, Stroke::new(DEAD, 1.4)),
                Some(depth) => picture.disc(at, self.radius, self.bar.color(f64::from(depth))),
                None => picture.cross(at, self.radius, Stroke::new(WITHOUT, 1.6)),
            }
        }
        for &sink in drawn.sinks.values() {
            picture.square(panel.at(sink), SINK_SIDE, SINK);
        }
        panel.axes.draw(picture);
    }

    /// Whether a node had another parent at the instant before.
    fn is_changed(&self, edge: &RecordedEdge) -> bool {
        let before = self.before.and_then(|before| before.get(edge.node.index()));
        before.is_some_and(|before| before.parent != edge.parent)
    }
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

/// The colours of the hops of these trees.
fn hops_bar<'a>(edges: impl IntoIterator<Item = &'a RecordedEdge>) -> ColourBar {
    let deepest = edges.into_iter().filter_map(|edge| edge.depth).max().unwrap_or(1);
    ColourBar {
        name: "hops to a sink".to_owned(),
        low: 0.0,
        high: f64::from(deepest.max(1)),
        open_end: false,
        finest: 1.0,
        ramp: Ramp::Marks,
    }
}

/// The legend of trees with these edges.
fn legend(source: &Source<'_>, edges: &[&RecordedEdge], bar: &ColourBar, radius: f64) -> Vec<Entry> {
    let fill = bar.color(1.0);
    let entry = |symbol, text: &str| Entry { symbol, text: text.to_owned() };
    let mut legend = vec![
        entry(Symbol::Disc { radius, fill }, "node"),
        entry(Symbol::Line { stroke: LINK, pattern: &[] }, "line to its parent"),
    ];
    if edges.iter().any(|edge| edge.depth.is_none() && !edge.is_dead) {
        legend.push(entry(Symbol::Cross { stroke: Stroke::new(WITHOUT, 1.6) }, "node without a way"));
    }
    if edges.iter().any(|edge| edge.is_dead) {
        let stroke = Stroke::new(DEAD, 1.4);
        legend.push(entry(Symbol::Circle { radius: radius.max(2.5), stroke }, "node that died"));
    }
    if !source.drawn.sinks.is_empty() {
        legend.push(entry(Symbol::Square { side: SINK_SIDE, fill: SINK }, "sink"));
    }
    legend.extend(source.obstacle_entry());
    legend
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use sextant_channel::ReceptionLog;
    use sextant_recording::{RecordedParent, RecordedWorld};

    use super::*;
    use crate::paint::picture::Mark;

    /// Three nodes on a line, of which the last one has no way; station 3 is the sink.
    fn world() -> RecordedWorld {
        let place = |i: u32| Position::new(f64::from(i), 0.0, 0.0);
        let edge = |(node, parent, depth)| RecordedEdge { node: NodeId(node), parent, depth, is_dead: false };
        RecordedWorld {
            nodes: (0..3).map(|i| (NodeId(i), place(i))).collect(),
            sinks: [(NodeId(0), Position::new(0.0, 5.0, 0.0))].into(),
            tree: [(0, Some(3), Some(1)), (1, Some(0), Some(2)), (2, None, None)].map(edge).into(),
            tree_end: at(100),
            ..RecordedWorld::default()
        }
    }

    fn at(s: u64) -> SimTime {
        SimTime::ZERO + Duration::from_secs(s)
    }

    fn figures(drawn: &RecordedWorld, time: Option<SimTime>) -> Vec<Figure> {
        let log = ReceptionLog::new(Vec::new(), Vec::new(), Vec::new(), Vec::new()).unwrap();
        let source = Source { title: "t", log: &log, drawn, sector_displacements: &[], claimed_obstacles: &[] };
        of_tree(&source, time)
    }

    fn words(figure: &Figure) -> Vec<&str> {
        figure
            .picture
            .marks
            .iter()
            .filter_map(|mark| match mark {
                Mark::Text { text, .. } => Some(text.as_str()),
                _ => None,
            })
            .collect()
    }

    fn lines(figure: &Figure, stroke: Stroke) -> usize {
        let is =
            |mark: &&Mark| matches!(mark, Mark::Path { points, stroke: own } if points.len() == 2 && *own == stroke);
        figure.picture.marks.iter().filter(is).count()
    }

    #[test]
    fn a_tree_has_a_line_to_each_parent_and_a_cross_where_there_is_none() {
        let drawn = world();
        let figures = figures(&drawn, None);
        let [tree] = &figures[..] else { panic!("no changes, so one figure") };
        let words = words(tree);
        assert!(
            words.contains(&"3 nodes, 2 with a way: 1.5 hops in the mean, 2 at most, 1 without a way"),
            "{words:?}"
        );
        assert!(words.contains(&"node without a way") && words.contains(&"t: tree at the end"), "{words:?}");
        // The legend has one too.
        assert_eq!(lines(tree, LINK), 2 + 1);
        let without = RecordedWorld { tree: Vec::new(), ..drawn };
        assert!(self::figures(&without, None).is_empty());
    }

    #[test]
    fn a_tree_at_an_instant_has_the_links_of_then_and_marks_the_dead() {
        let chosen =
            |(s, node, parent)| RecordedParent { time: at(s), node: NodeId(node), parent, is_change: s > 10 };
        let parents = [(1, 0, Some(3)), (2, 1, Some(0)), (3, 2, Some(1)), (40, 2, Some(0)), (90, 2, None)];
        let drawn =
            RecordedWorld { parents: parents.map(chosen).into(), deaths: [(NodeId(1), at(60))].into(), ..world() };
        let figures_at = figures(&drawn, Some(at(20)));
        let [tree, changes] = &figures_at[..] else { panic!("a tree and its changes") };
        assert!(words(tree).contains(&"t: tree after 20 s"), "{:?}", words(tree));
        assert!(words(tree).contains(&"3 nodes, 3 with a way: 2.0 hops in the mean, 3 at most"), "{:?}", words(tree));
        assert_eq!(lines(tree, LINK), 3 + 1);
        // After 10, 50 and 100 s: three links; one of them changed; one lost, and one node dead.
        assert_eq!((lines(changes, LINK), lines(changes, CHANGED)), (3 + 2 + 1 + 1, 1 + 1));
        assert!(words(changes).contains(&"node that died"), "{:?}", words(changes));
        let end = &figures(&drawn, None)[0];
        assert!(
            words(end).contains(&"3 nodes, 1 with a way: 1.0 hops in the mean, 1 at most, 1 without a way, 1 dead"),
            "{:?}",
            words(end)
        );
    }
}
