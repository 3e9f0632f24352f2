//! Errors of paths.

use std::time::Duration;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use crate::time::instant;

/// Why poses are no path.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PathError {
    /// Not enough poses.
    #[error("the path has {poses} poses at different times; at least two are required")]
    TooFew {
        /// Poses at different times.
        poses: usize,
    },
    /// A place is not finite or too far away.
    #[error("the place {position} is invalid; allowed: coordinates in metres, at most 10⁹ from zero")]
    NotFinite {
        /// Index of the pose.
        index: usize,
        /// The place.
        position: Position,
    },
    /// The clock went back.
    #[error(
        "the time goes back by {} s, from {} s to {} s; allowed: poses in the order of time, at most {} s late: \
         correct the times, or remove the poses of one of the clocks",
        instant::format_span(.from.saturating_since(*.to)), instant::format(*.from), instant::format(*.to),
        instant::format_span(PathError::MOST_LATE)
    )]
    Backwards {
        /// Index of the pose.
        index: usize,
        /// The latest time before it.
        from: SimTime,
        /// Its time.
        to: SimTime,
    },
    /// Two places at the same time.
    #[error(
        "two places at {} s, {distance_m:.1} m from each other; the poses of several robots need a column `robot`",
        instant::format(*.time)
    )]
    TwoPlaces {
        /// Index of the second pose.
        index: usize,
        /// The time.
        time: SimTime,
        /// The distance between the places (m).
        distance_m: f64,
    },
}

impl PathError {
    /// A pose may come this much later than a pose with a later time.
    pub(crate) const MOST_LATE: Duration = Duration::from_secs(1);

    /// Index of the pose that is wrong, if it is one.
    #[must_use]
    pub fn index(&self) -> Option<usize> {
        match self {
            Self::TooFew { .. } => None,
            Self::NotFinite { index, .. } | Self::Backwards { index, .. } | Self::TwoPlaces { index, .. } => {
                Some(*index)
            }
        }
    }
}
