//! Motion in space along a curve of given curvature and torsion.

use sextant_channel::Position;

/// The frame that moves along a curve (Frenet 1852, Serret 1851): t' = κ n, n' = -κ t + τ b, b' = -τ n, with the
/// derivatives by length. A vehicle with constant speed that commands its pitch and yaw rates moves like this (Cochran,
/// Siranosian, Ghods, Krstic 2009, "3-D source seeking for underactuated vehicles without position measurement", section
/// II).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MovingFrame {
    /// Where it goes.
    pub(super) tangent: Position,
    /// Where a positive curvature bends it.
    pub(super) normal: Position,
}

impl MovingFrame {
    /// The frame of a vehicle that looks level into `heading_rad`; a positive curvature bends its path to the left.
    pub(super) fn level(heading_rad: f64) -> Self {
        let (sin, cos) = (libm::sin(heading_rad), libm::cos(heading_rad));
        Self { tangent: Position::new(cos, sin, 0.0), normal: Position::new(-sin, cos, 0.0) }
    }

    fn binormal(&self) -> Position {
        self.tangent.cross(self.normal)
    }

    /// Moves on by `length_m` along a curve with `curvature` and `torsion` (1/m), and returns the displacement (m). The
    /// motion is exact: a frame turns at constant rates about a fixed axis, τ t + κ b (Darboux).
    pub(super) fn advance(&mut self, length_m: f64, curvature: f64, torsion: f64) -> Position {
        let binormal = self.binormal();
        let darboux = self.tangent * torsion + binormal * curvature;
        let rate = darboux.length_m();
        if rate * length_m < 1e-12 {
            return self.tangent * length_m;
        }
        let axis = darboux * (1.0 / rate);
        let angle = rate * length_m;
        // The tangent has a part along the axis, which stays, and one that turns about it.
        let along = axis * axis.dot(self.tangent);
        let across = self.tangent - along;
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let displacement = along * length_m + across * (sin / rate) + axis.cross(across) * ((1.0 - cos) / rate);
        self.tangent = unit(turned(self.tangent, axis, sin, cos));
        let normal = turned(self.normal, axis, sin, cos);
        // Rounding must not bend the right angle.
        self.normal = unit(normal - self.tangent * normal.dot(self.tangent));
        displacement
    }
}

/// A vector turned about an axis of unit length (Rodrigues 1840).
fn turned(vector: Position, axis: Position, sin: f64, cos: f64) -> Position {
    vector * cos + axis.cross(vector) * sin + axis * (axis.dot(vector) * (1.0 - cos))
}

fn unit(vector: Position) -> Position {
    vector * (1.0 / vector.length_m())
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    #[test]
    fn without_torsion_a_curve_is_a_circle_to_the_left() {
        let mut frame = MovingFrame::level(0.0);
        // A quarter of a circle with radius 2 m.
        let step = frame.advance(PI, 0.5, 0.0);
        assert!(step.distance_m(Position::new(2.0, 2.0, 0.0)) < 1e-12);
        assert!(frame.tangent.distance_m(Position::new(0.0, 1.0, 0.0)) < 1e-12);
        assert!(frame.normal.distance_m(Position::new(-1.0, 0.0, 0.0)) < 1e-12);
    }

    #[test]
    fn curvature_and_torsion_make_a_helix() {
        // Radius κ / (κ² + τ²) and rise of one turn 2π τ / (κ² + τ²), at 2π / sqrt(κ² + τ²) of length.
        let (curvature, torsion) = (0.6, 0.3);
        let square = curvature * curvature + torsion * torsion;
        let turn_m = 2.0 * PI / f64::sqrt(square);
        let mut frame = MovingFrame::level(FRAC_PI_2);
        let start = frame;
        let mut place = Position::ORIGIN;
        let mut farthest: f64 = 0.0;
        for _ in 0..1000 {
            place = place + frame.advance(turn_m / 1000.0, curvature, torsion);
            farthest = farthest.max(place.dot(start.normal));
        }
        assert!((place.length_m() - 2.0 * PI * torsion / square).abs() < 1e-9);
        assert!(frame.tangent.distance_m(start.tangent) < 1e-9 && frame.normal.distance_m(start.normal) < 1e-9);
        assert!((farthest - 2.0 * curvature / square).abs() < 1e-6, "{farthest}");
    }

    #[test]
    fn a_frame_stays_at_right_angles() {
        let mut frame = MovingFrame::level(1.0);
        for i in 0..10_000 {
            frame.advance(0.1, f64::from(i % 7) - 3.0, 0.2);
        }
        assert!(frame.tangent.dot(frame.normal).abs() < 1e-12);
        assert!((frame.tangent.length_m() - 1.0).abs() < 1e-12 && (frame.normal.length_m() - 1.0).abs() < 1e-12);
    }
}
