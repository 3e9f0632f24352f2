//! Distances between places.

use sextant_channel::Position;

/// Distance in the plane (m).
pub(crate) fn plane_m(a: Position, b: Position) -> f64 {
    libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m)
}
