//! What is known about a moving target at one instant.

use sextant_channel::Position;

/// A measured place of a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fix {
    /// The place (m).
    pub place: Position,
    /// Variance of its error along each axis (m²), above 0.
    pub variance_m2: f64,
}

/// Place and velocity of a target, and how sure they are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TargetState {
    /// The place (m).
    pub place: Position,
    /// The velocity (m/s).
    pub velocity_m_per_s: Position,
    /// Covariance of place and velocity along each axis. The axes are independent and have the same covariance.
    pub covariance: AxisCovariance,
}

/// Covariance of place and velocity along one axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisCovariance {
    /// Variance of the place (m²).
    pub place_m2: f64,
    /// Covariance of place and velocity (m²/s).
    pub cross_m2_per_s: f64,
    /// Variance of the velocity (m²/s²).
    pub velocity_m2_per_s2: f64,
}

impl AxisCovariance {
    /// After `t_s` seconds at constant velocity: A P Aᵀ.
    pub(super) fn after(self, t_s: f64) -> Self {
        let cross_m2_per_s = self.cross_m2_per_s + t_s * self.velocity_m2_per_s2;
        Self { place_m2: self.place_m2 + t_s * (self.cross_m2_per_s + cross_m2_per_s), cross_m2_per_s, ..self }
    }
}
