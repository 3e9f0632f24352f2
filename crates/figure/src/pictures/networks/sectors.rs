//! The sectors of a robot at one stop: which sector each node was heard in.

use std::collections::BTreeSet;
use std::f64::consts::TAU;

use plotters::style::RGBColor;
use sextant_channel::{Bounds, Position, SectorConfig, Stop, Wedge};

use crate::paint::palette::{ACCENT, CURVES, GRID, INK, THREAD};
use crate::paint::picture::{Picture, Stroke};
use crate::pictures::source::Source;
use crate::plot::density::Crowding;
use crate::plot::sheet::{Entry, Sheet, Symbol};
use crate::plot::silhouette::draw_solids;
use crate::plot::view::{Extent, View, Views};
use sextant_kernel::text::counted;

/// A sector in which a node was heard.
const WEDGE: RGBColor = GRID;
const RIM: Stroke = Stroke::new(THREAD, 0.8);
/// From the stop to a node, in the sector that points to it.
const RIGHT: Stroke = Stroke::new(CURVES[0], 1.2);
/// From the stop to a node that was heard in a sector that does not point to it.
const WRONG: Stroke = Stroke::new(CURVES[1], 1.2);
/// Side of the square of the stop (px).
const STOP_SIDE: f64 = 10.0;
/// Longest side of a wedge on its arc (rad).
const ARC_STEP_RAD: f64 = 0.1;

/// A node that was heard at the stop.
struct HeardNode<'a> {
    place: Position,
    sector: &'a SectorConfig,
    wedge: Wedge,
}

impl HeardNode<'_> {
    /// Whether the sector points to the node, as seen from `stop`.
    fn is_right(&self, stop: Position) -> bool {
        let apart = self.place - stop;
        let Wedge { azimuth_from_rad, azimuth_width_rad, elevation_rad: [low, high] } = self.wedge;
        let azimuth_rad = (libm::atan2(apart.y_m, apart.x_m) - azimuth_from_rad).rem_euclid(TAU);
        let elevation_rad = libm::atan2(apart.z_m, libm::hypot(apart.x_m, apart.y_m));
        azimuth_rad <= azimuth_width_rad && (low..=high).contains(&elevation_rad)
    }
}

