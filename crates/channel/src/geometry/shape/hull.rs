//! Convex hulls of points.

use parry3d_f64::transformation::try_convex_hull;
use sextant_kernel::SettingError;

use super::polytope::{Plane, Polytope};
use super::surface::Surface;
use super::triangle;
use crate::geometry::glam::{position, vector};
use crate::geometry::position::Position;

/// A convex hull, as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ConvexConfig {
    /// Points whose hull is the obstacle (m).
    pub points_m: Vec<Position>,
}

impl TryFrom<ConvexConfig> for Polytope {
    type Error = SettingError;

    fn try_from(config: ConvexConfig) -> Result<Self, SettingError> {
        let error = |found: String| {
            Err(SettingError::new("points_m", found, "four finite points or more, not all in one plane"))
        };
        if let Some(index) = config.points_m.iter().position(|p| !p.is_finite()) {
            return error(format!("a list with point {index} not finite"));
        }
        let mut points = config.points_m;
        points.sort_by(|a, b| {
            let (a, b): ([f64; 3], [f64; 3]) = ((*a).into(), (*b).into());
            a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])).then(a[2].total_cmp(&b[2]))
        });
        points.dedup();
        if points.len() < 4 {
            return error(format!("{} different points", points.len()));
        }
        // The hull is computed relative to the middle of the points, so that no precision is lost far from the
        // origin.
        let middle = points[0];
        let local: Vec<_> = points.iter().map(|&p| vector(p - middle)).collect();
        let Ok((vertices, triangles)) = try_convex_hull(&local) else {
            return error(format!("{} points without a hull", points.len()));
        };
        let vertices = vertices.into_iter().map(|v| middle + position(v)).collect();
        let surface = Surface { vertices, triangles };
        if !surface.has_volume() {
            return error(format!("{} points whose hull has a volume of {} m³", points.len(), surface.volume_m3()));
        }
        let planes = planes(&surface, &points);
        Ok(Self::new(planes, surface))
    }
}

/// The planes of the faces, each moved out to the outermost point, so that they hold all points.
fn planes(surface: &Surface, points: &[Position]) -> Vec<Plane> {
    let mut planes: Vec<Plane> = Vec::new();
    for corners in surface.corners() {
        let normal = triangle::normal(corners);
        let length = normal.length_m();
        if length <= 0.0 {
            continue;
        }
        let normal = normal * (1.0 / length);
        if planes.iter().any(|plane| (plane.normal - normal).length_m() < 1e-9) {
            continue;
        }
        let offset_m = points.iter().map(|&p| normal.dot(p)).fold(f64::NEG_INFINITY, f64::max);
        planes.push(Plane { normal, offset_m });
    }
    planes
}
