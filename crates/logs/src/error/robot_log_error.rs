//! Errors of the log of a robot.

use std::fmt;
use std::path::{Path, PathBuf};
use std::time::Duration;

use sextant_channel::LogError;
use sextant_kernel::SimTime;
use sextant_kernel::text::choices;
use sextant_recording::capture::CaptureError;
use sextant_recording::mcap_file::McapFileError;

use super::bag_error::BagError;
use super::log_part::{LogPart, RowAddress};
use super::path_error::PathError;
use super::sniffer_error::SnifferError;
use crate::time::instant;

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
    #[error("{at}: {problem}")]
    Row {
        /// Where it is.
        at: RowAddress,
        /// The error.
        problem: String,
    },
    /// A cell is wrong.
    #[error("{at}, column `{column}`: found `{found}`; allowed: {allowed}")]
    Cell {
        /// Where it is.
        at: RowAddress,
        /// Name of the column.
        column: String,
        /// The text of the cell.
        found: String,
        /// What is allowed.
        allowed: String,
    },
    /// The work was ended from outside.
    #[error(transparent)]
    Interrupted(#[from] sextant_kernel::Interrupted),
    /// The files or tables do not form a valid reception log.
    #[error("`{part}`: {why}")]
    Log {
        /// The folder, or the table that says where the robot was.
        part: LogPart,
        /// The error.
        why: LogError,
    },
    /// A node sends so often that it cannot have sent all these packets at a stop.
    #[error(
        "node `{node}` would have sent {sent} packets at stop {stop} ({span} s), one every {interval} s; allowed: up to {most} at a \
         stop. Check the times of the packets and of the path, or give the interval with option `packet_interval`",
        span = instant::format_span(*.span), interval = interval.as_secs_f64()
    )]
    TooManySent {
        /// Name of the node.
        node: String,
        /// Index of the stop.
        stop: u32,
        /// How long the stop lasts.
        span: Duration,
        /// How often the node sends.
        interval: Duration,
        /// Packets.
        sent: u64,
        /// Most packets of a node at a stop.
        most: u32,
    },
    /// A folder has two logs, of which one is a list of stops.
    #[error(
        "`{}` has both {} and {stops}: a log is a path and packets, or stops.csv and receptions.csv; move away those that are \
         not meant, or give `packets=FILE`",
        .path.display(), .others.join(", ")
    )]
    TwoLogs {
        /// The folder.
        path: PathBuf,
        /// The paths and packets.
        others: Vec<String>,
        /// The file of a log with stops.
        stops: &'static str,
    },
    /// A folder has what is wanted more than once.
    #[error("`{}` has the {what} more than once: {}; choose with `{flag}=FILE`", .path.display(), .found.join(", "))]
    Several {
        /// The folder.
        path: PathBuf,
        /// What is wanted.
        what: &'static str,
        /// The files.
        found: Vec<String>,
        /// The flag that chooses.
        flag: &'static str,
    },
    /// A folder has several tables, of which none has a known name.
    #[error("`{}` has several tables: {}; give the one that is the log", .path.display(), .found.join(", "))]
    SeveralTables {
        /// The folder.
        path: PathBuf,
        /// The tables.
        found: Vec<String>,
    },
    /// There is a path and nothing that was heard.
    #[error(
        "`{}` has {found}, but no packets.csv with what was heard on it; `packets=FILE` takes the packets from another file",
        .path.display()
    )]
    NoPacketFile {
        /// The file or folder.
        path: PathBuf,
        /// What it has.
        found: String,
    },
    /// A table of ranges has none.
    #[error("{name}: {problem}")]
    NoRanges {
        /// The table.
        name: String,
        /// What it has.
        problem: String,
    },
    /// There are packets and no path.
    #[error(
        "`{}` says which nodes were heard and when, but not where the robot was: give its path with `path=FILE`: CSV with columns \
         t_s,x_m,y_m[,z_m] or t_s,lat,lon, TUM, GPX, NMEA 0183 or a ROS 2 bag",
        .path.display()
    )]
    NoPath {
        /// The file or folder.
        path: PathBuf,
    },
    /// Flags name everything that would be read from the log.
    #[error("`{}` gives {what}, but so does option `{flag}`: leave out one of them", .path.display())]
    Unused {
        /// The file.
        path: PathBuf,
        /// What it gives.
        what: &'static str,
        /// The flag that replaces it.
        flag: &'static str,
    },
    /// A folder has no log.
    #[error(
        "`{}` has no log: neither stops.csv and receptions.csv, nor path.csv and packets.csv, nor a table with a column a node, a \
         ROS 2 bag or a capture; its other files: {}", .path.display(), choices(.found)
    )]
    NoLog {
        /// The folder.
        path: PathBuf,
        /// The names of the files that it has.
        found: Vec<String>,
    },
    /// A map is to be written as GeoJSON, but its places on the earth are unknown.
    #[error(
        "`{}`: GeoJSON has latitudes and longitudes, but the places of this map are metres in a local plane; name a \
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
    /// The poses of a file or a table are no path.
    #[error("`{part}`: {why}")]
    Path {
        /// The file or the table.
        part: LogPart,
        /// The error.
        why: PathError,
    },
    /// A path has too many stops.
    #[error("the path would be cut into more than {} stops: give a greater option `stop_every`", Self::MOST_STOPS)]
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
         the path is from {} s to {} s; both need times of the same clock{}",
        instant::format(.packets.0), instant::format(.packets.1), instant::format(.path.0), instant::format(.path.1),
        taken_off(*.delay_s)
    )]
    NotCovered {
        /// Number of packets.
        count: u64,
        /// Times of the first and the last packet.
        packets: (SimTime, SimTime),
        /// Times of the first and the last pose.
        path: (SimTime, SimTime),
        /// What was taken off the times of the packets (s).
        delay_s: f64,
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
    #[error("`{part}`: the log has no stops; at least one is required")]
    NoStops {
        /// The folder, or the table of stops.
        part: LogPart,
    },
    /// A ROS bag cannot be read.
    #[error(transparent)]
    Bag(#[from] BagError),
    /// The capture of a sniffer cannot be read.
    #[error(transparent)]
    Sniffer(#[from] SnifferError),
    /// The file is of a form that is known, and that is not read.
    #[error("`{}` is {told}", .path.display())]
    Foreign {
        /// The file.
        path: PathBuf,
        /// What it is, and what helps.
        told: String,
    },
    /// Nothing is known of the file.
    #[error(
        "`{}` is neither the log of a robot nor a recording of `run`, but {seen}; logs are folders of CSV files, tables (.csv, \
         .tsv, .txt), ROS 2 bags, captures (pcap, pcapng), and paths in GPX, NMEA 0183 or TUM", .path.display()
    )]
    Unknown {
        /// The file.
        path: PathBuf,
        /// How it begins.
        seen: String,
    },
    /// The log is not of the form that flags say.
    #[error("{problem}")]
    Form {
        /// The error.
        problem: String,
    },
    /// Flags are for another kind of log.
    #[error("option `{flag}` is for {meant}, but `{part}` is {found}")]
    Unsuited {
        /// The file or folder, or the table that says where the robot was.
        part: LogPart,
        /// The flag.
        flag: &'static str,
        /// What it is for.
        meant: &'static str,
        /// What the log is.
        found: String,
    },
}

