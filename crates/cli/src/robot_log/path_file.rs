//! `path.csv`: where robots were over time.

use std::path::Path as FilePath;

use super::error::RobotLogError;
use super::field_names::FieldNames;
use super::header::{Known, Others};
use super::instant;
use super::path::{Path, Pose};
use super::paths::Paths;
use super::place::{COLUMNS, Frame, Places};
use super::table::Table;
use super::times::Times;
use crate::robot_names::RobotNames;

/// Reads the paths in the file `path`: `t_s,x_m,y_m[,z_m][,robot]` or `t_s,lat,lon[,alt_m][,robot]`, or with the `names` of
/// the user.
pub(super) fn read(path: &FilePath, names: &FieldNames, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let optional = [&instant::COLUMNS[..], &COLUMNS, &["robot"]].concat();
    let table =
        Table::open_known(path, Known { required: &[], optional: &optional, names, others: Others::Ignored })?;
    notes.extend(table.ignored());
    let time = Times::of(&table, notes)?;
    let places = Places::of(&table, Frame::Any, notes)?;
    let robot = table.column("robot");
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
