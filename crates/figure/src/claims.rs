//! The obstacles that a map claims: the cells of each, as areas of colour.

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_mapper::{AbsorptionMap, ObstacleClaim};

use super::palette::OBSTACLE_RIM;
use super::picture::{Area, Picture, Stroke};
use super::sheet::{Entry, Symbol};
use super::view::{Panel, View};

/// The cells of an obstacle that the log is sure of, and of another one.
const SURE: RGBColor = RGBColor(0xd6, 0xc6, 0xde);
const UNSURE: RGBColor = RGBColor(0xef, 0xe9, 0xf2);
/// The rims of their symbols in the legend.
const RIM: Stroke = Stroke::new(OBSTACLE_RIM, 0.5);

fn fill(claim: &ObstacleClaim) -> RGBColor {
    if claim.is_sure { SURE } else { UNSURE }
}

/// Draws the claimed obstacles as seen from above: one rectangle for each run of cells along x.
pub(super) fn draw(picture: &mut Picture, panel: &Panel, obstacles: &AbsorptionMap) {
    if panel.view != View::Top {
        return;
    }
    let half = Position::new(0.5, 0.5, 0.0) * obstacles.cell_m();
    for claim in obstacles.claims() {
        for run in claim.cells.chunk_by(|a, b| a[1] == b[1] && a[0] + 1 == b[0]) {
            let (Some(&first), Some(&last)) = (run.first(), run.last()) else { continue };
            let low = panel.at(obstacles.centre(first) - half);
            let high = panel.at(obstacles.centre(last) + half);
            let frame = panel.axes.area;
            let (left, right) = (low.x.max(frame.left), high.x.min(frame.right()));
            let (top, bottom) = (high.y.max(frame.top), low.y.min(frame.bottom()));
            if right > left && bottom > top {
                picture.rectangle(Area { left, top, width: right - left, height: bottom - top }, fill(claim));
            }
        }
    }
}

/// The legend of the claimed obstacles.
pub(super) fn entries(obstacles: &AbsorptionMap) -> Vec<Entry> {
    let has = |is_sure: bool| obstacles.claims().iter().any(|claim| claim.is_sure == is_sure);
    let entry = |fill, text: &str| Entry { symbol: Symbol::Body { fill, rim: RIM }, text: text.to_owned() };
    let sure = has(true).then(|| entry(SURE, "obstacle that the log shows"));
    let unsure = has(false).then(|| entry(UNSURE, "obstacle that it shows weakly"));
    sure.into_iter().chain(unsure).collect()
}
