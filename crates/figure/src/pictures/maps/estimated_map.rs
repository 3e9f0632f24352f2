//! A map with the 95 % region and the name of each node, the stops and the paths, and the true positions if they are known.

use plotters::style::RGBColor;
use sextant_channel::{Bounds, Position};
use sextant_kernel::NodeId;
use sextant_mapper::{PositionError, Region, TopologyMap};

use super::claims;
use super::estimated::EstimatedMap;
use super::map::{ERROR, colour_bar, heading};
use crate::paint::labels::{Labels, MARK};
use crate::paint::palette::{ACCENT, CURVES, INK};
use crate::paint::picture::{Picture, Stroke, TextStyle, Weight};
use crate::pictures::source::Source;
use crate::plot::sheet::{ColourBar, Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;
use crate::plot::view::{Panel, View, Views};
use sextant_kernel::text::counted;
use sextant_recording::Places;

/// The outline of a 95 % region.
pub(crate) const REGION: Stroke = Stroke::new(RGBColor(0x8f, 0xb8, 0xd8), 1.0);
/// A true position.
const TRUE: Stroke = Stroke::new(INK, 1.1);
/// The rim of a node whose place is not reliable.
const CONCERN: Stroke = Stroke::new(ACCENT, 1.6);
/// Stops and paths, which are behind the nodes.
pub(crate) const STOP: RGBColor = RGBColor(0xc4, 0xb5, 0x9a);
pub(crate) const PATH: Stroke = Stroke::new(RGBColor(0xdd, 0xd3, 0xc0), 1.2);
/// Side of the square of a stop (px).
pub(crate) const STOP_SIDE: f64 = 5.0;
/// Names of nodes.
const NAME: TextStyle = TextStyle { em: 9.0, weight: Weight::Regular, color: INK };
/// Corners of the outline of a region.
const CORNERS: u32 = 72;
/// Maps with more nodes than this have no names.
const MOST_NAMES: usize = 500;
/// A picture has its usual size up to this number of nodes, and at most twice that for more.
const USUAL_NODES: f64 = 15.0;

/// The figure.
pub(crate) fn draw(source: &Source<'_>, estimated: &EstimatedMap<'_>, places: &Places) -> Picture {
    let truth = &source.drawn.nodes;
    let errors = source.errors(places);
    let distribution = PositionError::of(&errors.iter().map(|&(_, error_m)| error_m).collect::<Vec<_>>());
    let bar = distribution.map(|distribution| colour_bar(&distribution));
    let nodes = source.log.node_count();
    let regions = regions(estimated.map);
    let shown = || source.survey().chain(places.values().copied()).chain(truth.values().copied());
    let views = source.views(shown().chain(reach(&regions, shown())));
    let views = views.enlarged((nodes as f64 / USUAL_NODES).sqrt().clamp(1.0, 2.0));
    let radius = views.dot_radius(nodes);
    let claims = estimated.obstacles.map(claims::of).unwrap_or_default();
    let has_names = nodes <= MOST_NAMES;
    let sheet = |left_out: usize| {
        let (title, mut note) = heading(source, estimated.name, places.len(), distribution);
        if views.sizes().len() > 1 {
            note += "; seen from above and from the side";
        }
        if !has_names {
            note += &format!("; more than {MOST_NAMES} nodes, so without names");
        } else if left_out > 0 {
            note += &format!("; {} without space", counted(left_out, "name"));
        }
        let mut legend = legend(
            source,
            estimated.map,
            &ShownMarks { places, bar: bar.as_ref(), radius, regions: regions.len(), views: &views },
        );
        legend.extend(claims::entries(&claims));
        Sheet { title, note, bar: bar.clone(), legend }
    };
    // The space for names is known after the layout, and the layout says how many have no space.
    let (_, areas) = sheet(0).lay_out(&views.sizes());
    let names = |panel: &Panel| {
        let dots = places
            .iter()
            .filter_map(|(node, &place)| Some((panel.at(place), source.log.names().get(node.index())?.as_str())));
        Labels::of(dots, radius, truth.values().map(|&place| panel.at(place)), panel.axes.area, NAME)
    };
    let left_out = views.panels(&areas).first().filter(|_| has_names).map_or(0, |panel| names(panel).left_out());
    let sheet = sheet(left_out);
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    let mut order = errors;
    // The largest errors are drawn last, on top.
    order.sort_by(|a, b| a.1.total_cmp(&b.1));
    for panel in views.panels(&areas) {
        claims::draw(&mut picture, &panel, &claims);
        draw_survey(&mut picture, &panel, source);
        for region in &regions {
            draw_region(&mut picture, &panel, region);
        }
        for (node, _) in &order {
            picture.line(panel.at(truth[node]), panel.at(places[node]), ERROR);
        }
        for &place in truth.values() {
            picture.cross(panel.at(place), MARK, TRUE);
        }
        for (_, &place) in places.iter().filter(|(node, _)| !truth.contains_key(node)) {
            picture.disc(panel.at(place), radius, CURVES[0]);
        }
        for &(node, error_m) in &order {
            let fill = sheet.bar.as_ref().map_or(CURVES[0], |bar| bar.color(error_m));
            picture.disc(panel.at(places[&node]), radius, fill);
        }
        for (node, _) in estimated.map.concerns() {
            if let Some(&place) = places.get(&node) {
                picture.ring(panel.at(place), radius + 1.0, CONCERN);
            }
        }
        if has_names && panel.view == View::Top {
            names(&panel).draw(&mut picture);
        }
        panel.axes.draw(&mut picture);
    }
    picture
}

/// The 95 % regions of the nodes that have one.
pub(crate) fn regions(map: &TopologyMap) -> Vec<Region> {
    map.estimates.iter().flatten().filter_map(Region::of_95).collect()
}

/// The corners of the boxes around `regions`, but no farther beyond the box around `places` than a quarter of its size, or
/// than half the regions reach: a few regions may be much larger than the world.
fn reach(regions: &[Region], places: impl Iterator<Item = Position>) -> Vec<Position> {
    let box_of = |region: &Region| {
        let range = |axes: [usize; 2], of: usize| {
            let along = || region.outline(axes, CORNERS).into_iter().map(move |corner| corner[of]);
            [along().fold(f64::INFINITY, f64::min), along().fold(f64::NEG_INFINITY, f64::max)]
        };
        let [x, y, z] = [range([0, 1], 0), range([0, 1], 1), range([0, 2], 1)];
        Bounds { min: Position::new(x[0], y[0], z[0]), max: Position::new(x[1], y[1], z[1]) }
    };
    let boxes: Vec<Bounds> = regions.iter().map(box_of).collect();
    let Some(world) = Bounds::of(places) else { return Vec::new() };
    let mut sizes: Vec<f64> = boxes.iter().map(|bounds| bounds.min.distance_m(bounds.max)).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let usual = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    let limit = world.grown((0.25 * world.min.distance_m(world.max)).max(0.5 * usual));
    let limited = |place: Position| {
        Position::new(
            place.x_m.clamp(limit.min.x_m, limit.max.x_m),
            place.y_m.clamp(limit.min.y_m, limit.max.y_m),
            place.z_m.clamp(limit.min.z_m, limit.max.z_m),
        )
    };
    boxes.into_iter().flat_map(|bounds| [limited(bounds.min), limited(bounds.max)]).collect()
}

/// Draws the part of the outline of a region that is within the frame.
pub(crate) fn draw_region(picture: &mut Picture, panel: &Panel, region: &Region) {
    let axes = match panel.view {
        View::Top => [0, 1],
        View::Side => [0, 2],
    };
    let mut corners: Vec<_> = region.outline(axes, CORNERS).into_iter().map(|[x, y]| panel.axes.at(x, y)).collect();
    corners.extend(corners.first().copied());
    let area = panel.axes.area;
    let is_within = corners.iter().all(|corner| {
        (area.left..=area.right()).contains(&corner.x) && (area.top..=area.bottom()).contains(&corner.y)
    });
    if is_within {
        picture.path(corners, REGION);
    } else {
        picture.path_within(area, &corners, REGION);
    }
}

/// Draws obstacles, paths and stops.
pub(crate) fn draw_survey(picture: &mut Picture, panel: &Panel, source: &Source<'_>) {
    draw_solids(picture, panel, source.solids());
    for (_, path) in &source.drawn.paths {
        picture.path(path.iter().map(|&place| panel.at(place)).collect(), PATH);
    }
    for stop in source.log.stops() {
        picture.square(panel.at(stop.position), STOP_SIDE, STOP);
    }
}

/// What is drawn, for the legend.
struct ShownMarks<'a> {
    places: &'a Places,
    bar: Option<&'a ColourBar>,
    radius: f64,
    /// Number of regions.
    regions: usize,
    views: &'a Views,
}

