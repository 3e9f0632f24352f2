//! Places from distances and angles to known places (Gunathillake 2018, appendix A).

mod multilateration;
mod triangulation;

pub use multilateration::{Range, multilaterate, multilaterate_linear, refine, trilaterate};
pub use triangulation::triangulate;

/// Reasons why a place cannot be computed from distances or angles.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LaterationError {
    /// Too few anchors.
    #[error("{found} anchors; a place in {dimensions} dimensions needs at least {}", .dimensions + 1)]
    TooFew {
        /// Anchors found.
        found: usize,
        /// Dimensions of the space.
        dimensions: usize,
    },
    /// Anchors on one line (in one plane).
    #[error("the anchors lie on one line or in one plane, so that two places fit alike")]
    Degenerate,
    /// The place lies on the circle through the anchors, or on one line with them.
    #[error("the place lies on the circle through the anchors, where all places see them under the same angles")]
    OnCircle,
    /// A distance, angle or place is not finite.
    #[error("a place, a distance or an angle is not finite")]
    NotFinite,
}
