//! `path.csv`: where robots were over time.

use super::headings;
use super::paths::Paths;
use super::robot_path::{Path, Pose};
use crate::csv::header::{KnownColumns, Others};
use crate::csv::table::Table;
use crate::csv::table_source::TableSource;
use crate::csv::times::Times;
use crate::csv::written::Written;
use crate::error::robot_log_error::RobotLogError;
use crate::place::place_columns::{COLUMNS, Frame, Places};
use crate::place::without_fix::{is_origin, without_fix_m};
use crate::time::instant;
use sextant_recording::RobotNames;

/// Reads the paths in a table: `t_s,x_m,y_m[,z_m][,robot]` or `t_s,lat,lon[,alt_m][,robot]`, or as it
/// is `written`. Headings are read for themselves ([`PathHeadings`](headings::PathHeadings)). If `skips_no_fix`, rows without a fix
/// are left out.
pub(crate) fn read<'a>(
    source: impl Into<TableSource<'a>>,
    written: &Written,
    skips_no_fix: bool,
    notes: &mut Vec<String>,
) -> Result<Paths, RobotLogError> {
    // Others than these two are not taken for misspelt headings, which few paths need.
    let named = headings::COLUMNS.into_iter().filter(|key| written.names.name(key).is_some());
    let optional = [&instant::COLUMNS[..], &COLUMNS, &["robot"]].concat();
    let optional: Vec<&str> = optional.into_iter().chain(named).collect();
    let table = Table::open_known(
        source,
        KnownColumns { required: &[], optional: &optional, names: &written.names, others: Others::Ignored },
    )?;
    notes.extend(table.notes_besides(&headings::COLUMNS));
    let time = Times::of(&table, written.time_zone, notes)?;
    let places = Places::of(&table, Frame::Any, notes)?;
    let robot = table.column("robot");
    let headings = headings::COLUMNS.into_iter().find(|name| table.column(name).exists());
    let mut robots = RobotNames::default();
    let mut plane = None;
    // The poses of each robot, and where their rows begin.
    let mut poses: Vec<Vec<(Pose, u64)>> = vec![Vec::new()];
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
        poses[robot].push((pose, row.offset));
        Ok(())
    })?;
    // Of degrees, the rows themselves told.
    let places = |of_robot: &Vec<(Pose, u64)>| of_robot.iter().map(|(pose, _)| (pose.time, pose.position)).collect();
    let is_without_fix = || without_fix_m(&poses.iter().map(places).collect::<Vec<_>>()).is_some();
    if skips_no_fix && plane.is_none() && is_without_fix() {
        for of_robot in &mut poses {
            let before = of_robot.len();
            of_robot.retain(|(pose, _)| !is_origin(pose.position));
            left_out += before - of_robot.len();
        }
    }
    if left_out > 0 {
        notes.push(format!("{}: {left_out} rows without a fix are left out (option `skip_no_fix`)", head.name()));
    }
    let path_of = |rows: Vec<(Pose, u64)>| {
        let (poses, offsets): (Vec<Pose>, Vec<u64>) = rows.into_iter().unzip();
        Path::new(poses).map_err(|why| match why.index() {
            Some(index) => head.wrong_row(offsets[index], why.to_string()),
            None => RobotLogError::Path { part: head.part.clone(), why },
        })
    };
    let paths = poses.into_iter().map(path_of).collect::<Result<_, _>>()?;
    Ok(Paths { paths, robots, is_named: robot.exists(), plane, headings })
}
