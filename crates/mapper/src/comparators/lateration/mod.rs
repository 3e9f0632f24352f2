//! Places from distances and angles to known places (Gunathillake 2018, appendix A), and from differences of distances.

mod angulation;
mod multilateration;
mod time_difference;
mod triangulation;

pub use angulation::{Bearing, MeasuredAngle, angulate};
pub use multilateration::{Range, multilaterate, multilaterate_linear, refine};
pub use time_difference::{differences_tell_distance, locate_by_differences};
pub use triangulation::triangulate;

use crate::numerics::least_squares::Damping;

/// Maximum number of steps of a refinement, and how it is damped.
const STEPS: u32 = 100;
const DAMPING: Damping = Damping { first: 1e-3, ease: 0.2, least: 1e-15, tighten: 5.0, most: 5e12 };

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
    /// Too few anchors for differences.
    #[error("{found} anchors; a place in {dimensions} dimensions by differences needs at least {}", .dimensions + 2)]
    TooFewDifferences {
        /// Anchors found.
        found: usize,
        /// Dimensions of the space.
        dimensions: usize,
    },
    /// Too few directions.
    #[error("{found} directions; a place needs at least 2")]
    TooFewDirections {
        /// Directions found.
        found: usize,
    },
    /// The directions are those of one line, or nearly parallel.
    #[error("the directions are nearly parallel, so that it is not known where their lines cross")]
    Parallel,
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
