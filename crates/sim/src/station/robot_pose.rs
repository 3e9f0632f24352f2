//! Where a robot is, and where it believes to be.

use super::Pose;

/// Where a robot is, and where it believes to be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotPose {
    /// Where it is.
    pub truth: Pose,
    /// Where it believes to be.
    pub belief: Pose,
}

impl RobotPose {
    /// Where it believes to start, if it starts there again and looks along x: `None` if it believes what is true.
    #[must_use]
    pub fn believed_start(&self) -> Option<Pose> {
        let heading_rad = self.belief.heading_rad - self.truth.heading_rad;
        (self.belief != self.truth).then_some(Pose { heading_rad, ..self.belief })
    }
}
