//! `path.csv`: where robots were over time.

use std::path::Path as FilePath;

use super::error::RobotLogError;
use super::local_plane::LocalPlane;
use super::path::{Path, Pose};
use super::place::{COLUMNS, Frame, Places};
use super::table::Table;
use crate::robot_names::RobotNames;

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

/// Reads the paths in the file `path`: `t_s,x_m,y_m[,z_m][,robot]` or `t_s,lat,lon[,alt_m][,robot]`.
pub(super) fn read(path: &FilePath, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let table = Table::open(path, &["t_s"], &[&COLUMNS[..], &["robot"]].concat())?;
    notes.extend(table.ignored());
    let places = Places::of(&table, Frame::Any, notes)?;
    let [time, robot] = ["t_s", "robot"].map(|name| table.column(name));
    let mut robots = RobotNames::default();
    let mut plane = None;
    // The poses of each robot, and where their rows begin.
    let mut poses: Vec<(Vec<Pose>, Vec<u64>)> = vec![(Vec::new(), Vec::new())];
    let head = table.rows(|row| {
        let robot = row.robot(robot, &mut robots)?.index();
        if poses.len() <= robot {
            poses.resize_with(robot + 1, Default::default);
        }
        let pose = Pose { time: row.instant(time)?, position: places.read(row, &mut plane)? };
        poses[robot].0.push(pose);
        poses[robot].1.push(row.offset);
        Ok(())
    })?;
    let path_of = |(poses, offsets): (Vec<Pose>, Vec<u64>)| {
        Path::new(poses).map_err(|why| match why.index() {
            Some(index) => head.wrong_row(offsets[index], why.to_string()),
            None => RobotLogError::Path { path: path.to_owned(), why },
        })
    };
    let paths = poses.into_iter().map(path_of).collect::<Result<_, _>>()?;
    Ok(Paths { paths, robots, is_named: robot.exists(), plane })
}
