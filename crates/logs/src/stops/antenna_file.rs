//! `antenna.toml`: the antenna of the robot, whose gains tell more than the directions of its sectors.

use std::path::Path;

use sextant_channel::{ListenerAntennaConfig, SectorGains};
use sextant_kernel::{Files, SettingError};
use sextant_recording::antenna_text;
use sextant_recording::output::write_whole;

use crate::error::robot_log_error::RobotLogError;

/// Reads the antenna in the file `path`; files that it names are in the same folder.
pub(crate) fn read(path: &Path, notes: &mut Vec<String>) -> Result<SectorGains, RobotLogError> {
    let text = sextant_kernel::read_text_at_most(path, sextant_kernel::LARGEST_FILE)
        .map_err(|why| RobotLogError::read(path, why))?;
    let wrong = |line: usize, problem: String| RobotLogError::line(path, line, problem);
    let config: ListenerAntennaConfig = toml::from_str(&text).map_err(|why| {
        let before = text.get(..why.span().map_or(0, |span| span.start)).unwrap_or_default();
        let line = 1 + before.matches('\n').count();
        let column = 1 + before.rsplit('\n').next().unwrap_or_default().chars().count();
        wrong(line, format!("column {column}: {}", why.message().trim()))
    })?;
    let files = path.parent().map_or_else(Files::default, Files::of_folder);
    let gains = SectorGains::read(&config, &files).map_err(|why| wrong(line_of(&text, &why.key), why.to_string()))?;
    if let Some(deg) = gains.antenna().endless_cut_deg() {
        notes.push(format!(
            "antenna.toml: the gains at elevation {deg} degrees are taken for all elevations, because nothing else is known \
             (`code_book.vertical_width_deg`)"
        ));
    }
    Ok(gains)
}

/// The error that the antenna in the file `path` has other sectors than the log.
pub(crate) fn other_sectors(path: &Path, why: &SettingError) -> RobotLogError {
    let problem = format!("the antenna has {}; allowed: the sectors of sectors.csv, {}", why.found(), why.allowed());
    RobotLogError::line(path, 1, problem)
}

/// Writes the antenna with these gains to the file `path`, unless it has no sectors.
pub(crate) fn write(path: &Path, gains: &SectorGains) -> Result<(), RobotLogError> {
    match antenna_text::write(gains) {
        Some(text) => write_whole(path, text.as_bytes()).map_err(|why| RobotLogError::write(path, why)),
        None => Ok(()),
    }
}

/// The line of the text that sets the last part of a key, as far as a search for it tells; else the first line.
fn line_of(text: &str, key: &str) -> usize {
    let last = key.rsplit('.').next().unwrap_or(key);
    let last = last.split('[').next().unwrap_or(last);
    text.lines().position(|line| line.contains(last)).map_or(1, |at| at + 1)
}
