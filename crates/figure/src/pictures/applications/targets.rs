//! Targets among the sensors of the nodes: the discs of detection, the ways, and where targets were first and last
//! detected.

use std::collections::BTreeSet;

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_kernel::NodeId;

use sextant_kernel::text::counted;
use sextant_recording::{Detection, RecordedWorld, Sensation};

use crate::paint::palette::{INK, PAPER, of_target};
use crate::paint::picture::{Picture, Point, Stroke};
use crate::pictures::source::Source;
use crate::plot::sheet::{Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;
use crate::plot::view::Extent;

/// The disc within which a node detects targets.
const DISC: RGBColor = RGBColor(0xee, 0xf3, 0xf7);
/// The rim of a disc that a target entered.
const RIM: Stroke = Stroke::new(RGBColor(0xa9, 0xbf, 0xcf), 1.0);
/// Radius of the mark of a crossing (px).
const CROSSING: f64 = 3.0;
/// Half the side of the mark of a start (px).
const START: f64 = 4.0;

/// The figure; `None` without targets.
pub(crate) fn draw(source: &Source<'_>) -> Option<Picture> {
    let drawn = source.drawn;
    if drawn.targets.is_empty() {
        return None;
    }
    let views = source.views(ways(drawn).chain(rims(drawn)));
    let radius = 0.6 * views.dot_radius(drawn.nodes.len());
    let detecting = detecting(&drawn.detections);
    let (mut picture, areas) = sheet(source, radius).lay_out(&views.sizes());
    for panel in views.panels(&areas) {
        if let Some(radius_m) = drawn.detection_radius_m {
            let disc = radius_m * panel.px_per_m();
            for &node in drawn.nodes.values() {
                picture.disc(panel.at(node), disc, DISC);
            }
            for node in detecting.iter().filter_map(|node| drawn.nodes.get(node)) {
                picture.ring(panel.at(*node), disc, RIM);
            }
        }
        draw_solids(&mut picture, &panel, source.solids());
        for &node in drawn.nodes.values() {
            picture.disc(panel.at(node), radius, INK);
        }
        for (i, target) in drawn.targets.iter().enumerate() {
            let points: Vec<Point> = target.way.places().map(|place| panel.at(place)).collect();
            picture.path(points.clone(), way(i));
            if let Some(&start) = points.first() {
                picture.square(start, 2.0 * START, of_target(i));
            }
        }
        for (i, target) in drawn.targets.iter().enumerate() {
            for detection in drawn.detections.iter().filter(|detection| detection.target == target.name) {
                let Some(place) = target.way.at(detection.time) else { continue };
                let at = panel.at(place);
                picture.disc(at, CROSSING, of_target(i));
                if detection.sensation == Sensation::Left {
                    picture.disc(at, CROSSING - 1.2, PAPER);
                }
            }
        }
        panel.axes.draw(&mut picture);
    }
    Some(picture)
}

fn sheet(source: &Source<'_>, radius: f64) -> Sheet {
    let Source { title, drawn, .. } = *source;
    let mut legend = vec![Entry { symbol: Symbol::Disc { radius, fill: INK }, text: "node".to_owned() }];
    if let Some(radius_m) = drawn.detection_radius_m {
        let text = format!("radius of detection, {radius_m} m");
        legend.push(Entry { symbol: Symbol::Body { fill: DISC, rim: Stroke::new(DISC, 1.0) }, text });
        if !drawn.detections.is_empty() {
            let text = "around a node that detected a target".to_owned();
            legend.push(Entry { symbol: Symbol::Body { fill: DISC, rim: RIM }, text });
        }
    }
    for (i, target) in drawn.targets.iter().enumerate() {
        let symbol = Symbol::Line { stroke: way(i), pattern: &[] };
        legend.push(Entry { symbol, text: format!("way of {}", target.name) });
    }
    legend.push(Entry { symbol: Symbol::Square { side: 2.0 * START, fill: INK }, text: "start".to_owned() });
    if !drawn.detections.is_empty() {
        let mark = Symbol::Disc { radius: CROSSING, fill: INK };
        legend.push(Entry { symbol: mark, text: "enters a disc".to_owned() });
        let mark = Symbol::Circle { radius: CROSSING, stroke: Stroke::new(INK, 1.2) };
        legend.push(Entry { symbol: mark, text: "leaves a disc".to_owned() });
    }
    legend.extend(source.obstacle_entry());
    let count = drawn.detections.iter().filter(|detection| detection.sensation == Sensation::Entered).count();
    let length_m: f64 = drawn.targets.iter().map(|target| target.way.length_m()).sum();
    let note = [
        counted(drawn.nodes.len(), "node"),
        counted(drawn.targets.len(), "target"),
        format!("ways of {length_m:.0} m"),
        format!("{} by {}", counted(count, "detection"), counted(detecting(&drawn.detections).len(), "node")),
    ];
    Sheet { title: format!("{title}: targets and detections"), note: note.join(", "), bar: None, legend }
}

fn ways(drawn: &RecordedWorld) -> impl Iterator<Item = Position> {
    drawn.targets.iter().flat_map(|target| target.way.places())
}

/// The corners of boxes around the discs of all nodes, so that the discs are in the picture.
fn rims(drawn: &RecordedWorld) -> impl Iterator<Item = Position> {
    let radius_m = drawn.detection_radius_m.unwrap_or(0.0);
    let flat = Extent::around(drawn.nodes.values().copied().chain(ways(drawn))).is_none_or(|extent| extent.is_flat());
    let reach = Position::new(radius_m, radius_m, if flat { 0.0 } else { radius_m });
    drawn.nodes.values().flat_map(move |&node| [node - reach, node + reach])
}

/// The nodes that detected a target.
fn detecting(detections: &[Detection]) -> BTreeSet<NodeId> {
    detections.iter().map(|detection| detection.node).collect()
}

/// The line style of the `i`th target.
fn way(i: usize) -> Stroke {
    Stroke::new(of_target(i), 1.6)
}