fn legend(source: &Source<'_>, map: &TopologyMap, shown: &ShownMarks<'_>) -> Vec<Entry> {
    let ShownMarks { places, bar, radius, regions, views } = *shown;
    let truth = &source.drawn.nodes;
    let mut legend = Vec::new();
    let mut add = |symbol, text: &str| legend.push(Entry { symbol, text: text.to_owned() });
    let fill = bar.map_or(CURVES[0], |bar| bar.color(0.6 * bar.high));
    add(Symbol::Disc { radius, fill }, "mapped node");
    if regions > 0 {
        let text = if views.sizes().len() > 1 { "projection of its 95 % region" } else { "its 95 % region" };
        add(Symbol::Circle { radius: 7.0, stroke: REGION }, text);
    }
    if map.concerns().next().is_some() {
        add(Symbol::RimmedDisc { radius: radius + 1.0, fill, rim: CONCERN }, "place that is not reliable");
    }
    if !truth.is_empty() {
        add(Symbol::Cross { stroke: TRUE }, "true position");
    }
    if truth.keys().any(|node| places.contains_key(node)) {
        add(Symbol::Line { stroke: ERROR, pattern: &[] }, "error");
    }
    if truth.keys().any(|node| places.contains_key(node)) && places.keys().any(|node| !truth.contains_key(node)) {
        add(Symbol::Disc { radius, fill: CURVES[0] }, "node without a true position");
    }
    add(Symbol::Square { side: STOP_SIDE, fill: STOP }, "stop");
    if !source.drawn.paths.is_empty() {
        add(Symbol::Line { stroke: PATH, pattern: &[] }, "path");
    }
    legend.extend(source.obstacle_entry());
    legend
}

