//! A map compared with the truth where dots would overlap: the mean error of the nodes in each cell.

use plotters::style::RGBColor;
use sextant_kernel::NodeId;
use sextant_mapper::PositionError;
use sextant_recording::Places;

use super::claims;
use super::map::heading;
use crate::paint::palette::ACCENT;
use crate::paint::picture::Picture;
use crate::pictures::source::Source;
use crate::plot::density::{self, Cell, Density};
use crate::plot::sheet::{Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;

/// A cell with nodes that are not mapped.
const ABSENT: RGBColor = ACCENT;
/// Side of its square (px).
const ABSENT_SIDE: f64 = 2.0;

/// The figure of the map `name`. The errors of a cell are those of the nodes that the map places there; without true
/// positions, the cells show the number of nodes.
pub(crate) fn draw(source: &Source<'_>, name: &str, places: &Places) -> Picture {
    let truth = &source.drawn.nodes;
    let errors = source.errors(places);
    let distribution = PositionError::of(&errors.iter().map(|&(_, error_m)| error_m).collect::<Vec<_>>());
    let views = source.views(places.values().copied());
    let has_errors = !errors.is_empty();
    let densities = if has_errors {
        Density::all(&views, errors.iter().map(|(node, error_m)| (places[node], *error_m)))
    } else {
        Density::all(&views, places.values().map(|&place| (place, 0.0)))
    };
    let value = if has_errors { Cell::mean } else { Cell::points };
    let values: Vec<f64> = densities.iter().flat_map(Density::cells).filter_map(value).collect();
    let bar = if has_errors {
        density::bar("position error [m], mean of a cell".to_owned(), values, 0.0)
    } else {
        density::bar("nodes per cell".to_owned(), values, 1.0)
    };
    let absent: Vec<NodeId> = truth.keys().copied().filter(|node| !places.contains_key(node)).collect();
    let absent = Density::all(&views, absent.iter().map(|node| (truth[node], 0.0)));
    let mut legend = Vec::new();
    if absent.iter().flat_map(Density::cells).any(|cell| cell.count > 0) {
        let symbol = Symbol::Square { side: 2.0 * ABSENT_SIDE, fill: ABSENT };
        legend.push(Entry { symbol, text: "cell with nodes that are not mapped".to_owned() });
    }
    legend.extend(source.obstacle_entry());
    let claims = source.claims_of(name);
    legend.extend(claims::entries(claims));
    let (title, note) = heading(source, name, places.len(), distribution);
    let with_nodes = densities.first().map_or(0, |nodes| nodes.cells().iter().filter(|cell| cell.count > 0).count());
    let per_cell = errors.len().max(places.len()) as f64 / with_nodes.max(1) as f64;
    let note = format!("{note}; cells of {:.3} m with {per_cell:.1} nodes on average", density::cell_m(&views));
    let sheet = Sheet { title, note, bar: Some(bar.clone()), legend };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    for ((panel, nodes), absent) in views.panels(&areas).iter().zip(&densities).zip(&absent) {
        nodes.draw(&mut picture, panel.axes.area, &bar, value);
        draw_solids(&mut picture, panel, source.solids());
        claims::draw(&mut picture, panel, claims);
        for at in absent.middles(panel.axes.area) {
            picture.square(at, ABSENT_SIDE, ABSENT);
        }
        panel.axes.draw(&mut picture);
    }
    picture
}
