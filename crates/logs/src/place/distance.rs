//! Distances between places.

use sextant_channel::{Bounds, Position};

/// Distance in the plane (m).
pub(crate) fn plane_m(a: Position, b: Position) -> f64 {
    libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m)
}

/// The diagonal of the box around places in the plane (m); 0 without any.
pub(crate) fn extent_m(places: impl IntoIterator<Item = Position>) -> f64 {
    Bounds::of(places).map_or(0.0, |bounds| plane_m(bounds.max, bounds.min))
}
