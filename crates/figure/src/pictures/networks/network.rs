//! The network and the survey: nodes, obstacles, and the paths, stops and contacts of the robots.

use plotters::style::RGBColor;
use sextant_channel::{Position, ReceptionLog};

use crate::paint::palette::{ACCENT, INK, Ramp, THREAD};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;
use sextant_kernel::text::counted;

pub(crate) const NODE: RGBColor = INK;
pub(crate) const SINK: RGBColor = ACCENT;
/// Side of the square of a sink (px).
pub(crate) const SINK_SIDE: f64 = 10.0;
pub(crate) const CONTACT: Stroke = Stroke::new(ACCENT, 1.6);

/// A path as it was believed to be, beside the estimated one.
const BELIEVED: Stroke = Stroke::new(THREAD, 1.0);

/// Width of a path (px).
pub(crate) const PATH_WIDTH: f64 = 1.4;

/// The figure.
pub(crate) fn draw(source: &Source<'_>) -> Picture {
    let Source { log, drawn, .. } = *source;
    let heard = nodes_heard(log);
    let most = heard.iter().copied().max().unwrap_or(0);
    let bar = ColourBar {
        name: "nodes heard at the stop".to_owned(),
        low: 0.0,
        high: f64::from(most.max(1)),
        open_end: false,
        finest: 1.0,
        ramp: Ramp::Marks,
    };
    let views = source.views(source.survey().chain(drawn.sinks.values().copied()));
    let radius = 0.75 * views.dot_radius(drawn.nodes.len());
    let side = 2.2 * views.dot_radius(log.stops().len().max(drawn.nodes.len()));
    let (picture, areas) = sheet(source, &bar, radius, side).lay_out(&views.sizes());
    let mut picture = picture;
    for panel in views.panels(&areas) {
        draw_solids(&mut picture, &panel, source.solids());
        for (_, path) in &drawn.believed_paths {
            picture.path(path.iter().map(|&place| panel.at(place)).collect(), BELIEVED);
        }
        for (robot, path) in &drawn.paths {
            picture.path(path.iter().map(|&place| panel.at(place)).collect(), track(source, robot));
        }
        for (stop, &heard) in log.stops().iter().zip(&heard) {
            picture.square(panel.at(stop.position), side, bar.color(f64::from(heard)));
        }
        for &node in drawn.nodes.values() {
            picture.disc(panel.at(node), radius, NODE);
        }
        for &sink in drawn.sinks.values() {
            picture.square(panel.at(sink), SINK_SIDE, SINK);
        }
        for contact in log.contacts() {
            picture.cross(panel.at(contact.position), 3.5, CONTACT);
        }
        panel.axes.draw(&mut picture);
    }
    picture
}

fn sheet(source: &Source<'_>, bar: &ColourBar, radius: f64, side: f64) -> Sheet {
    let Source { title, log, drawn, .. } = *source;
    let mut legend = Vec::new();
    if !drawn.nodes.is_empty() {
        legend.push(Entry { symbol: Symbol::Disc { radius, fill: NODE }, text: "node".to_owned() });
    }
    if !drawn.sinks.is_empty() {
        let symbol = Symbol::Square { side: SINK_SIDE, fill: SINK };
        legend.push(Entry { symbol, text: "sink".to_owned() });
    }
    let has_stops = !log.stops().is_empty();
    if has_stops {
        let fill = bar.color(0.7 * bar.high);
        legend.push(Entry { symbol: Symbol::Square { side, fill }, text: "stop".to_owned() });
    }
    legend.extend(path_entries(source));
    legend.extend(drawn.believed_paths.iter().map(|(robot, _)| Entry {
        symbol: Symbol::Line { stroke: BELIEVED, pattern: &[] },
        text: format!("path of {robot} as believed"),
    }));
    if !log.contacts().is_empty() {
        legend
            .push(Entry { symbol: Symbol::Cross { stroke: CONTACT }, text: "contact of a range sensor".to_owned() });
    }
    legend.extend(source.obstacle_entry());
    let what = if has_stops { "network and survey" } else { "network" };
    let bar = has_stops.then(|| bar.clone());
    Sheet { title: format!("{title}: {what}"), note: contents(source).join(", "), bar, legend }
}

/// What the network and the survey have, for the note.
pub(crate) fn contents(source: &Source<'_>) -> Vec<String> {
    let Source { log, drawn, .. } = *source;
    let length_m: f64 = drawn.paths.iter().map(|(_, path)| length_m(path)).sum();
    let mut note =
        vec![counted(log.node_count().max(drawn.nodes.len()), "node"), counted(drawn.obstacles.len(), "obstacle")];
    if !drawn.sinks.is_empty() {
        note.push(counted(drawn.sinks.len(), "sink"));
    }
    if !log.stops().is_empty() {
        note.push(counted(log.stops().len(), "stop"));
    }
    if !drawn.paths.is_empty() {
        note.push(format!("path of {length_m:.0} m"));
    }
    note
}

/// The legend of the paths.
pub(crate) fn path_entries(source: &Source<'_>) -> impl Iterator<Item = Entry> {
    source.drawn.paths.iter().map(|(robot, _)| Entry {
        symbol: Symbol::Line { stroke: track(source, robot), pattern: &[] },
        text: format!("path of {robot}"),
    })
}

/// The line style of a robot.
fn track(source: &Source<'_>, robot: &str) -> Stroke {
    Stroke::new(source.color_of_robot(robot), PATH_WIDTH)
}

/// The number of nodes heard at each stop.
pub(crate) fn nodes_heard(log: &ReceptionLog) -> Vec<u32> {
    let mut heard = vec![0; log.stops().len()];
    for reception in log.receptions().iter().filter(|reception| reception.received > 0) {
        heard[reception.stop as usize] += 1;
    }
    heard
}

pub(crate) fn length_m(path: &[Position]) -> f64 {
    path.windows(2).map(|pair| pair[0].distance_m(pair[1])).sum()
}
