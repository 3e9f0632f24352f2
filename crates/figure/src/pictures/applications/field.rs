//! A scalar field at an instant, and what the nodes last read of it.

use std::collections::BTreeMap;

use sextant_kernel::NodeId;

use sextant_kernel::text::counted;
use sextant_recording::{RecordedField, RecordedWorld};

use crate::paint::palette::{INK, PAPER, Ramp};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::cells;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_rims;
use crate::plot::view::{Extent, View, Views};

const RIM: Stroke = Stroke::new(INK, 1.2);

/// The figure.
pub(crate) fn draw(source: &Source<'_>, field: &RecordedField) -> Picture {
    let drawn = source.drawn;
    let plane = &field.plane;
    let readings = readings(drawn, field);
    let bar = colour_bar(drawn, field);
    let corners = cells::corners(plane);
    let extent = Extent::around(corners.into_iter().chain(drawn.nodes.values().copied())).unwrap_or_default();
    let views = Views::new(&extent, &[View::Top]);
    let radius = 1.3 * views.dot_radius(drawn.nodes.len());
    let mut legend = Vec::new();
    if readings.is_empty() {
        legend.push(Entry { symbol: Symbol::Disc { radius: 0.5 * radius, fill: INK }, text: "node".to_owned() });
    } else {
        let fill = bar.color(0.5 * (bar.low + bar.high));
        legend.push(Entry { symbol: Symbol::Disc { radius, fill }, text: "node, last reading".to_owned() });
    }
    if !drawn.obstacles.is_empty() {
        let symbol = Symbol::Line { stroke: RIM, pattern: &[] };
        legend.push(Entry { symbol, text: "outline of an obstacle".to_owned() });
    }
    let highest = plane.values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let sheet = Sheet {
        title: format!("{}: {} at {} s", source.title, field.name, field.time.as_secs_f64()),
        note: format!(
            "plane z = {:.2} m, grid of {} m, highest value {highest:.2}; {} with a reading",
            plane.first.z_m,
            plane.step_m,
            counted(readings.len(), "node")
        ),
        bar: Some(bar.clone()),
        legend,
    };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    let share = |value: f64| (value - bar.low) / (bar.high - bar.low);
    let shares: Vec<f64> = plane.values.iter().map(|&value| share(value).max(0.0)).collect();
    for panel in views.panels(&areas) {
        cells::draw(&mut picture, &panel, plane, &shares, bar.ramp);
        draw_rims(&mut picture, &panel, source.solids(), RIM);
        for (node, &place) in &drawn.nodes {
            match readings.get(node) {
                Some(&value) => {
                    picture.disc(panel.at(place), radius + 1.6, INK);
                    picture.disc(panel.at(place), radius + 0.8, PAPER);
                    picture.disc(panel.at(place), radius, bar.color(value));
                }
                None => picture.disc(panel.at(place), 0.5 * radius, INK),
            }
        }
        panel.axes.draw(&mut picture);
    }
    picture
}

/// The last reading of each node before the instant of `field`.
fn readings(drawn: &RecordedWorld, field: &RecordedField) -> BTreeMap<NodeId, f64> {
    let earlier = drawn.samples.iter().filter(|sample| sample.field == field.name && sample.time <= field.time);
    earlier.map(|sample| (sample.node, sample.value)).collect()
}

/// The colour bar, the same for all instants of a field.
fn colour_bar(drawn: &RecordedWorld, field: &RecordedField) -> ColourBar {
    let instants = drawn.fields.iter().filter(|other| other.name == field.name);
    let values = || instants.clone().flat_map(|other| &other.plane.values).copied();
    let low = values().fold(0.0, f64::min);
    let high = values().fold(low, f64::max);
    let high = if high > low { high } else { low + 1.0 };
    ColourBar { name: "value of the field".to_owned(), low, high, open_end: false, finest: 0.0, ramp: Ramp::Areas }
}
