//! `path.csv`: where robots were over time.

use std::path::Path as FilePath;

use super::doctor::origin;
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

/// Reads the paths in the file `path`: `t_s,x_m,y_m[,z_m][,robot]` or `t_s,lat,lon[,alt_m][,robot]`. If `skips_no_fix`, rows
/// without a fix are left out.
pub(super) fn read(path: &FilePath, skips_no_fix: bool, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let table = Table::open(path, &["t_s"], &[&COLUMNS[..], &["robot"]].concat())?;
    notes.extend(table.ignored());
    let places = Places::of(&table, Frame::Any, notes)?;
    let [time, robot] = ["t_s", "robot"].map(|name| table.column(name));
    let mut robots = RobotNames::default();
    let mut plane = None;
    // The poses of each robot, and where their rows begin.
    let mut poses: Vec<(Vec<Pose>, Vec<u64>)> = vec![(Vec::new(), Vec::new())];
    let mut left_out = 0;
    let head = table.rows(|row| {
        if skips_no_fix && places.is_without_fix(row) {
            left_out += 1;
            return Ok(());
        }
        let robot = row.robot(robot, &mut robots)?.index();
        if poses.len() <= robot {
            poses.resize_with(robot + 1, Default::default);
        }
        let pose = Pose { time: row.instant(time)?, position: places.read(row, &mut plane)? };
        poses[robot].0.push(pose);
        poses[robot].1.push(row.offset);
        Ok(())
    })?;
    let all = poses.iter().flat_map(|(poses, _)| poses).map(|pose| pose.position);
    if skips_no_fix && origin::far_m(all).is_some() {
        for (poses, offsets) in &mut poses {
            let keeps: Vec<bool> = poses.iter().map(|pose| !origin::is_origin(pose.position)).collect();
            left_out += keeps.iter().filter(|keeps| !**keeps).count();
            let mut kept = keeps.iter();
            poses.retain(|_| kept.next().is_none_or(|keeps| *keeps));
            let mut kept = keeps.iter();
            offsets.retain(|_| kept.next().is_none_or(|keeps| *keeps));
        }
    }
    if left_out > 0 {
        notes.push(format!("{}: {left_out} rows without a fix are left out (`--skip-no-fix`)", head.file_name()));
    }
    let path_of = |(poses, offsets): (Vec<Pose>, Vec<u64>)| {
        Path::new(poses).map_err(|why| match why.index() {
            Some(index) => head.wrong_row(offsets[index], why.to_string()),
            None => RobotLogError::Path { path: path.to_owned(), why },
        })
    };
    let paths = poses.into_iter().map(path_of).collect::<Result<_, _>>()?;
    Ok(Paths { paths, robots, is_named: robot.exists(), plane })
}