impl From<CaptureError> for RobotLogError {
    fn from(why: CaptureError) -> Self {
        Self::Sniffer(why.into())
    }
}

impl RobotLogError {
    /// Most stops of a path.
    pub(crate) const MOST_STOPS: usize = 1_000_000;

    /// Whether the disk or the system caused the error (exit code 1), not the input (exit code 2).
    #[must_use]
    pub fn is_system_error(&self) -> bool {
        matches!(self, Self::Write { .. })
    }

    /// The line or the row that is wrong, if it is one.
    #[must_use]
    pub fn row_address(&self) -> Option<&RowAddress> {
        match self {
            Self::Row { at, .. } | Self::Cell { at, .. } => Some(at),
            _ => None,
        }
    }

    /// The error that a line of a file (from 1) is wrong.
    pub(crate) fn line(path: &Path, line: usize, problem: impl Into<String>) -> Self {
        Self::Row { at: RowAddress::File { path: path.to_owned(), line }, problem: problem.into() }
    }

    pub(crate) fn read(path: &Path, why: impl fmt::Display) -> Self {
        Self::Read { path: path.to_owned(), why: why.to_string() }
    }

    pub(crate) fn write(path: &Path, why: impl fmt::Display) -> Self {
        Self::Write { path: path.to_owned(), why: why.to_string() }
    }
}

impl From<McapFileError> for RobotLogError {
    fn from(error: McapFileError) -> Self {
        BagError::from(error).into()
    }
}

/// What was taken off the times of packets (s), for an error; nothing if nothing was.
fn taken_off(delay_s: f64) -> String {
    if delay_s.abs() > 0.0 {
        format!("; option `packet_delay` takes {delay_s} s off the times of the packets")
    } else {
        String::new()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packets_beyond_the_path_tell_what_was_taken_off_their_times() {
        let of = |delay_s| {
            let span = (SimTime::ZERO, SimTime::ZERO);
            RobotLogError::NotCovered { count: 3, packets: span, path: span, delay_s }.to_string()
        };
        assert!(of(0.0).ends_with("both need times of the same clock"), "{}", of(0.0));
        assert!(of(1000.0).ends_with("; option `packet_delay` takes 1000 s off the times of the packets"));
    }
}
