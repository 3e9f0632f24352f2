//! Cutting a straight line by the faces of a convex solid.

/// Depth below which a line counts as running along a face, not inside [m]. Solids are open sets: what only
/// touches is not crossed, so that stations on a wall see each other along it.
pub(crate) const GRAZE_M: f64 = 1e-9;

/// The part of a line that is left, as parameters from 0 (its start) to 1 (its end).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Clip {
    enter: f64,
    leave: f64,
}

impl Clip {
    /// All of the line.
    pub(crate) const WHOLE: Self = Self { enter: 0.0, leave: 1.0 };

    /// Keeps the part behind a face. `start_m` and `end_m` are the signed distances of the two ends from the
    /// plane of the face, positive outside.
    pub(crate) fn behind(self, start_m: f64, end_m: f64) -> Self {
        if start_m >= -GRAZE_M && end_m >= -GRAZE_M {
            return Self { enter: 1.0, leave: 0.0 };
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

    /// Share of the line that is left.
    pub(crate) fn share(self) -> f64 {
        (self.leave - self.enter).max(0.0)
    }
}
