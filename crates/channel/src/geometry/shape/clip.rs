//! Clipping a straight line by the faces of a convex solid.

/// Depth below which a line counts as running along a face, not inside (m). Solids are open sets: a line that only
/// touches a solid does not cross it, so that stations on a wall see each other along it.
pub(crate) const GRAZE_M: f64 = 1e-9;

/// The remaining part of a line, as parameters from 0 (its start) to 1 (its end).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clip {
    enter: f64,
    leave: f64,
}

impl Clip {
    /// The whole line.
    pub(crate) const WHOLE: Self = Self { enter: 0.0, leave: 1.0 };

    /// Nothing of the line.
    pub(crate) const NONE: Self = Self { enter: 1.0, leave: 0.0 };

    /// Keeps the part behind a face. `start_m` and `end_m` are the signed distances of the two ends from the
    /// plane of the face, positive outside.
    pub(crate) fn behind(self, start_m: f64, end_m: f64) -> Self {
        if start_m >= -GRAZE_M && end_m >= -GRAZE_M {
            return Self::NONE;
        }
        let mut clip = self;
        if start_m > 0.0 {
            clip.enter = clip.enter.max(start_m / (start_m - end_m));
        }
        if end_m > 0.0 {
            clip.leave = clip.leave.min(start_m / (start_m - end_m));
        }
        clip
    }

    /// Keeps the part between two parameters.
    pub(crate) fn between(self, enter: f64, leave: f64) -> Self {
        Self { enter: self.enter.max(enter), leave: self.leave.min(leave) }
    }

    /// Where the remaining part begins and ends, if there is one.
    pub(crate) fn ends(self) -> Option<[f64; 2]> {
        (self.leave > self.enter).then_some([self.enter, self.leave])
    }

    /// Remaining share of the line.
    pub(crate) fn share(self) -> f64 {
        (self.leave - self.enter).max(0.0)
    }
}
