//! The kinds of logs of robots: folders of CSV files, ROS bags, captures of sniffers.

use std::path::{Path as FilePath, PathBuf};

use super::doctor;
use super::error::RobotLogError;
use super::folder;
use super::local_plane::LocalPlane;
use super::log::RobotLog;
use super::options::ReadOptions;
use super::packet_delay::PacketDelay;
use super::path::Path;
use super::repair_options::RepairOptions;
use super::sniffer_error::SnifferError;
use super::{bag, path_file, sniffer};

/// The kinds of logs of robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A folder of CSV files.
    Tables,
    /// A ROS bag: a file or a folder.
    Bag,
    /// A capture, or a folder of captures and the path of the robot.
    Captures,
}

impl Source {
    /// What the file or folder `path` is, by its content; `None` if it is not the log of a robot.
    #[must_use]
    pub fn of(path: &FilePath) -> Option<Self> {
        let tables = [folder::STOPS, folder::RECEPTIONS, folder::PACKETS];
        if path.is_dir() && tables.iter().any(|name| path.join(name).exists()) {
            return Some(Self::Tables);
        }
        if bag::is_bag(path) {
            return Some(Self::Bag);
        }
        let has_captures = || path.is_dir() && captures(path).is_ok_and(|captures| !captures.is_empty());
        if sniffer::is_capture(path) || has_captures() {
            return Some(Self::Captures);
        }
        path.is_dir().then_some(Self::Tables)
    }
}

/// Refuses the flags of `options` that are for another kind of log than `source`; `None` is a recording of `run`.
///
/// # Errors
/// If there is such a flag.
pub fn refuse_flags(path: &FilePath, source: Option<Source>, options: &ReadOptions) -> Result<(), RobotLogError> {
    let found = match source {
        None => "a recording of `run`",
        Some(Source::Tables) => "a folder of CSV files",
        Some(Source::Bag) => "a ROS bag",
        Some(Source::Captures) => "a capture of a sniffer",
    };
    let of_bags = if source == Some(Source::Bag) { Vec::new() } else { options.bag.given() };
    let of_captures = if source == Some(Source::Captures) { Vec::new() } else { options.sniffer.given() };
    let refused = |flag: Option<&&'static str>, meant| match flag {
        Some(flag) => Err(RobotLogError::Flag { path: path.to_owned(), flag, meant, found }),
        None => Ok(()),
    };
    if source.is_none() {
        folder::refuse_cutting(path, found, options)?;
        let of_robots = [
            ("--skip-no-fix", options.repair.skip_no_fix),
            ("--rssi-missing", !options.repair.rssi_missing.is_empty()),
        ];
        let given = of_robots.iter().find(|(_, is_given)| *is_given);
        refused(given.map(|(flag, _)| flag), "logs of robots")?;
    }
    refused(of_bags.first(), "ROS bags")?;
    refused(of_captures.first(), "captures of sniffers")
}

/// Reads the log of a robot: a folder of CSV files, a ROS bag, or captures of a sniffer; and looks for what is odd in it. To
/// estimate the delay of the packets, it is read twice.
///
/// # Errors
/// If it cannot be read, or `options` are for another kind of log.
pub fn read(path: &FilePath, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let mut read = read_once(path, options)?;
    if options.repair.packet_delay == PacketDelay::Estimated {
        if let Some(clock) = read.clock.filter(|clock| clock.told_s().is_some()) {
            let known = PacketDelay::Seconds(clock.delay_s);
            read = read_once(
                path,
                &ReadOptions {
                    repair: RepairOptions { packet_delay: known, ..options.repair.clone() },
                    ..options.clone()
                },
            )?;
            read.notes.push(format!(
                "the times of the packets are estimated to be {:.2} ± {:.2} s late by the clock of the path, and are \
                 corrected by that (`--packet-delay auto`)",
                clock.delay_s,
                2.0 * clock.error_s
            ));
        } else {
            read.notes.push(
                "no delay of the packets is clear, so their times are used as they are (`--packet-delay auto`)"
                    .to_owned(),
            );
        }
    }
    let found = doctor::of_log(&read.log, &read.findings);
    read.findings.extend(found);
    read.findings = doctor::told_apart(read.findings);
    Ok(read)
}

/// Reads the log of a robot.
fn read_once(path: &FilePath, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    let source = Source::of(path).ok_or_else(|| RobotLogError::Unknown { path: path.to_owned() })?;
    refuse_flags(path, Some(source), options)?;
    match source {
        Source::Tables => folder::read(path, options),
        Source::Bag => bag::read(path, options),
        Source::Captures => {
            let captures = captures(path)?;
            let beside = Some(path.join(folder::PATH)).filter(|beside| beside.exists());
            let robot = options.sniffer.path.clone().or(beside);
            let robot = robot.ok_or_else(|| SnifferError::NoPath { path: path.to_owned() })?;
            let mut notes = Vec::new();
            let (robot, plane) = read_path(&robot, options.repair.skip_no_fix, &mut notes)?;
            let log = sniffer::read(&captures, robot, options)?;
            notes.extend(log.notes);
            Ok(RobotLog { plane, notes, ..log })
        }
    }
}

/// The capture `path`, or the captures in the folder `path` by name.
fn captures(path: &FilePath) -> Result<Vec<PathBuf>, RobotLogError> {
    if !path.is_dir() {
        return Ok(vec![path.to_owned()]);
    }
    let entries = std::fs::read_dir(path).and_then(|entries| entries.collect::<Result<Vec<_>, _>>());
    let entries = entries.map_err(|why| RobotLogError::read(path, why))?;
    let mut found: Vec<_> =
        entries.iter().map(std::fs::DirEntry::path).filter(|path| sniffer::is_capture(path)).collect();
    found.sort();
    Ok(found)
}

/// Reads the path of the robot that heard a capture.
fn read_path(
    path: &FilePath,
    skips_no_fix: bool,
    notes: &mut Vec<String>,
) -> Result<(Path, Option<LocalPlane>), RobotLogError> {
    let path_file::Paths { paths, plane, .. } = path_file::read(path, skips_no_fix, notes)?;
    let robots = paths.len();
    let problem = format!("found the paths of {robots} robots; allowed: that of the one that heard the capture");
    let [robot] =
        <[Path; 1]>::try_from(paths).map_err(|_| RobotLogError::Row { path: path.to_owned(), line: 1, problem })?;
    Ok((robot, plane))
}
