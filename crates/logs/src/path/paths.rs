//! The paths of the robots of a log, from any file.

use super::robot_path::Path;
use crate::place::local_plane::LocalPlane;
use sextant_recording::RobotNames;

/// The paths of robots.
pub(crate) struct Paths {
    /// By number of the robot, at least one.
    pub(crate) paths: Vec<Path>,
    /// Names of the robots, if the file names them.
    pub(crate) robots: RobotNames,
    /// Whether the file names the robots.
    pub(crate) is_named: bool,
    /// The plane of the places, if they are given by latitude and longitude.
    pub(crate) plane: Option<LocalPlane>,
    /// The column with the headings of the robots, if the file has one.
    pub(crate) headings: Option<&'static str>,
}

impl Paths {
    /// The path of one robot without a name.
    pub(crate) fn of_one(path: Path, plane: Option<LocalPlane>) -> Self {
        Self { paths: vec![path], robots: RobotNames::default(), is_named: false, plane, headings: None }
    }
}