/// The figure of the stop where the most nodes were heard in sectors; `None` if the log has no sectors or the true
/// positions of the nodes are unknown.
pub(crate) fn draw(source: &Source<'_>) -> Option<Picture> {
    let Source { log, drawn, title, .. } = *source;
    let table = log.sectors()?;
    let mut in_sectors = vec![0_u32; log.stops().len()];
    let receptions = log.receptions().iter().filter(|reception| reception.received > 0 && reception.sector.is_some());
    receptions.for_each(|reception| in_sectors[reception.stop as usize] += 1);
    let most = in_sectors.iter().copied().max().filter(|&most| most > 0)?;
    let index = in_sectors.iter().position(|&count| count == most)?;
    let Stop { position: stop, heading_rad, .. } = log.stops()[index];
    // A wedge of an antenna that turns with the robot.
    let turned =
        |wedge: Wedge| Wedge { azimuth_from_rad: wedge.azimuth_from_rad + heading_rad.unwrap_or(0.0), ..wedge };
    let heard =
        log.receptions().iter().filter(|reception| reception.stop as usize == index && reception.received > 0);
    let heard: Vec<HeardNode<'_>> = heard
        .filter_map(|reception| {
            let place = *drawn.nodes.get(&reception.node)?;
            let sector = table.iter().find(|sector| Some(sector.sector) == reception.sector)?;
            Some(HeardNode { place, sector, wedge: turned(sector.wedge().ok()?) })
        })
        .collect();
    let reach_m =
        heard.iter().map(|node| libm::hypot((node.place - stop).x_m, (node.place - stop).y_m)).fold(0.0, f64::max);
    if reach_m <= 0.0 {
        return None;
    }
    let outlines: Vec<Vec<Position>> = heard.iter().map(|node| outline(stop, node.wedge, 1.05 * reach_m)).collect();
    let corners = || outlines.iter().flatten().copied();
    let extent = Extent::around(drawn.nodes.values().copied().chain(corners()))?;
    let mut views = Views::new(&extent, &[View::Top]);
    let mut nodes: Vec<Position> = drawn.nodes.values().copied().collect();
    if Crowding::default().is_crowded(nodes.len(), &views) {
        // Of many nodes only those round the stop are shown.
        let reached = Bounds::of(corners())?;
        nodes.retain(|place| {
            (reached.min.x_m..=reached.max.x_m).contains(&place.x_m)
                && (reached.min.y_m..=reached.max.y_m).contains(&place.y_m)
        });
        views = Views::new(&Extent::around(corners())?, &[View::Top]);
    }
    let radius = 0.9 * views.dot_radius(nodes.len());
    let right = heard.iter().filter(|node| node.is_right(stop)).count();
    let line = |stroke, text: &str| Entry { symbol: Symbol::Line { stroke, pattern: &[] }, text: text.to_owned() };
    let mut legend = vec![
        Entry { symbol: Symbol::Square { side: STOP_SIDE, fill: ACCENT }, text: "stop".to_owned() },
        Entry { symbol: Symbol::Disc { radius, fill: INK }, text: "node that was heard".to_owned() },
        Entry { symbol: Symbol::Disc { radius, fill: THREAD }, text: "other node".to_owned() },
        Entry { symbol: Symbol::Body { fill: WEDGE, rim: RIM }, text: "sector in which a node was heard".to_owned() },
        line(RIGHT, "the sector points to the node"),
        line(WRONG, "it does not, in azimuth or elevation"),
    ];
    legend.extend(source.obstacle_entry());
    let robot = log.robot_name(log.stops()[index].robot);
    let note = format!(
        "stop {index} of {robot}: {} heard, {right} in a sector that points to them; seen from above",
        counted(heard.len(), "node")
    );
    let sheet = Sheet { title: format!("{title}: sectors at a stop"), note, bar: None, legend };
    let (mut picture, areas) = sheet.lay_out(&views.sizes());
    for panel in views.panels(&areas) {
        let mut drawn_wedges = BTreeSet::new();
        for (node, outline) in heard.iter().zip(&outlines) {
            // Sectors of two rings have the same outline from above.
            let azimuths = [node.sector.azimuth_from_deg, node.sector.azimuth_to_deg].map(f64::to_bits);
            if drawn_wedges.insert(azimuths) {
                let corners: Vec<_> = outline.iter().map(|&place| panel.at(place)).collect();
                picture.polygon(corners.clone(), WEDGE);
                picture.path(corners, RIM);
            }
        }
        draw_solids(&mut picture, &panel, source.solids());
        for node in &heard {
            let stroke = if node.is_right(stop) { RIGHT } else { WRONG };
            picture.line(panel.at(stop), panel.at(node.place), stroke);
        }
        for place in &nodes {
            let fill = if heard.iter().any(|node| node.place == *place) { INK } else { THREAD };
            picture.disc(panel.at(*place), radius, fill);
        }
        picture.square(panel.at(stop), STOP_SIDE, ACCENT);
        panel.axes.draw(&mut picture);
    }
    Some(picture)
}

/// The outline of the azimuths of a sector up to `reach_m` from the stop, which is its first and its last corner.
fn outline(stop: Position, wedge: Wedge, reach_m: f64) -> Vec<Position> {
    let pieces = (wedge.azimuth_width_rad / ARC_STEP_RAD).ceil().max(1.0);
    let at = |share: f64| {
        let (sin, cos) = libm::sincos(wedge.azimuth_from_rad + share * wedge.azimuth_width_rad);
        Position::new(stop.x_m + reach_m * cos, stop.y_m + reach_m * sin, stop.z_m)
    };
    let steps = std::iter::successors(Some(0.0), |&i| (i < pieces).then_some(i + 1.0));
    std::iter::once(stop).chain(steps.map(|i| at(i / pieces))).chain([stop]).collect()
}
