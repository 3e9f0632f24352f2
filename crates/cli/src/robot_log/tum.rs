//! Paths as the RGB-D benchmark of TU Munich writes them: `time x y z qx qy qz qw` a line, in seconds and metres.

use std::fs::File;
use std::io::{BufRead, BufReader};
use std::path::Path as FilePath;

use sextant_channel::Position;

use super::error::RobotLogError;
use super::instant;
use super::path::{Path, Pose};
use super::paths::Paths;

/// Reads the path in the file `path`. The rotation is not used; it may be absent.
pub(super) fn read(path: &FilePath) -> Result<Paths, RobotLogError> {
    let unreadable = |why: std::io::Error| RobotLogError::read(path, why);
    let wrong = |line: usize, problem: String| RobotLogError::Row { path: path.to_owned(), line, problem };
    let input = BufReader::new(File::open(path).map_err(unreadable)?);
    let mut poses = Vec::new();
    let mut lines = Vec::new();
    for (line, text) in (1..).zip(input.lines()) {
        let text = text.map_err(unreadable)?;
        if is_blank(&text) {
            continue;
        }
        poses.push(pose(&text).ok_or_else(|| {
            wrong(line, format!("found `{}`; allowed: time x y z qx qy qz qw, in seconds and metres", text.trim()))
        })?);
        lines.push(line);
    }
    let path = Path::new(poses).map_err(|why| match why.index() {
        Some(index) => wrong(lines[index], why.to_string()),
        None => RobotLogError::Path { path: path.to_owned(), why },
    })?;
    Ok(Paths::of_one(path, None))
}

/// Whether `line`, which is not blank, is one of such a file.
pub(super) fn is_pose(line: &str) -> bool {
    pose(line).is_some()
}

/// Whether a line holds nothing: it is empty or a comment.
pub(super) fn is_blank(line: &str) -> bool {
    let text = line.trim();
    text.is_empty() || text.starts_with('#')
}

fn pose(line: &str) -> Option<Pose> {
    let words: Vec<&str> = line.split_whitespace().collect();
    let (time, numbers) = words.split_first()?;
    let numbers: Vec<f64> = numbers.iter().map(|word| word.parse().ok()).collect::<Option<_>>()?;
    let time = instant::parse(time)?;
    match *numbers.as_slice() {
        [x_m, y_m, z_m] | [x_m, y_m, z_m, _, _, _, _] if numbers.iter().all(|number| number.is_finite()) => {
            Some(Pose { time, position: Position::new(x_m, y_m, z_m) })
        }
        _ => None,
    }
}
