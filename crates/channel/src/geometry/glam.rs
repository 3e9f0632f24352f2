//! Conversion of positions to the vectors of the geometry library, and back.

use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Vector;

use crate::geometry::bounds::Bounds;
use crate::geometry::position::Position;

/// `p` as a vector.
pub(crate) fn vector(p: Position) -> Vector {
    Vector::new(p.x_m, p.y_m, p.z_m)
}

/// `v` as a position.
#[inline]
pub(crate) fn position(v: Vector) -> Position {
    Position::new(v.x, v.y, v.z)
}

/// `bounds` as a box of the library.
pub(crate) fn aabb(bounds: Bounds) -> Aabb {
    Aabb::new(vector(bounds.min), vector(bounds.max))
}
