//! The paths of the robots of a log, from any file.

use super::local_plane::LocalPlane;
use super::path::Path;
use sextant_recording::RobotNames;

/// The paths of robots.
pub(super) struct Paths {
    /// By number of the robot, at least one.
    pub(super) paths: Vec<Path>,
    /// Names of the robots, if the file names them.
    pub(super) robots: RobotNames,
    /// Whether the file names the robots.
    pub(super) is_named: bool,
    /// The plane of the places, if they are given by latitude and longitude.
    pub(super) plane: Option<LocalPlane>,
}

impl Paths {
    /// The path of one robot without a name.
    pub(super) fn of_one(path: Path, plane: Option<LocalPlane>) -> Self {
        Self { paths: vec![path], robots: RobotNames::default(), is_named: false, plane }
    }
}
