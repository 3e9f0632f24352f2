//! The sector displacement of all maps, as bars.

use crate::paint::palette::CURVES;
use crate::paint::picture::{Area, Picture};
use crate::pictures::source::Source;
use crate::plot::axes::{Axes, Axis, Shown};
use crate::plot::sheet::{Entry, Sheet, Symbol};

/// Size of the plot (px).
const SIZE: (f64, f64) = (560.0, 320.0);
/// Width of all bars of one displacement together; displacements are 1 apart.
const GROUP: f64 = 0.8;
/// Side of a square in the legend (px).
const SIDE: f64 = 12.0;

/// The figure; `None` if no map has a sector displacement.
pub(crate) fn draw(source: &Source<'_>) -> Option<Picture> {
    let maps = source.sector_displacements;
    let classes = maps.iter().map(|(_, shares)| shares.len()).max().filter(|&classes| classes > 0)?;
    let color = |i: usize| CURVES[i % CURVES.len()];
    let entry = |(i, (name, shares)): (usize, &(String, Vec<f64>))| Entry {
        symbol: Symbol::Square { side: SIDE, fill: color(i) },
        text: format!("{name}: {:.0} % of the nodes not displaced", 100.0 * shares.first().unwrap_or(&0.0)),
    };
    let sheet = Sheet {
        title: format!("{}: sector displacement", source.title),
        note: "sectors by which the antenna of a node would miss its neighbours if it followed the map".to_owned(),
        bar: None,
        legend: maps.iter().enumerate().map(entry).collect(),
    };
    let (mut picture, areas) = sheet.lay_out(&[SIZE]);
    let axes = Axes {
        across: Axis {
            low: -0.6,
            high: classes as f64 - 0.4,
            name: "sector displacement of a node".to_owned(),
            shown: Shown::All,
        },
        up: Axis { low: 0.0, high: 1.02, name: "share of nodes".to_owned(), shown: Shown::All },
        area: areas[0],
    };
    axes.draw_grid(&mut picture);
    let width = GROUP / maps.len() as f64;
    for (i, (_, shares)) in maps.iter().enumerate() {
        for (class, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let left = class as f64 - GROUP / 2.0 + i as f64 * width;
            let (from, to) = (axes.at(left, share), axes.at(left + width, 0.0));
            let area = Area { left: from.x, top: from.y, width: to.x - from.x, height: to.y - from.y };
            picture.rectangle(area, color(i));
        }
    }
    axes.draw(&mut picture);
    Some(picture)
}
