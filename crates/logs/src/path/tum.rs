//! Paths as the RGB-D benchmark of TU Munich writes them: `time x y z qx qy qz qw` a line, in seconds and metres. Other programs
//! write the time in nanoseconds since 1970, which has so many digits that it is no other one.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path as FilePath;

use sextant_channel::Position;

use super::paths::Paths;
use super::robot_path::{Path, Pose};
use crate::csv::lines::LinesOf;
use crate::error::robot_log_error::RobotLogError;
use crate::place::without_fix::leave_out;
use crate::time::instant;

/// Reads the path in the file `path`. The rotation is not used; it may be absent. If `skips_no_fix`, lines
/// without a place are left out.
pub(crate) fn read(path: &FilePath, skips_no_fix: bool, notes: &mut Vec<String>) -> Result<Paths, RobotLogError> {
    let unreadable = |why: std::io::Error| RobotLogError::read(path, why);
    let wrong = |line: usize, problem: String| RobotLogError::line(path, line, problem);
    let input = BufReader::new(LinesOf::new(File::open(path).map_err(unreadable)?));
    let mut poses = Vec::new();
    let mut left_out = 0;
    let mut unit = None;
    for (line, text) in (1..).zip(input.lines()) {
        let text = text.map_err(unreadable)?;
        if is_blank(&text) {
            continue;
        }
        let unit = *unit.get_or_insert_with(|| TimeDigits::of(&text));
        match pose(&text, unit) {
            Some(pose) if pose.position.is_finite() => poses.push((pose, line)),
            Some(pose) if skips_no_fix && pose.position.x_m.is_nan() && pose.position.y_m.is_nan() => left_out += 1,
            _ => {
                let allowed = format!("time x y z qx qy qz qw, in {} and metres", unit.name);
                return Err(wrong(line, format!("found `{}`; allowed: {allowed}", text.trim())));
            }
        }
    }
    if skips_no_fix {
        left_out += leave_out(&mut poses, |(pose, _)| (pose.time, pose.position));
    }
    if left_out > 0 {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        notes.push(format!("{file}: {left_out} places without a fix are left out (option `skip_no_fix`)"));
    }
    if let Some(unit) = unit.filter(|unit| unit.places > 0) {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        notes.push(format!("{file}: times are {} since 1970, by the number of their digits", unit.name));
    }
    let (poses, lines): (Vec<Pose>, Vec<usize>) = poses.into_iter().unzip();
    let path = Path::new(poses).map_err(|why| match why.index() {
        Some(index) => wrong(lines[index], why.to_string()),
        None => RobotLogError::Path { part: path.into(), why },
    })?;
    Ok(Paths::of_one(path, None))
}

/// Whether `line`, which is not blank, is one of such a file.
pub(crate) fn is_pose(line: &str) -> bool {
    pose(line, TimeDigits::of(line)).is_some()
}

/// Whether a line holds nothing: it is empty or a comment.
pub(crate) fn is_blank(line: &str) -> bool {
    let text = line.trim();
    text.is_empty() || text.starts_with('#')
}

/// A unit of time.
#[derive(Clone, Copy)]
struct TimeDigits {
    name: &'static str,
    /// How many of it are a second, as a power of ten.
    places: usize,
}

impl TimeDigits {
    /// The unit of the time in a line: seconds, unless it has so many digits that they would be thousands of years after 1970.
    fn of(line: &str) -> Self {
        let time = line.split_whitespace().next().unwrap_or_default();
        let whole = time.split('.').next().unwrap_or_default();
        let (name, places) = match whole.len() {
            _ if !whole.bytes().all(|octet| octet.is_ascii_digit()) => ("seconds", 0),
            12..=14 => ("milliseconds", 3),
            15..=17 => ("microseconds", 6),
            18..=20 => ("nanoseconds", 9),
            _ => ("seconds", 0),
        };
        Self { name, places }
    }
}

fn pose(line: &str, unit: TimeDigits) -> Option<Pose> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (time, numbers) = words.split_first()?;
    let numbers: Vec<f64> = numbers.iter().map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let time = instant::parse_scaled(time, unit.places)?;
    match *numbers.as_slice() {
        [x_m, y_m, z_m] | [x_m, y_m, z_m, _, _, _, _] => Some(Pose { time, position: Position::new(x_m, y_m, z_m) }),
        _ => None,
    }
}
