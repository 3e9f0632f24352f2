//! Upright prisms over a convex footprint.

use sextant_kernel::SettingError;

use super::clip::GRAZE_M;
use super::polytope::{Plane, Polytope};
use super::surface::Surface;
use super::thickness;
use crate::geometry::position::Position;

/// An upright prism, as written in a scenario.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PrismConfig {
    /// Corners of the convex footprint in order, clockwise or counterclockwise (m).
    pub corners_m: Vec<[f64; 2]>,
    /// Height of the bottom face (m).
    #[cfg_attr(feature = "config", serde(default))]
    pub bottom_m: f64,
    /// Height of the prism (m).
    pub height_m: f64,
}

impl TryFrom<PrismConfig> for Polytope {
    type Error = SettingError;

    fn try_from(config: PrismConfig) -> Result<Self, SettingError> {
        let bottom_m = SettingError::finite("bottom_m", config.bottom_m)?;
        let top_m = bottom_m + thickness("height_m", config.height_m)?;
        let ring = footprint(&config.corners_m)?;
        let mut planes = vec![
            Plane { normal: Position::new(0.0, 0.0, -1.0), offset_m: -bottom_m },
            Plane { normal: Position::new(0.0, 0.0, 1.0), offset_m: top_m },
        ];
        planes.extend(sides(&ring));
        Ok(Self::new(planes, Surface::prism(&ring, bottom_m, top_m)))
    }
}

/// Corners in counterclockwise order, without duplicates and without corners in the middle of a side.
fn footprint(corners: &[[f64; 2]]) -> Result<Vec<[f64; 2]>, SettingError> {
    let error = |found: String, allowed: &str| Err(SettingError::new("corners_m", found, allowed));
    if let Some(bad) = corners.iter().find(|corner| !corner.iter().all(|x| x.is_finite())) {
        return error(format!("a list with corner {bad:?}"), "finite numbers");
    }
    let mut ring: Vec<[f64; 2]> = Vec::new();
    for &corner in corners {
        if ring.last().is_none_or(|&last| distance_m(last, corner) > GRAZE_M) {
            ring.push(corner);
        }
    }
    while ring.len() > 1 && distance_m(ring[0], ring[ring.len() - 1]) <= GRAZE_M {
        ring.pop();
    }
    let area_m2: f64 = (1..ring.len().max(1) - 1).map(|i| cross(ring[0], ring[i], ring[i + 1]) / 2.0).sum();
    let size_m = ring.iter().map(|&corner| distance_m(ring[0], corner)).fold(0.0, f64::max);
    if ring.len() < 3 || area_m2.abs() <= 1e-9 * size_m * size_m {
        let found = format!("{} different corners with an area of {} m²", ring.len(), area_m2.abs());
        return error(found, "three corners or more, not on one line");
    }
    if area_m2 < 0.0 {
        ring.reverse();
    }
    let count = ring.len();
    let turn = |i: usize| cross(ring[(i + count - 1) % count], ring[i], ring[(i + 1) % count]);
    let ring: Vec<_> = (0..count).filter(|&i| turn(i).abs() > GRAZE_M * size_m).map(|i| ring[i]).collect();
    // Each corner must be behind each side. Only convex footprints pass; stars that always turn left do not.
    for side in sides(&ring) {
        if let Some(corner) =
            ring.iter().find(|corner| side.height_m(Position::new(corner[0], corner[1], 0.0)) > 1e-6)
        {
            let allowed = "a convex footprint; write one obstacle for each convex part, or a mesh";
            return error(format!("not convex at or beside corner {corner:?}"), allowed);
        }
    }
    Ok(ring)
}

/// The side faces over a counterclockwise ring.
fn sides(ring: &[[f64; 2]]) -> impl Iterator<Item = Plane> + '_ {
    (0..ring.len()).map(|i| {
        let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
        let length_m = distance_m(a, b);
        let normal = Position::new((b[1] - a[1]) / length_m, (a[0] - b[0]) / length_m, 0.0);
        Plane { normal, offset_m: normal.dot(Position::new(a[0], a[1], 0.0)) }
    })
}

fn distance_m(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(a[0] - b[0], a[1] - b[1])
}

fn cross(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}
