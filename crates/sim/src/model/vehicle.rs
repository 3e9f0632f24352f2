//! A robot as it drives.

use sextant_channel::Position;
use sextant_kernel::{EventKey, SimTime};

use crate::station::{Motion, Pose, RobotBody, Trip};

/// A robot as it drives. How it really moves is in the scene.
pub(crate) struct Vehicle {
    pub(crate) body: RobotBody,
    /// How it believes to move.
    pub(crate) belief: Motion,
    /// The drive under way.
    pub(crate) drive: Option<Drive>,
    pub(crate) path_length_m: f64,
    /// Number of drives so far.
    pub(crate) drives: u64,
    /// The pending event that draws its halo anew.
    pub(crate) halo_due: Option<EventKey>,
}

/// A drive under way.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Drive {
    /// The true way.
    pub(crate) trip: Trip,
    /// The point of contact at its end, where the robot believes it to be, if an obstacle ends it.
    pub(crate) contact: Option<Position>,
    /// The event of its end.
    pub(crate) end: EventKey,
    /// The part of an arc that is over before the end, and its event.
    pub(crate) part: Option<(u32, EventKey)>,
}

impl Vehicle {
    pub(crate) fn new(body: RobotBody) -> Self {
        let belief = body.believed_start.map_or(Motion::standing(body.start), Motion::Standing);
        Self { body, belief, drive: None, path_length_m: 0.0, drives: 0, halo_due: None }
    }

    /// The pose that the robot believes to have.
    pub(crate) fn believed_at(&self, time: SimTime) -> Pose {
        self.belief.pose_at(time)
    }
}
