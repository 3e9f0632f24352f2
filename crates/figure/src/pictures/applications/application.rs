//! An application: who went where among nodes, obstacles and, if a source is sought, the field.

use sextant_channel::Position;

use sextant_kernel::text::counted;
use sextant_recording::{RecordedApplication, RecordedField};

use crate::paint::palette::{ACCENT, INK, PAPER, Ramp, THREAD, of_target};
use crate::paint::picture::{Picture, Point, Stroke};
use crate::pictures::source::Source;
use crate::plot::cells;
use crate::plot::contour::contour;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::silhouette::{draw_rims, draw_solids};
use crate::plot::view::{Panel, View};

/// Number of thin contours.
const CONTOURS: u32 = 8;
const CONTOUR: Stroke = Stroke::new(PAPER, 0.7);
const LEVEL: Stroke = Stroke::new(ACCENT, 2.4);
const LEVEL_CASING: Stroke = Stroke::new(PAPER, 4.2);
const RIM: Stroke = Stroke::new(INK, 1.2);
const CAPTURE: Stroke = Stroke::new(INK, 2.2);
const CAPTURE_CASING: Stroke = Stroke::new(PAPER, 4.6);
/// Half the side of the mark of a start (px).
const START: f64 = 4.0;
/// Radius of the mark of a place where a target was thought to be (px).
const THOUGHT: f64 = 2.0;

/// The figure.
pub(crate) fn draw(source: &Source<'_>, application: &RecordedApplication) -> Picture {
    let field = field(application);
    let bar = field.map(colour_bar);
    let cells = field.into_iter().flat_map(|field| cells::corners(&field.plane));
    let views = source.views(places(application).chain(cells));
    let radius = 0.6 * views.dot_radius(source.drawn.nodes.len());
    let (mut picture, areas) = sheet(source, application, radius, bar.as_ref()).lay_out(&views.sizes());
    for panel in views.panels(&areas) {
        match field.zip(bar.as_ref()).filter(|_| panel.view == View::Top) {
            Some((field, bar)) => {
                draw_field(&mut picture, &panel, field, bar, application.level);
                draw_rims(&mut picture, &panel, source.solids(), RIM);
            }
            None => draw_solids(&mut picture, &panel, source.solids()),
        }
        for &node in source.drawn.nodes.values() {
            picture.disc(panel.at(node), radius, if field.is_some() { THREAD } else { INK });
        }
        draw_ways(&mut picture, &panel, source, application);
        panel.axes.draw(&mut picture);
    }
    picture
}

/// The field that is sought as it was at the beginning.
fn field(application: &RecordedApplication) -> Option<&RecordedField> {
    let name = application.field.as_ref()?;
    application.fields.iter().find(|field| field.name == *name)
}

fn colour_bar(field: &RecordedField) -> ColourBar {
    let low = field.plane.values.iter().copied().fold(0.0, f64::min);
    let high = field.plane.values.iter().copied().fold(low, f64::max);
    let high = if high > low { high } else { low + 1.0 };
    ColourBar { name: "value of the field".to_owned(), low, high, open_end: false, finest: 0.0, ramp: Ramp::Areas }
}

fn draw_field(picture: &mut Picture, panel: &Panel, field: &RecordedField, bar: &ColourBar, level: Option<f64>) {
    let share = |value: f64| (value - bar.low) / (bar.high - bar.low);
    let shares: Vec<f64> = field.plane.values.iter().map(|&value| share(value).max(0.0)).collect();
    cells::draw(picture, panel, &field.plane, &shares, bar.ramp);
    let mut line = |value: f64, stroke: Stroke| {
        for [from, to] in contour(&field.plane, value) {
            picture.line(panel.at(from), panel.at(to), stroke);
        }
    };
    for i in 1..=CONTOURS {
        line(bar.low + (bar.high - bar.low) * f64::from(i) / f64::from(CONTOURS + 1), CONTOUR);
    }
    if let Some(level) = level {
        line(level, LEVEL_CASING);
        line(level, LEVEL);
    }
}

