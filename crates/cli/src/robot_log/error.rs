//! Errors of the CSV files of a robot.

use std::fmt;
use std::path::{Path, PathBuf};

use sextant_channel::LogError;
use sextant_kernel::SimTime;

use super::bag_error::BagError;
use super::instant;
use super::path::PathError;
use super::slot;
use super::sniffer_error::SnifferError;
use crate::diagnostic::Failure;
use crate::mcap_file::McapFileError;

/// Why the log of a robot cannot be read or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RobotLogError {
    /// A file cannot be read.
    #[error("cannot read `{}`: {why}", .path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// A file cannot be written.
    #[error("cannot write `{}`: {why}", .path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        why: String,
    },
    /// The header, or a row as a whole, is wrong.
    #[error("{}, line {line}: {problem}", .path.display())]
    Row {
        /// The file.
        path: PathBuf,
        /// Line of the file, from 1.
        line: usize,
        /// The error.
        problem: String,
    },
    /// A cell is wrong.
    #[error("{}, line {line}, column `{column}`: found `{found}`; allowed: {allowed}", .path.display())]
    Cell {
        /// The file.
        path: PathBuf,
        /// Line of the file, from 1.
        line: usize,
        /// Name of the column.
        column: &'static str,
        /// The text of the cell.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// The files do not form a valid reception log.
    #[error("`{}`: {why}", .path.display())]
    Log {
        /// The folder.
        path: PathBuf,
        /// The error.
        why: LogError,
    },
    /// A folder has packets and receptions.
    #[error(
        "`{}` has both packets.csv and {rival}: a log is packets.csv and path.csv, or stops.csv and receptions.csv; move \
         away those that are not meant",
        .path.display()
    )]
    TwoLogs {
        /// The folder.
        path: PathBuf,
        /// The file beside the packets.
        rival: &'static str,
    },
    /// A folder has a path and nothing that was heard.
    #[error("`{}` has path.csv, but no packets.csv with what was heard on it", .path.display())]
    NoPacketFile {
        /// The folder.
        path: PathBuf,
    },
    /// A folder has no log.
    #[error(
        "`{}` has no log: neither stops.csv and receptions.csv, nor path.csv and packets.csv", .path.display()
    )]
    NoLog {
        /// The folder.
        path: PathBuf,
    },
    /// A map is to be written as GeoJSON, but its places on the earth are unknown.
    #[error(
        "`{}`: GeoJSON has latitudes and longitudes, but the places of this map are metres in a plane of their own; name a \
         .csv file, or give the log its places by the columns `lat` and `lon`",
        .path.display()
    )]
    NotOnEarth {
        /// The file.
        path: PathBuf,
    },
    /// The packets do not form a valid reception log.
    #[error(transparent)]
    Invalid(LogError),
    /// The poses of a file are no path.
    #[error("`{}`: {why}", .path.display())]
    Path {
        /// The file.
        path: PathBuf,
        /// The error.
        why: PathError,
    },
    /// A path has too many stops.
    #[error("the path would be cut into more than {} stops: give a greater `--stop-every`", slot::MOST)]
    TooManyStops,
    /// There are no packets.
    #[error("the log has no packets")]
    NoPackets,
    /// A packet is wrong.
    #[error("the packet at {} s: {problem}", instant::format(*.time))]
    Packet {
        /// When it was heard.
        time: SimTime,
        /// The error.
        problem: String,
    },
    /// No packet was heard while the place of the robot is known.
    #[error(
        "none of the {count} packets was heard while the place of the robot is known: the packets are from {} s to {} s, \
         the path is from {} s to {} s; both need times of the same clock",
        instant::format(.packets.0), instant::format(.packets.1), instant::format(.path.0), instant::format(.path.1)
    )]
    NotCovered {
        /// Number of packets.
        count: u64,
        /// Times of the first and the last packet.
        packets: (SimTime, SimTime),
        /// Times of the first and the last pose.
        path: (SimTime, SimTime),
    },
    /// A file does not hold an area.
    #[error("`{}`: {why}", .path.display())]
    Area {
        /// The file.
        path: PathBuf,
        /// The error.
        why: String,
    },
    /// The log has no stops.
    #[error("`{}`: the log has no stops; at least one is required", .path.display())]
    NoStops {
        /// The folder.
        path: PathBuf,
    },
    /// A ROS bag cannot be read.
    #[error(transparent)]
    Bag(#[from] BagError),
    /// The capture of a sniffer cannot be read.
    #[error(transparent)]
    Sniffer(#[from] SnifferError),
    /// The file is of another format.
    #[error("`{}` is not the log of a robot: neither a folder of CSV files nor a ROS bag nor a capture", .path.display())]
    Unknown {
        /// The file.
        path: PathBuf,
    },
    /// Flags are for another kind of log.
    #[error("`{flag}` is for {meant}, but `{}` is {found}", .path.display())]
    Flag {
        /// The file or folder.
        path: PathBuf,
        /// The flag.
        flag: &'static str,
        /// What it is for.
        meant: &'static str,
        /// What the log is.
        found: &'static str,
    },
}

impl RobotLogError {
    /// Whether the disk or the system caused the error (exit code 1), not the input (exit code 2).
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        matches!(self, Self::Write { .. })
    }

    pub(super) fn read(path: &Path, why: impl fmt::Display) -> Self {
        Self::Read { path: path.to_owned(), why: why.to_string() }
    }

    pub(super) fn write(path: &Path, why: impl fmt::Display) -> Self {
        Self::Write { path: path.to_owned(), why: why.to_string() }
    }
}

impl From<McapFileError> for RobotLogError {
    fn from(error: McapFileError) -> Self {
        BagError::from(error).into()
    }
}

impl From<RobotLogError> for Failure {
    fn from(error: RobotLogError) -> Self {
        if error.is_system_error() { Self::failed(error.to_string()) } else { Self::bad_input(error.to_string()) }
    }
}
