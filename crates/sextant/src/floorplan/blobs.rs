//! What is too thick for a wall.

use super::occupancy::Mask;

/// The cells of `mask` that belong to parts thicker than twice `half` (cells), of which each cell is so deep.
pub(super) fn thick(mask: &Mask, depths: &[f32], half: f64) -> Mask {
    let mut blobs = mask.empty_like();
    for core in mask.members().filter(|&cell| f64::from(depths[cell]) > half) {
        let (column, row) = (core % mask.width, core / mask.width);
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most the size of the picture"
        )]
        let radius = f64::from(depths[core]).ceil() as usize;
        for y in row.saturating_sub(radius)..(row + radius + 1).min(mask.height) {
            for x in column.saturating_sub(radius)..(column + radius + 1).min(mask.width) {
                let (dx, dy) = (x.abs_diff(column) as f64, y.abs_diff(row) as f64);
                let cell = y * mask.width + x;
                if mask.cells[cell] && libm::hypot(dx, dy) <= f64::from(depths[core]) {
                    blobs.cells[cell] = true;
                }
            }
        }
    }
    add_corners(mask, &mut blobs, half);
    blobs
}

/// Adds what the discs leave of the corners of blocks: small parts beside them.
fn add_corners(mask: &Mask, blobs: &mut Mask, half: f64) {
    let mut rest = mask.clone();
    blobs.members().for_each(|cell| rest.cells[cell] = false);
    for component in rest.components() {
        let places = || component.iter().map(|&cell| mask.place(cell));
        let size = |axis: usize| {
            let (low, high) = places()
                .fold((f64::MAX, f64::MIN), |(low, high), place| (low.min(place[axis]), high.max(place[axis])));
            high - low + 1.0
        };
        let touches = || component.iter().any(|&cell| blobs.neighbours(cell).next().is_some());
        if size(0).max(size(1)) <= 2.0 * half && touches() {
            component.iter().for_each(|&cell| blobs.cells[cell] = true);
        }
    }
}