/// The ways of targets and robots, the places where targets were thought to be, and the captures.
fn draw_ways(picture: &mut Picture, panel: &Panel, source: &Source<'_>, application: &RecordedApplication) {
    let way =
        |places: &mut dyn Iterator<Item = Position>| places.map(|place| panel.at(place)).collect::<Vec<Point>>();
    for thought in &application.target_places {
        let i = application.targets.iter().position(|target| target.name == thought.target).unwrap_or(0);
        picture.disc(panel.at(thought.place), THOUGHT, of_target(i));
    }
    for (i, target) in application.targets.iter().enumerate() {
        let points = way(&mut target.way.places());
        picture.path(points.clone(), Stroke::new(of_target(i), 1.6));
        if let Some(&start) = points.first() {
            picture.square(start, 2.0 * START, of_target(i));
        }
    }
    for (robot, path) in &application.paths {
        let color = source.color_of_robot(robot);
        let points = way(&mut path.iter().copied());
        picture.path(points.clone(), Stroke::new(PAPER, 4.0));
        picture.path(points.clone(), Stroke::new(color, 2.2));
        if let Some(&start) = points.first() {
            picture.square(start, 2.0 * START, color);
        }
    }
    for capture in &application.captures {
        picture.ring(panel.at(capture.place), 6.5, CAPTURE_CASING);
        picture.ring(panel.at(capture.place), 6.5, CAPTURE);
    }
}

/// All places that must be in the picture.
fn places(application: &RecordedApplication) -> impl Iterator<Item = Position> {
    let paths = application.paths.iter().flat_map(|(_, path)| path).copied();
    let ways = application.targets.iter().flat_map(|target| target.way.places());
    paths.chain(ways).chain(application.captures.iter().map(|capture| capture.place))
}

fn sheet(source: &Source<'_>, application: &RecordedApplication, radius: f64, bar: Option<&ColourBar>) -> Sheet {
    let node = if bar.is_some() { THREAD } else { INK };
    let mut legend = vec![Entry { symbol: Symbol::Disc { radius, fill: node }, text: "node".to_owned() }];
    let line = |color, width| Symbol::Line { stroke: Stroke::new(color, width), pattern: &[] };
    for (robot, _) in &application.paths {
        legend.push(Entry { symbol: line(source.color_of_robot(robot), 2.2), text: format!("path of {robot}") });
    }
    for (i, target) in application.targets.iter().enumerate() {
        legend.push(Entry { symbol: line(of_target(i), 1.6), text: format!("way of {}", target.name) });
    }
    legend.push(Entry { symbol: Symbol::Square { side: 2.0 * START, fill: INK }, text: "start".to_owned() });
    if !application.target_places.is_empty() {
        let symbol = Symbol::Disc { radius: THOUGHT, fill: of_target(0) };
        legend.push(Entry { symbol, text: "where a target was thought to be".to_owned() });
    }
    if !application.captures.is_empty() {
        let symbol = Symbol::Ring { stroke: CAPTURE, casing: CAPTURE_CASING };
        legend.push(Entry { symbol, text: "capture".to_owned() });
    }
    if let Some(level) = application.level.filter(|_| bar.is_some()) {
        legend.push(Entry { symbol: Symbol::Line { stroke: LEVEL, pattern: &[] }, text: format!("level {level}") });
    }
    if bar.is_none() {
        legend.extend(source.obstacle_entry());
    } else if !source.solids().is_empty() {
        legend.push(Entry { symbol: line(INK, 1.2), text: "outline of an obstacle".to_owned() });
    }
    let length_m: f64 = application
        .paths
        .iter()
        .map(|(_, path)| path.windows(2).map(|pair| pair[0].distance_m(pair[1])).sum::<f64>())
        .sum();
    let mut note = vec![format!("map {}", application.map), counted(source.drawn.nodes.len(), "node")];
    if !application.targets.is_empty() && application.field.is_none() {
        let captured = application.captures.len();
        note.push(format!("{captured} of {} captured", counted(application.targets.len(), "target")));
    }
    note.push(format!("path of {length_m:.0} m"));
    let RecordedApplication { name, algorithm, .. } = application;
    let what = if name == algorithm { name.clone() } else { format!("{name} ({algorithm})") };
    Sheet { title: format!("{}: {what}", source.title), note: note.join(", "), bar: bar.cloned(), legend }
}
