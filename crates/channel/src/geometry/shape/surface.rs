//! Surfaces made of triangles.

use super::triangle::{self, Triangle};
use crate::geometry::bounds::Bounds;
use crate::geometry::position::Position;

/// A surface of triangles whose normals point out of a solid.
#[derive(Clone, Debug, Default)]
pub(crate) struct Surface {
    pub(crate) vertices: Vec<Position>,
    pub(crate) triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// The corners of each triangle.
    pub(crate) fn corners(&self) -> impl Iterator<Item = Triangle> + '_ {
        (0..self.triangles.len()).map(|index| self.triangle(index))
    }

    /// The corners of one triangle.
    pub(crate) fn triangle(&self, index: usize) -> Triangle {
        self.triangles[index].map(|vertex| self.vertices[vertex as usize])
    }

    /// The smallest box around it.
    pub(crate) fn bounds(&self) -> Option<Bounds> {
        Bounds::of(self.vertices.iter().copied())
    }

    /// Enclosed volume (m³), negative if the normals point inwards; computed relative to the first vertex, so that no
    /// precision is lost far from the origin.
    pub(crate) fn volume_m3(&self) -> f64 {
        let Some(&apex) = self.vertices.first() else {
            return 0.0;
        };
        self.corners().map(|[a, b, c]| (a - apex).dot((b - apex).cross(c - apex)) / 6.0).sum()
    }

    /// Whether it encloses more than numerical noise: 1 part in 10⁹ of the cube on its diagonal.
    pub(crate) fn has_volume(&self) -> bool {
        let diagonal_m = self.bounds().map_or(0.0, |bounds| bounds.min.distance_m(bounds.max));
        self.volume_m3().abs() > 1e-9 * diagonal_m.powi(3)
    }

    /// Distance from `p` to the nearest triangle (m).
    pub(crate) fn distance_m(&self, p: Position) -> f64 {
        self.corners().map(|corners| triangle::distance_m(corners, p)).fold(f64::INFINITY, f64::min)
    }

    /// An upright prism: the `ring` of corners (counterclockwise seen from above) at two heights.
    pub(crate) fn prism(ring: &[[f64; 2]], bottom_m: f64, top_m: f64) -> Self {
        let count = u32::try_from(ring.len()).expect("fewer than 2^32 corners");
        let at = |z_m: f64| ring.iter().map(move |&[x, y]| Position::new(x, y, z_m));
        let vertices = at(bottom_m).chain(at(top_m)).collect();
        let mut triangles = Vec::with_capacity(4 * ring.len());
        for i in 1..count.saturating_sub(1) {
            triangles.push([0, i + 1, i]);
            triangles.push([count, count + i, count + i + 1]);
        }
        for i in 0..count {
            let next = (i + 1) % count;
            triangles.push([i, next, count + next]);
            triangles.push([i, count + next, count + i]);
        }
        Self { vertices, triangles }
    }
}
