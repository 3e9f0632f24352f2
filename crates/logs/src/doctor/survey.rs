//! Where the robots of a log were: what of its places can be judged without what they heard.

use sextant_channel::ReceptionLog;

use crate::path::robot_path::Path;
use crate::place::local_plane::LocalPlane;
use crate::place::without_fix::{TimedPlace, places_of};

/// What the places of a survey are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Points {
    /// Of a path: many a second as a rule, and the legs between them are drives.
    Poses,
    /// Where robots stayed to listen.
    Stops,
}

impl Points {
    /// The word for them.
    pub(super) const fn noun(self) -> &'static str {
        match self {
            Self::Poses => "poses",
            Self::Stops => "stops",
        }
    }
}

/// Where the robots of a log were.
#[derive(Clone, Debug)]
pub(super) struct Survey<'a> {
    /// The places of each robot, in the order of time.
    pub(super) robots: Vec<Vec<TimedPlace>>,
    pub(super) points: Points,
    /// The plane of the places, if they were given by latitude and longitude.
    pub(super) plane: Option<&'a LocalPlane>,
    /// What was heard there.
    pub(super) log: &'a ReceptionLog,
}

impl<'a> Survey<'a> {
    /// The survey of robots that drove `paths` and heard `log`.
    pub(super) fn of_paths<'p>(
        paths: impl Iterator<Item = &'p Path>,
        log: &'a ReceptionLog,
        plane: Option<&'a LocalPlane>,
    ) -> Self {
        let places_of = |path: &Path| path.poses().iter().map(|pose| (pose.time, pose.position)).collect();
        Self { robots: paths.map(places_of).collect(), points: Points::Poses, plane, log }
    }

    /// The survey of a log that has its stops.
    pub(super) fn of_stops(log: &'a ReceptionLog, plane: Option<&'a LocalPlane>) -> Self {
        Self { robots: places_of(log.stops()), points: Points::Stops, plane, log }
    }
}
