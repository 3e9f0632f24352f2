//! Upright cylinders.

use sextant_kernel::SettingError;

use super::clip::{Clip, GRAZE_M};
use super::surface::Surface;
use super::{place, thickness};
use crate::geometry::position::Position;

/// An upright cylinder, as written in a scenario.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "config", derive(serde::Serialize, serde::Deserialize), serde(deny_unknown_fields))]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct CylinderConfig {
    /// Middle of the bottom face (m).
    pub base_m: Position,
    /// Radius (m).
    pub radius_m: f64,
    /// Height (m).
    pub height_m: f64,
}

/// An upright cylinder.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cylinder {
    pub(crate) base: Position,
    pub(crate) radius_m: f64,
    pub(crate) height_m: f64,
}

impl TryFrom<CylinderConfig> for Cylinder {
    type Error = SettingError;

    fn try_from(config: CylinderConfig) -> Result<Self, SettingError> {
        Ok(Self {
            base: place("base_m", config.base_m)?,
            radius_m: thickness("radius_m", config.radius_m)?,
            height_m: thickness("height_m", config.height_m)?,
        })
    }
}

/// Number of sides of the polygon for drawing a cylinder.
const SIDES: u32 = 48;

impl Cylinder {
    /// The part of the line within `margin_m` of the cylinder: a clip by the two end faces and the chord of the circle.
    pub(crate) fn clip(&self, from: Position, to: Position, margin_m: f64) -> Clip {
        let (a, d) = (from - self.base, to - from);
        let (radius_m, top_m) = (self.radius_m + margin_m, self.height_m + margin_m);
        let bottom = Clip::WHOLE.behind(-a.z_m - margin_m, -(a.z_m + d.z_m) - margin_m);
        let between = bottom.behind(a.z_m - top_m, a.z_m + d.z_m - top_m);
        let square = d.x_m * d.x_m + d.y_m * d.y_m;
        if square <= GRAZE_M * GRAZE_M {
            let inside = libm::hypot(a.x_m, a.y_m) < radius_m - GRAZE_M;
            if inside { between } else { Clip::NONE }
        } else {
            // The chord is symmetric about the point of the line nearest to the axis.
            let cross = a.x_m * d.y_m - a.y_m * d.x_m;
            let half_square = radius_m * radius_m - cross * cross / square;
            if half_square <= 0.0 {
                return Clip::NONE;
            }
            let nearest = -(a.x_m * d.x_m + a.y_m * d.y_m) / square;
            let half = (half_square / square).sqrt();
            between.between(nearest - half, nearest + half)
        }
    }

    /// How far `p` is outside sideways and in height (m), negative inside.
    fn excess(&self, p: Position) -> (f64, f64) {
        let d = p - self.base;
        (libm::hypot(d.x_m, d.y_m) - self.radius_m, (-d.z_m).max(d.z_m - self.height_m))
    }

    pub(crate) fn contains(&self, p: Position) -> bool {
        let (sideways, height) = self.excess(p);
        sideways.max(height) < -GRAZE_M
    }

    pub(crate) fn distance_m(&self, p: Position) -> f64 {
        let (sideways, height) = self.excess(p);
        libm::hypot(sideways.max(0.0), height.max(0.0))
    }

    /// For drawing: a prism of 48 sides inscribed in the cylinder.
    pub(crate) fn surface(&self) -> Surface {
        let ring: Vec<_> = (0..SIDES)
            .map(|i| {
                let (sin, cos) = libm::sincos(std::f64::consts::TAU * f64::from(i) / f64::from(SIDES));
                [self.base.x_m + self.radius_m * cos, self.base.y_m + self.radius_m * sin]
            })
            .collect();
        Surface::prism(&ring, self.base.z_m, self.base.z_m + self.height_m)
    }
}
