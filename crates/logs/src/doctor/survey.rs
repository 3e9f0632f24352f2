//! Where the robots of a log were: what of its places can be judged without what they heard.

use sextant_channel::{Position, ReceptionLog, Stop};
use sextant_kernel::SimTime;

use super::super::local_plane::LocalPlane;
use super::super::path::Path;

/// Where a robot was at a time.
pub(crate) type Place = (SimTime, Position);

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
    pub(super) robots: Vec<Vec<Place>>,
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

/// The places of `stops` by robot, in their order.
pub(crate) fn places_of<'a>(stops: impl IntoIterator<Item = &'a Stop>) -> Vec<Vec<Place>> {
    let mut robots: Vec<Vec<Place>> = Vec::new();
    for stop in stops {
        let robot = stop.robot.index();
        if robots.len() <= robot {
            robots.resize_with(robot + 1, Vec::new);
        }
        robots[robot].push((stop.time, stop.position));
    }
    robots
}
