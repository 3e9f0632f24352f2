//! Fixes of a satellite receiver in a file: latitude and longitude with a time.

use std::path::Path as FilePath;

use sextant_channel::Position;
use sextant_kernel::SimTime;

use super::paths::Paths;
use super::robot_path::{Path, Pose};
use crate::error::robot_log_error::RobotLogError;
use crate::place::local_plane::LocalPlane;

/// Where a receiver was.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Fix {
    pub(crate) time: SimTime,
    pub(crate) lat_deg: f64,
    pub(crate) lon_deg: f64,
    /// Above the sea (m), if it is known.
    pub(crate) height_m: Option<f64>,
}

impl Fix {
    /// Whether the receiver had none: both coordinates are NaN or 0.
    fn is_none(&self) -> bool {
        let both = |is: fn(f64) -> bool| is(self.lat_deg) && is(self.lon_deg);
        both(f64::is_nan) || both(|angle_deg| angle_deg.abs() <= 0.0)
    }
}

/// Puts fixes into the plane around the first of them.
#[derive(Default)]
pub(crate) struct FixTrack {
    /// Whether places that are no fix are left out.
    skips_no_fix: bool,
    plane: Option<LocalPlane>,
    poses: Vec<Pose>,
    /// The line of each pose in the file.
    lines: Vec<usize>,
    left_out: u64,
    refused: Refused,
    /// Of the last fix that has one (m).
    height_m: Option<f64>,
}

/// Points that are none.
#[derive(Default)]
struct Refused {
    count: usize,
    /// The line of the first one, and what is wrong with it.
    first: Option<(usize, String)>,
}

impl FixTrack {
    pub(crate) fn new(skips_no_fix: bool) -> Self {
        Self { skips_no_fix, ..Self::default() }
    }

    /// Adds the fix in a line. One without a height is as high as the one before it. One that is no place on the earth, near a
    /// pole or far from the first one is refused.
    pub(crate) fn add(&mut self, fix: Fix, line: usize) {
        if let Err(problem) = self.try_add(fix, line) {
            self.refuse(line, problem);
        }
    }

    /// Refuses the point in a line.
    pub(crate) fn refuse(&mut self, line: usize, problem: String) {
        self.refused.count += 1;
        self.refused.first.get_or_insert((line, problem));
    }

    fn try_add(&mut self, fix: Fix, line: usize) -> Result<(), String> {
        if self.skips_no_fix && fix.is_none() {
            self.left_out += 1;
            return Ok(());
        }
        let Fix { time, lat_deg, lon_deg, height_m } = fix;
        let largest_deg = LocalPlane::LARGEST_LAT_DEG;
        // A comparison with NaN is false.
        if !(lat_deg.abs() <= largest_deg && lon_deg.abs() <= 180.0) {
            return Err(format!(
                "found latitude {lat_deg} and longitude {lon_deg}; allowed: degrees north from -{largest_deg} to {largest_deg} \
                 and degrees east from -180 to 180"
            ));
        }
        self.height_m = height_m.or(self.height_m);
        let height_m = self.height_m.or(self.plane.map(|plane| plane.origin().height_m)).unwrap_or(0.0);
        let plane = self.plane.get_or_insert_with(|| LocalPlane::new(lat_deg, lon_deg, height_m));
        if plane.distance_m(lat_deg, lon_deg, height_m) > LocalPlane::RADIUS_M {
            let origin = plane.origin();
            return Err(format!(
                "found latitude {lat_deg} and longitude {lon_deg}; allowed: a place at most {} km from the first one at {}, {}; a \
                 receiver without a fix often writes 0, 0: option `skip_no_fix` leaves such places out",
                LocalPlane::RADIUS_M / 1e3,
                origin.lat_deg,
                origin.lon_deg
            ));
        }
        let position: Position = plane.to_local(lat_deg, lon_deg, height_m);
        self.poses.push(Pose { time, position });
        self.lines.push(line);
        Ok(())
    }

    /// The path of these fixes, which are those of `file`. A few that were refused are skipped and counted.
    ///
    /// # Errors
    /// If they are no path, or more than one in ten was refused.
    pub(crate) fn finish(self, file: &FilePath, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
        let Self { plane, poses, lines, left_out, refused, .. } = self;
        if let Some((line, problem)) = refused.first {
            if refused.count > 1 && poses.len() < 9 * refused.count || poses.is_empty() {
                return Err(RobotLogError::line(file, line, problem));
            }
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            let (count, all) = (refused.count, refused.count + poses.len());
            notes.push(format!("{name}: {count} of {all} points are skipped; the first one, line {line}: {problem}"));
        }
        if left_out > 0 {
            let name = file.file_name().unwrap_or_default().to_string_lossy();
            notes.push(format!("{name}: {left_out} places without a fix are left out (option `skip_no_fix`)"));
        }
        let path = Path::new(poses).map_err(|why| match why.index() {
            Some(index) => RobotLogError::line(file, lines[index], why.to_string()),
            None => RobotLogError::Path { part: file.into(), why },
        })?;
        Ok(Paths::of_one(path, plane))
    }
}
