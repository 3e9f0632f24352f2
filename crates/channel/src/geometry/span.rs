//! Straight lines between two places, for the broad phase.

use crate::geometry::bounds::Bounds;
use crate::geometry::position::Position;

/// The straight line between two places, prepared for many tests against boxes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Span {
    middle: Position,
    half: Position,
    reach: Position,
}

/// Tolerance of the box test (m): a line outside by up to this much still counts as meeting the box.
const SLACK_M: f64 = 1e-9;

impl Span {
    /// The line from `from` to `to`.
    #[inline]
    pub(crate) fn new(from: Position, to: Position) -> Self {
        let half = (to - from) * 0.5;
        let reach = Position::new(half.x_m.abs(), half.y_m.abs(), half.z_m.abs());
        Self { middle: from + half, half, reach }
    }

    /// Whether the line meets `bounds`, by separating axes (Ericson 2005, Real-Time Collision Detection, 5.3.3):
    /// no division, so no special case for lines along an axis. May be true up to a nanometre outside; never false
    /// inside.
    #[inline]
    pub(crate) fn meets(&self, bounds: Bounds) -> bool {
        let extent = (bounds.max - bounds.min) * 0.5;
        let m = self.middle - bounds.center();
        let (h, r) = (self.half, self.reach);
        let (ex, ey, ez) = (extent.x_m + SLACK_M, extent.y_m + SLACK_M, extent.z_m + SLACK_M);
        m.x_m.abs() <= ex + r.x_m
            && m.y_m.abs() <= ey + r.y_m
            && m.z_m.abs() <= ez + r.z_m
            && (m.y_m * h.z_m - m.z_m * h.y_m).abs() <= ey * r.z_m + ez * r.y_m + SLACK_M * SLACK_M
            && (m.z_m * h.x_m - m.x_m * h.z_m).abs() <= ex * r.z_m + ez * r.x_m + SLACK_M * SLACK_M
            && (m.x_m * h.y_m - m.y_m * h.x_m).abs() <= ex * r.y_m + ey * r.x_m + SLACK_M * SLACK_M
    }
}