/// The places of a map by node.
pub(crate) fn places(map: &TopologyMap) -> Places {
    let place = |(node, place): (usize, Option<Position>)| Some((NodeId::from_index(node), place?));
    map.positions().into_iter().enumerate().filter_map(place).collect()
}

#[cfg(test)]
mod tests {
    use sextant_mapper::CoordinateFrame;

    use super::*;

    /// A node at (1, 2) with these standard deviations (m).
    fn region(sigma_x_m: f64, sigma_y_m: f64) -> Region {
        let places = vec![Some(Position::new(1.0, 2.0, 0.0))];
        let mut map = TopologyMap::of_places("test", places, CoordinateFrame::World);
        let covariance = [[sigma_x_m * sigma_x_m, 0.0, 0.0], [0.0, sigma_y_m * sigma_y_m, 0.0], [0.0; 3]];
        map.estimates[0].as_mut().unwrap().covariance = Some(covariance);
        regions(&map).remove(0)
    }

    #[test]
    fn a_region_is_shown_as_a_whole_unless_it_is_much_larger_than_the_world() {
        let world = [Position::ORIGIN, Position::new(30.0, 40.0, 0.0)];
        // The half-axes of a 95 % region are 2.4477 standard deviations.
        let shown = reach(&[region(1.0, 2.0), region(1.0, 2.0), region(1000.0, 1.0)], world.into_iter());
        let expected = [[-1.4477, -2.8955], [3.4477, 6.8955], [-1.4477, -2.8955], [3.4477, 6.8955]];
        for (place, [x_m, y_m]) in shown.iter().zip(expected) {
            assert!((place.x_m - x_m).abs() < 1e-3 && (place.y_m - y_m).abs() < 1e-3, "{place:?}");
        }
        // A quarter of the diagonal of 50 m beyond the world.
        assert!((shown[4].x_m + 12.5).abs() < 1e-9 && (shown[5].x_m - 42.5).abs() < 1e-9, "{shown:?}");
        // A world of one place is as large as its region.
        let alone = reach(&[region(1.0, 2.0)], [Position::new(1.0, 2.0, 0.0)].into_iter());
        assert!((alone[1].y_m - 6.8955).abs() < 1e-3, "{alone:?}");
    }
}
