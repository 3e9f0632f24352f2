//! Paths and tracks that were estimated, as files.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path as FilePath;

use sextant_kernel::{RobotId, SimTime};
use sextant_mapper::{EstimatedPath, PathPose, Track};
use sextant_recording::admission::TUM_PATH;
use sextant_recording::output::write_whole;

use crate::csv::output::Output;
use crate::error::robot_log_error::RobotLogError;
use crate::time::instant;

/// Writes an estimated path to the file `path`: `t_s,robot,x_m,y_m,z_m`, the covariance of x and y (m²), where the path was
/// believed to be (m), and how far the frame of odometry is turned (rad). `robots` are the names of the robots by number. If the
/// name of the file ends in `.tum`, it gets the rows `time x y z qx qy qz qw` of one robot instead; the rotation is that of the frame
/// of odometry. `middles` are the middles of stops that are parts of a path ([`RobotLog`](crate::RobotLog)): of a path by packets the
/// place of a stop is the mean over its time, so its row has the middle of it.
///
/// # Errors
/// If the file cannot be written, or TUM is asked for and there are several robots.
pub fn write_path(
    path: &FilePath,
    estimated: &EstimatedPath,
    middles: &BTreeMap<(RobotId, SimTime), SimTime>,
    robots: impl Fn(RobotId) -> String,
) -> Result<(), RobotLogError> {
    let is_by_stops = estimated.fit.ranges.is_none();
    let time_of =
        |pose: &PathPose| middles.get(&(pose.robot, pose.time)).copied().filter(|_| is_by_stops).unwrap_or(pose.time);
    if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("tum")) {
        let first = estimated.poses.first().map(|pose| pose.robot);
        if estimated.poses.iter().any(|pose| Some(pose.robot) != first) {
            let problem =
                "a TUM file holds the path of one robot, and there are several; allowed: a name that ends in .csv";
            return Err(RobotLogError::line(path, 1, problem));
        }
        let mut text = TUM_PATH.to_owned();
        for pose in &estimated.poses {
            let (sin, cos) = libm::sincos(0.5 * pose.turn_rad);
            let (time, place) = (instant::format(time_of(pose)), pose.position);
            let _ = writeln!(text, "{time} {} {} {} 0 0 {sin} {cos}", place.x_m, place.y_m, place.z_m);
        }
        return write_whole(path, text.as_bytes()).map_err(|why| RobotLogError::write(path, why));
    }
    let covariance = ["cov_xx_m2", "cov_xy_m2", "cov_yy_m2"];
    let header =
        [&["t_s", "robot", "x_m", "y_m", "z_m"][..], &covariance, &["believed_x_m", "believed_y_m", "turn_rad"]];
    let mut output = Output::new(&header.concat());
    for pose in &estimated.poses {
        output.instant(time_of(pose)).text(&robots(pose.robot)).position(pose.position);
        let [[xx, xy], [_, yy]] = pose.covariance;
        output.number(xx).number(xy).number(yy);
        output.number(pose.believed.x_m).number(pose.believed.y_m).number(pose.turn_rad).end();
    }
    output.save(path)
}

/// Writes the tracks of tags to the file `path`: `t_s,tag,x_m,y_m,z_m`, the covariance of x and y and the variance of z (m²), and the
/// velocity (m/s). The variance of z is empty where the height is given or that of the receivers.
///
/// # Errors
/// If the file cannot be written.
pub fn write_tracks(path: &FilePath, tracks: &[(String, Track)]) -> Result<(), RobotLogError> {
    let covariance = ["cov_xx_m2", "cov_xy_m2", "cov_yy_m2", "cov_zz_m2"];
    let header =
        [&["t_s", "tag", "x_m", "y_m", "z_m"][..], &covariance, &["velocity_x_m_per_s", "velocity_y_m_per_s"]];
    let mut output = Output::new(&header.concat());
    for (tag, track) in tracks {
        for pose in &track.poses {
            output.instant(pose.time).text(tag).position(pose.position);
            let [[xx, xy], [_, yy]] = pose.covariance;
            output.number(xx).number(xy).number(yy);
            output.text(&pose.height_variance_m2.map_or_else(String::new, |variance| variance.to_string()));
            let [x, y] = pose.velocity_m_per_s;
            output.number(x).number(y).end();
        }
    }
    output.save(path)
}
