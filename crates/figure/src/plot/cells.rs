//! The cells of a grid as areas of colour.

use sextant_channel::Position;

use sextant_recording::GridPlane;

use super::view::Panel;
use crate::paint::palette::Ramp;
use crate::paint::picture::{Area, Picture};

/// Number of different colours.
const SHADES: f64 = 48.0;

/// Two opposite corners of the area of all cells.
pub(crate) fn corners(plane: &GridPlane) -> [Position; 2] {
    let rows = plane.values.len() / plane.columns as usize;
    let (across, up) = (f64::from(plane.columns), rows as f64);
    let half = Position::new(0.5, 0.5, 0.0) * plane.step_m;
    let first = plane.first - half;
    [first, first + Position::new(across, up, 0.0) * plane.step_m]
}

/// Draws one rectangle for each run of cells of equal shade along x. `shares` has the number of each cell that `ramp`
/// has a colour for; where it is minus infinity, nothing is drawn.
pub(crate) fn draw(picture: &mut Picture, panel: &Panel, plane: &GridPlane, shares: &[f64], ramp: Ramp) {
    let shade = |share: f64| (share > f64::NEG_INFINITY).then(|| (share * SHADES).round().clamp(0.0, SHADES));
    let [first, _] = corners(plane);
    for (row, shares) in (0_u32..).zip(shares.chunks_exact(plane.columns as usize)) {
        let shades: Vec<Option<f64>> = shares.iter().map(|&share| shade(share)).collect();
        let mut column = 0_u32;
        for run in shades.chunk_by(|a, b| a == b) {
            let end = column + u32::try_from(run.len()).expect("a run has at most as many cells as columns");
            let corner = |column: u32, row: u32| {
                panel.at(first + Position::new(f64::from(column), f64::from(row), 0.0) * plane.step_m)
            };
            let (low, high) = (corner(column, row), corner(end, row + 1));
            if let Some(shade) = run[0] {
                let (width, height) = (high.x - low.x, low.y - high.y);
                // The rectangle is slightly larger, so that no gap is visible to its neighbours.
                let area = Area { left: low.x, top: high.y - 0.6, width: width + 0.6, height: height + 0.6 };
                picture.rectangle(area, ramp.color(shade / SHADES));
            }
            column = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_reach_half_a_step_beyond_the_vertices() {
        let plane = GridPlane { first: Position::new(1.0, 2.0, 0.0), step_m: 0.5, columns: 3, values: vec![0.0; 6] };
        let [low, high] = corners(&plane);
        assert!(low.distance_m(Position::new(0.75, 1.75, 0.0)) < 1e-12);
        assert!(high.distance_m(Position::new(2.25, 2.75, 0.0)) < 1e-12);
    }
}
