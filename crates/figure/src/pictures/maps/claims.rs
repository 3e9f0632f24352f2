//! The obstacles that a map claims, as areas of colour.

use plotters::style::RGBColor;
use sextant_channel::Position;
use sextant_mapper::AbsorptionMap;
use sextant_recording::ClaimedObstacle;

use crate::paint::palette::OBSTACLE_RIM;
use crate::paint::picture::{Area, Picture, Stroke};
use crate::plot::sheet::{Entry, Symbol};
use crate::plot::view::{Panel, View};

/// An obstacle that the log is sure of, and another one.
const SURE: RGBColor = RGBColor(0xd6, 0xc6, 0xde);
const UNSURE: RGBColor = RGBColor(0xef, 0xe9, 0xf2);
/// The rims of their symbols in the legend.
const RIM: Stroke = Stroke::new(OBSTACLE_RIM, 0.5);

/// The obstacles of a map that was computed just now.
pub(crate) fn of(obstacles: &AbsorptionMap) -> Vec<ClaimedObstacle> {
    obstacles.claims_m().map(|(sure, rectangles_m)| ClaimedObstacle { sure, rectangles_m }).collect()
}

/// Draws the claimed obstacles as seen from above.
pub(crate) fn draw(picture: &mut Picture, panel: &Panel, claims: &[ClaimedObstacle]) {
    if panel.view != View::Top {
        return;
    }
    for claim in claims {
        let fill = if claim.sure { SURE } else { UNSURE };
        for &[low_x_m, low_y_m, high_x_m, high_y_m] in &claim.rectangles_m {
            let low = panel.at(Position::new(low_x_m, low_y_m, 0.0));
            let high = panel.at(Position::new(high_x_m, high_y_m, 0.0));
            let frame = panel.axes.area;
            let (left, right) = (low.x.max(frame.left), high.x.min(frame.right()));
            let (top, bottom) = (high.y.max(frame.top), low.y.min(frame.bottom()));
            if right > left && bottom > top {
                picture.rectangle(Area { left, top, width: right - left, height: bottom - top }, fill);
            }
        }
    }
}

/// The legend of the claimed obstacles.
pub(crate) fn entries(claims: &[ClaimedObstacle]) -> Vec<Entry> {
    let has = |sure: bool| claims.iter().any(|claim| claim.sure == sure);
    let entry = |fill, text: &str| Entry { symbol: Symbol::Body { fill, rim: RIM }, text: text.to_owned() };
    let sure = has(true).then(|| entry(SURE, "obstacle that the log shows"));
    let unsure = has(false).then(|| entry(UNSURE, "obstacle that it shows weakly"));
    sure.into_iter().chain(unsure).collect()
}
