//! The margin of a sector by angles.

use std::f64::consts::{PI, TAU};

use sextant_channel::Wedge;

/// A vertex nearer than this to a stop, or to the vertical through it, has no direction (m).
const NO_DIRECTION_M: f64 = 1e-9;

/// The margin at each edge of a sector: the larger of an angle and the angle under which half a grid step is seen.
#[derive(Clone, Copy, Debug)]
pub(super) struct Margin {
    /// The angle (rad).
    pub(super) angle: f64,
    /// Half a grid step (m).
    pub(super) half_step_m: f64,
}

impl Margin {
    /// Whether a vertex at `apart` from the stop (m) is in a wedge with this margin. Azimuths are compared modulo a
    /// full circle. A vertex at the stop is accepted, for it has no direction.
    pub(super) fn admits(&self, wedge: &Wedge, [dx, dy, dz]: [f64; 3]) -> bool {
        let across_m = (dx * dx + dy * dy).sqrt();
        let distance_m = (across_m * across_m + dz * dz).sqrt();
        if distance_m <= NO_DIRECTION_M {
            return true;
        }
        let at = |distance_m: f64| self.angle.max(libm::atan(self.half_step_m / distance_m));
        let elevation = libm::atan2(dz, across_m);
        let margin = at(distance_m);
        let [low, high] = wedge.elevation_rad;
        if elevation < low - margin || elevation > high + margin {
            return false;
        }
        let half = 0.5 * wedge.azimuth_width_rad;
        let middle = wedge.azimuth_from_rad + half;
        let off_axis = (libm::atan2(dy, dx) - middle + PI).rem_euclid(TAU) - PI;
        across_m <= NO_DIRECTION_M || off_axis.abs() <= half + at(across_m)
    }
}
