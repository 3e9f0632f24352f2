//! The network and the survey where dots would overlap: how many nodes, and how much was heard at the stops.

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_kernel::text::counted;

use super::network;
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::density::{self, Cell, Density};
use crate::plot::sheet::{Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;
use crate::plot::view::{Panel, Views};

/// A stop.
const STOP: RGBColor = RGBColor(0xe6, 0x9f, 0x00);
/// Paths that would cover more than this share of a plot are left out.
const MOST_INK: f64 = 0.3;
/// Points of a path that are closer to the last one are left out (px).
const FINEST: f64 = 0.3;

/// What is drawn as cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Crowds {
    pub(crate) nodes: bool,
    pub(crate) stops: bool,
}

/// The figure of the nodes. Stops that are crowded are left out.
pub(crate) fn draw(source: &Source<'_>, crowds: Crowds) -> Picture {
    let Source { title, log, drawn, .. } = *source;
    let views = source.views(source.survey().chain(drawn.sinks.values().copied()));
    let densities = Density::all(&views, drawn.nodes.values().map(|&place| (place, 0.0)));
    let counts = densities.first().into_iter().flat_map(Density::cells).filter_map(Cell::points).collect();
    let bar = density::bar("nodes per cell".to_owned(), counts, 1.0);
    let side = 2.2 * views.dot_radius(log.stops().len());
    let radius = 0.75 * views.dot_radius(drawn.nodes.len());
    let has_paths = has_room_for_paths(source, &views);
    let mut legend = Vec::new();
    if !crowds.nodes && !drawn.nodes.is_empty() {
        legend.push(Entry { symbol: Symbol::Disc { radius, fill: network::NODE }, text: "node".to_owned() });
    }
    if !drawn.sinks.is_empty() {
        let symbol = Symbol::Square { side: network::SINK_SIDE, fill: network::SINK };
        legend.push(Entry { symbol, text: "sink".to_owned() });
    }
    let has_stops = !log.stops().is_empty() && !crowds.stops;
    if has_stops {
        legend.push(Entry { symbol: Symbol::Square { side, fill: STOP }, text: "stop".to_owned() });
    }
    if has_paths {
        legend.extend(network::path_entries(source));
    }
    if !log.contacts().is_empty() {
        let symbol = Symbol::Cross { stroke: network::CONTACT };
        legend.push(Entry { symbol, text: "contact of a range sensor".to_owned() });
    }
    legend.extend(source.obstacle_entry());
    let mut note = network::contents(source);
    if crowds.nodes {
        note.push(format!("cells of {:.3} m", density::cell_m(&views)));
    }
    if !drawn.paths.is_empty() && !has_paths {
        note.push("paths are too dense to draw".to_owned());
    }
    let shown_bar = crowds.nodes.then(|| bar.clone());
    let sheet = Sheet { title: format!("{title}: network"), note: note.join(", "), bar: shown_bar, legend };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    let contacts = Density::all(&views, log.contacts().iter().map(|contact| (contact.position, 0.0)));
    for ((panel, nodes), contacts) in views.panels(&areas).iter().zip(&densities).zip(&contacts) {
        if crowds.nodes {
            nodes.draw(&mut picture, panel.axes.area, &bar, Cell::points);
        }
        draw_solids(&mut picture, panel, source.solids());
        if has_paths {
            draw_paths(&mut picture, panel, source);
        }
        for stop in log.stops().iter().filter(|_| has_stops) {
            picture.square(panel.at(stop.position), side, STOP);
        }
        for &node in drawn.nodes.values().filter(|_| !crowds.nodes) {
            picture.disc(panel.at(node), radius, network::NODE);
        }
        for &sink in drawn.sinks.values() {
            picture.square(panel.at(sink), network::SINK_SIDE, network::SINK);
        }
        for at in contacts.middles(panel.axes.area) {
            picture.cross(at, 3.5, network::CONTACT);
        }
        panel.axes.draw(&mut picture);
    }
    picture
}

/// The figure of the stops.
pub(crate) fn draw_survey(source: &Source<'_>) -> Picture {
    let Source { title, log, drawn, .. } = *source;
    let views = source.views(source.survey().chain(drawn.sinks.values().copied()));
    let heard = network::nodes_heard(log);
    let stops = log.stops().iter().zip(&heard).map(|(stop, &heard)| (stop.position, f64::from(heard)));
    let densities = Density::all(&views, stops);
    let means = densities.iter().flat_map(Density::cells).filter_map(Cell::mean).collect();
    let bar = density::bar("nodes heard at a stop, mean of a cell".to_owned(), means, 0.0);
    let note = format!(
        "{}, {} heard at a stop on average, cells of {:.3} m",
        counted(log.stops().len(), "stop"),
        counted_mean(&heard),
        density::cell_m(&views)
    );
    let legend = source.obstacle_entry().into_iter().collect();
    let sheet = Sheet { title: format!("{title}: survey"), note, bar: Some(bar.clone()), legend };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    for (panel, stops) in views.panels(&areas).iter().zip(&densities) {
        stops.draw(&mut picture, panel.axes.area, &bar, Cell::mean);
        draw_solids(&mut picture, panel, source.solids());
        panel.axes.draw(&mut picture);
    }
    picture
}

fn counted_mean(heard: &[u32]) -> String {
    let sum: f64 = heard.iter().map(|&heard| f64::from(heard)).sum();
    format!("{:.1} nodes", sum / heard.len().max(1) as f64)
}

/// Whether the paths leave most of the plot free.
fn has_room_for_paths(source: &Source<'_>, views: &Views) -> bool {
    let length_m: f64 = source.drawn.paths.iter().map(|(_, path)| network::length_m(path)).sum();
    let plot: f64 = views.sizes().first().map_or(0.0, |(width, height)| width * height);
    let ink = length_m * views.px_per_m() * network::PATH_WIDTH;
    length_m > 0.0 && ink <= MOST_INK * plot
}

/// Draws the paths without the points that nobody could see.
fn draw_paths(picture: &mut Picture, panel: &Panel, source: &Source<'_>) {
    for (robot, path) in &source.drawn.paths {
        let mut points = Vec::new();
        let last: Option<&Position> = path.last();
        for at in path.iter().map(|&place| panel.at(place)) {
            if points.last().is_none_or(|&before| at.distance(before) >= FINEST) {
                points.push(at);
            }
        }
        points.extend(last.map(|&place| panel.at(place)));
        picture.path(points, Stroke::new(source.color_of_robot(robot), network::PATH_WIDTH));
    }
}
