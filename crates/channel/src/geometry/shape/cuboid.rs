//! Upright boxes.

use sextant_kernel::SettingError;

use super::clip::{Clip, GRAZE_M};
use super::polytope::Plane;
use super::surface::Surface;
use super::{LEAST_SIZE_M, place, size};
use crate::geometry::position::Position;

/// An upright box, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct BoxConfig {
    /// Middle of the box (m): at half its height if it stands on the ground.
    pub center_m: Position,
    /// Length, width and height (m).
    pub size_m: [f64; 3],
    /// Rotation about the vertical axis, counterclockwise seen from above (degrees).
    #[cfg_attr(feature = "config", serde(default))]
    pub yaw_deg: f64,
}

impl BoxConfig {
    /// A box with this centre and these sizes (m), along the axes.
    #[must_use]
    pub fn new(center_m: Position, size_m: [f64; 3]) -> Self {
        Self { center_m, size_m, yaw_deg: 0.0 }
    }
}

/// An upright box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cuboid {
    pub(crate) center: Position,
    pub(crate) half: Position,
    pub(crate) yaw_rad: f64,
    cos: f64,
    sin: f64,
}

impl TryFrom<BoxConfig> for Cuboid {
    type Error = SettingError;

    fn try_from(config: BoxConfig) -> Result<Self, SettingError> {
        for size_m in config.size_m {
            if size(size_m).is_none() {
                let found = format!("{:?}", config.size_m);
                return Err(SettingError::new(
                    "size_m",
                    found,
                    format!("three finite numbers of {LEAST_SIZE_M} or more"),
                ));
            }
        }
        let yaw_rad = SettingError::finite("yaw_deg", config.yaw_deg)?.to_radians();
        let (sin, cos) = libm::sincos(yaw_rad);
        let half = Position::from(config.size_m) * 0.5;
        Ok(Self { center: place("center_m", config.center_m)?, half, yaw_rad, cos, sin })
    }
}

impl Cuboid {
    /// `p` in the frame of the box: the origin is its middle, the axes are parallel to its edges.
    fn local(&self, p: Position) -> Position {
        let d = p - self.center;
        Position::new(self.cos * d.x_m + self.sin * d.y_m, self.cos * d.y_m - self.sin * d.x_m, d.z_m)
    }

    /// The part of the line within `margin_m` of the box: a clip by the six faces.
    pub(crate) fn clip(&self, from: Position, to: Position, margin_m: f64) -> Clip {
        let (a, b) = (self.local(from), self.local(to));
        let h = self.half + Position::new(margin_m, margin_m, margin_m);
        Clip::WHOLE
            .behind(a.x_m - h.x_m, b.x_m - h.x_m)
            .behind(-a.x_m - h.x_m, -b.x_m - h.x_m)
            .behind(a.y_m - h.y_m, b.y_m - h.y_m)
            .behind(-a.y_m - h.y_m, -b.y_m - h.y_m)
            .behind(a.z_m - h.z_m, b.z_m - h.z_m)
            .behind(-a.z_m - h.z_m, -b.z_m - h.z_m)
    }

    /// How far `p` is outside along each axis (m), negative inside.
    fn excess(&self, p: Position) -> Position {
        let local = self.local(p);
        Position::new(local.x_m.abs(), local.y_m.abs(), local.z_m.abs()) - self.half
    }

    pub(crate) fn contains(&self, p: Position) -> bool {
        let excess = self.excess(p);
        excess.x_m.max(excess.y_m).max(excess.z_m) < -GRAZE_M
    }

    pub(crate) fn distance_m(&self, p: Position) -> f64 {
        let excess = self.excess(p);
        Position::new(excess.x_m.max(0.0), excess.y_m.max(0.0), excess.z_m.max(0.0)).length_m()
    }

    /// The planes of its faces.
    pub(crate) fn planes(&self) -> Vec<Plane> {
        let (along, across) = (Position::new(self.cos, self.sin, 0.0), Position::new(-self.sin, self.cos, 0.0));
        [(along, self.half.x_m), (across, self.half.y_m), (Position::new(0.0, 0.0, 1.0), self.half.z_m)]
            .into_iter()
            .flat_map(|(axis, half_m)| [(axis, half_m), (axis * -1.0, half_m)])
            .map(|(normal, half_m)| Plane { normal, offset_m: normal.dot(self.center) + half_m })
            .collect()
    }

    pub(crate) fn surface(&self) -> Surface {
        let ring = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| {
            let (x, y) = (x * self.half.x_m, y * self.half.y_m);
            [self.center.x_m + self.cos * x - self.sin * y, self.center.y_m + self.sin * x + self.cos * y]
        });
        Surface::prism(&ring, self.center.z_m - self.half.z_m, self.center.z_m + self.half.z_m)
    }
}
