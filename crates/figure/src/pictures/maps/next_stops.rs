//! Where a robot should listen next, over the map that tells it.

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_kernel::text::counted;
use sextant_mapper::TopologyMap;

use super::estimated_map::{PATH, REGION, STOP, STOP_SIDE, draw_region, draw_survey, places, regions};
use crate::paint::file::Figure;
use crate::paint::labels::Labels;
use crate::paint::palette::{CURVES, INK, Ramp};
use crate::paint::picture::{Stroke, TextStyle, Weight};
use crate::pictures::source::Source;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::view::{View, Views};

/// A place to listen at.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedStop {
    /// Its name.
    pub name: String,
    /// Where it is.
    pub place: Position,
    /// The corners of the way to it, the last of which is the place.
    pub way: Vec<Position>,
    /// By how much the expected error of a node falls, on average over the nodes (m).
    pub error_fall_m: f64,
}

/// Side of the square of a planned stop (px).
const SIDE: f64 = 11.0;
/// The way over the planned stops.
const WAY: Stroke = Stroke::new(INK, 1.4);
/// Nodes, which are behind the stops.
const NODE: RGBColor = CURVES[0];
/// Names of stops.
const NAME: TextStyle = TextStyle { em: 11.0, weight: Weight::Bold, color: INK };

/// The figure `next`: the nodes of `map` with their 95 % regions, the stops that there were, and the planned `stops` in the order of
/// their way. Colours show by how much the expected error falls at a stop. The way begins at `start`. `note` says what all stops bring.
#[must_use]
pub fn of_next_stops(
    source: &Source<'_>,
    map: &TopologyMap,
    start: Position,
    stops: &[PlannedStop],
    note: String,
) -> Figure {
    let nodes = places(map);
    let regions = regions(map);
    let most_m = stops.iter().map(|stop| stop.error_fall_m).fold(0.0, f64::max);
    let bar = (most_m > 0.0).then(|| ColourBar {
        name: "fall of the expected error (m)".to_owned(),
        low: 0.0,
        high: most_m,
        open_end: false,
        finest: 0.0,
        ramp: Ramp::Marks,
    });
    let ways = stops.iter().flat_map(|stop| &stop.way).chain([&start]).copied();
    let views: Views = source.views_from_above(source.survey().chain(nodes.values().copied()).chain(ways));
    let radius = views.dot_radius(nodes.len());
    let symbol = |symbol, text: &str| Entry { symbol, text: text.to_owned() };
    let fill = bar.as_ref().map_or(NODE, |bar| bar.color(0.6 * bar.high));
    let mut legend = Vec::new();
    if !stops.is_empty() {
        legend.push(symbol(Symbol::Square { side: SIDE, fill }, "next stop"));
        legend.push(symbol(Symbol::Line { stroke: WAY, pattern: &[] }, "the way to it"));
    }
    legend.push(symbol(Symbol::Disc { radius, fill: NODE }, "mapped node"));
    if !regions.is_empty() {
        legend.push(symbol(Symbol::Circle { radius: 7.0, stroke: REGION }, "its 95 % region"));
    }
    legend.push(symbol(Symbol::Square { side: STOP_SIDE, fill: STOP }, "stop of the log"));
    if !source.drawn.paths.is_empty() {
        legend.push(symbol(Symbol::Line { stroke: PATH, pattern: &[] }, "path"));
    }
    legend.extend(source.obstacle_entry());
    let title = format!("{}: {} to drive to next", source.title, counted(stops.len(), "stop"));
    let sheet = Sheet { title, note, bar, legend };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    for panel in views.panels(&areas) {
        draw_survey(&mut picture, &panel, source);
        for region in &regions {
            draw_region(&mut picture, &panel, region);
        }
        for &node in nodes.values() {
            picture.disc(panel.at(node), radius, NODE);
        }
        let corners = std::iter::once(&start).chain(stops.iter().flat_map(|stop| &stop.way));
        picture.path(corners.map(|&corner| panel.at(corner)).collect(), WAY);
        for stop in stops {
            let fill = sheet.bar.as_ref().map_or(NODE, |bar| bar.color(stop.error_fall_m));
            picture.square(panel.at(stop.place), SIDE, fill);
        }
        if panel.view == View::Top {
            let names = stops.iter().map(|stop| (panel.at(stop.place), stop.name.as_str()));
            Labels::of(names, SIDE / 2.0, [], panel.axes.area, NAME).draw(&mut picture);
        }
        panel.axes.draw(&mut picture);
    }
    Figure { name: "next".to_owned(), picture }
}

#[cfg(test)]
mod tests {
    use sextant_channel::{ReceptionLog, Stop};
    use sextant_mapper::CoordinateFrame;
    use sextant_recording::RecordedWorld;

    use super::*;
    use crate::paint::picture::Mark;

    #[test]
    fn the_stops_are_on_one_way_with_their_names_and_colours() {
        let at = |x_m: f64, y_m: f64| Position::new(x_m, y_m, 0.0);
        let stops = vec![Stop::at(at(0.0, 0.0)), Stop::at(at(5.0, 0.0))];
        let log = ReceptionLog::new(vec!["n".to_owned()], stops, Vec::new(), Vec::new()).unwrap();
        let drawn = RecordedWorld::default();
        let source =
            Source { title: "t", log: &log, drawn: &drawn, sector_displacements: &[], claimed_obstacles: &[] };
        let map = TopologyMap::of_places("test", vec![Some(at(2.0, 3.0))], CoordinateFrame::World);
        let planned = |name: &str, way: &[Position], error_fall_m| PlannedStop {
            name: name.to_owned(),
            place: *way.last().unwrap(),
            way: way.to_vec(),
            error_fall_m,
        };
        let next = [planned("next1", &[at(6.0, 2.0), at(5.0, 5.0)], 0.4), planned("next2", &[at(0.0, 5.0)], 0.1)];
        let Figure { name, picture } = of_next_stops(&source, &map, at(5.0, 0.0), &next, String::new());
        assert_eq!(name, "next");
        let text =
            |wanted: &str| picture.marks.iter().any(|mark| matches!(mark, Mark::Text { text, .. } if text == wanted));
        assert!(text("t: 2 stops to drive to next") && text("next1") && text("next2"));
        // From where the robot is over a corner to both stops.
        let is_way =
            |mark: &&Mark| matches!(mark, Mark::Path { points, stroke } if *stroke == WAY && points.len() == 4);
        assert_eq!(picture.marks.iter().filter(is_way).count(), 1);
        let nothing = of_next_stops(&source, &map, at(5.0, 0.0), &[], String::new());
        assert!(nothing.picture.marks.len() < picture.marks.len());
    }
}
