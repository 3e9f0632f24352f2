//! The kinds of logs of robots: CSV files, ROS bags, captures of sniffers.

use std::path::Path as FilePath;

use sextant_kernel::text::shortened;
use sextant_kernel::{FileForm, seen};
use sextant_recording::admission::OutputKind;
use sextant_recording::mcap_file::is_mcap;

use super::companions::Companions;
use super::drive;
use super::file_names::INCOMPLETE;
use super::form::{self, Form};
use super::layout::Layout;
use super::memory_log::MemoryLog;
use super::recognition;
use super::stop_log::{self, StopLog};
use crate::bag;
use crate::doctor::{self, PlacedBy};
use crate::error::robot_log_error::RobotLogError;
use crate::options::packet_delay::PacketDelay;
use crate::options::read_options::ReadOptions;
use crate::options::repair_options::RepairOptions;
use crate::options::robot_frames::RobotFrames;
use crate::options::sniffer_options::SnifferOptions;
use crate::packets::reciprocal;
use crate::robot_log::RobotLog;
use crate::sniffer;
use crate::sniffer::CaptureContents;

/// The kinds of logs of robots.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Source {
    /// A folder of files, or a table or a path alone.
    Tables,
    /// A ROS bag: a file or a folder.
    Bag,
    /// A capture.
    Captures,
}

impl Source {
    /// What the file or folder `path` is, by its content; `None` if it is not the log of a robot.
    #[must_use]
    pub fn of(path: &FilePath) -> Option<Self> {
        if bag::is_bag(path) {
            return Some(Self::Bag);
        }
        if sniffer::is_capture(path) {
            return Some(Self::Captures);
        }
        (path.is_dir() || recognition::is_part(path)).then_some(Self::Tables)
    }
}

/// Refuses a file that is neither the log of a robot nor in MCAP, as recordings of `run` are, and says what it is; and what
/// `options` say for a recording: they are for logs of robots.
///
/// # Errors
/// If the file is another one, or there is such an option.
pub fn refuse_options(path: &FilePath, options: &ReadOptions) -> Result<(), RobotLogError> {
    std::fs::metadata(path).map_err(|why| RobotLogError::read(path, why))?;
    if !is_mcap(path) {
        return Err(unknown(path));
    }
    let is_ours = OutputKind::Recording.is_ours(path).unwrap_or(false);
    form::refuse(&path.into(), if is_ours { Form::Recording } else { Form::Mcap }, options)
}

/// The error that a file is no log.
fn unknown(path: &FilePath) -> RobotLogError {
    let path = path.to_owned();
    match FileForm::of_file(&path) {
        Some(form) => RobotLogError::Foreign { told: form.told(&path), path },
        None => RobotLogError::Unknown { seen: seen(&path), path },
    }
}

/// Reads the log of a robot: a folder of CSV files, a ROS bag, captures of a sniffer, or parts of these; and looks for what is
/// odd in it. To estimate the delay of the packets, it is read twice.
///
/// # Errors
/// If it cannot be read, a part is missing or there more than once, or `options` are for another form of log.
pub fn read(path: &FilePath, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    Ok(examine(read_with(options, |options| read_once(path, options))?, options.frames))
}

/// Reads the log of a robot that is in memory, as [`read`] reads files.
///
/// ```
/// use sextant_logs::{MemoryColumn, MemoryLog, MemoryTable, ReadOptions};
///
/// let column = |name: &str, column: MemoryColumn<'static>| (name.to_owned(), column);
/// let stops = vec![
///     column("stop", MemoryColumn::whole(vec![0, 1])),
///     column("x_m", MemoryColumn::floats(vec![0.0, 1.5])),
///     column("y_m", MemoryColumn::floats(vec![0.0, 0.0])),
/// ];
/// let receptions = vec![
///     column("node", MemoryColumn::texts([Some("lamp"), Some("door")])),
///     column("stop", MemoryColumn::whole(vec![1, 0])),
///     column("received", MemoryColumn::whole(vec![3, 0])),
///     column("sent", MemoryColumn::whole(vec![5, 5])),
/// ];
/// let stops = MemoryTable::new("stops", stops)?;
/// let receptions = MemoryTable::new("receptions", receptions)?;
/// let log = sextant_logs::read_tables(&MemoryLog::new(stops, receptions), &ReadOptions::default())?.log;
/// assert_eq!(log.names(), ["lamp", "door"]);
/// # Ok::<(), sextant_logs::RobotLogError>(())
/// ```
///
/// # Errors
/// If a table has an invalid row, or `options` are for another form of log; the error names table, row and column.
pub fn read_tables(tables: &MemoryLog<'_>, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    Ok(examine(gather_tables(tables, options)?, options.frames))
}

/// As [`read_tables`], but what is odd in the log as a whole is not looked for, which takes longer than the rest:
/// [`examine`] does that.
///
/// # Errors
/// As for [`read_tables`].
pub fn gather_tables(tables: &MemoryLog<'_>, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    read_with(options, |options| Ok(noted(tables.read(options)?, options)))
}

/// Looks for what is odd in a log as a whole, whose robots have these `frames`, and adds it to the findings.
#[must_use]
pub fn examine(mut read: RobotLog, frames: RobotFrames) -> RobotLog {
    let placed_by = PlacedBy::of_middles(&read.middles);
    let found = match frames {
        RobotFrames::Shared => doctor::of_log(&read.log, &read.findings, placed_by),
        RobotFrames::OfEachRobot => doctor::of_robots(&read.log, &read.findings, placed_by),
    };
    read.findings.extend(found);
    read.findings = doctor::told_apart(read.findings);
    read
}

/// What the capture of a sniffer has, whatever of it can be mapped.
///
/// # Errors
/// If it cannot be read, or is damaged.
pub fn inspect_capture(path: &FilePath, options: &SnifferOptions) -> Result<CaptureContents, RobotLogError> {
    Ok(sniffer::contents(path, options)?)
}

/// Reads a log by `read_once`, twice to estimate the delay of the packets.
fn read_with(
    options: &ReadOptions,
    read_once: impl Fn(&ReadOptions) -> Result<RobotLog, RobotLogError>,
) -> Result<RobotLog, RobotLogError> {
    let mut read = read_once(options)?;
    if options.repair.packet_delay == PacketDelay::Estimated {
        if let Some(clock) = read.clock.filter(|clock| clock.told_s().is_some()) {
            let known = PacketDelay::Seconds(clock.delay_s);
            read = read_once(&ReadOptions {
                repair: RepairOptions { packet_delay: known, ..options.repair.clone() },
                ..options.clone()
            })?;
            read.notes.push(format!(
                "the times of the packets are estimated to be {:.2} ± {:.2} s late by the clock of the path, and are \
                 corrected by that (`packet_delay=auto`)",
                clock.delay_s,
                2.0 * clock.error_s
            ));
        } else {
            let of_ranges =
                if read.log.ranges().is_empty() { "" } else { "; a map by ranges estimates how late these are" };
            read.notes.push(format!(
                "no delay of the packets is clear, so their times are used as they are (`packet_delay=auto`){of_ranges}"
            ));
        }
    }
    Ok(read)
}

/// Reads the log of a robot.
fn read_once(path: &FilePath, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    if Source::of(path).is_none() {
        return Err(match std::fs::metadata(path) {
            Err(why) => RobotLogError::read(path, why),
            Ok(_) => unknown(path),
        });
    }
    let layout = Layout::of(path, &options.form)?;
    form::refuse(&path.into(), layout.form(), options)?;
    let log = match &layout {
        Layout::Stops(folder) => stop_log::read(StopLog::of_folder(folder, &options.form), options),
        Layout::Wide { table, folder } => {
            let companions = match folder {
                Some(folder) => Companions::of_folder(folder, options.form.time_zone),
                None => Companions::none(table.as_path().into()),
            };
            stop_log::read_wide(table.as_path().into(), &companions, options)
        }
        Layout::StopFiles { folder, files, content } => stop_log::read_stop_files(folder, files, *content, options),
        Layout::Drive(parts) => drive::read(parts, options),
    }?;
    Ok(incomplete(noted(log, options), path))
}

/// The log with what is missing in it, if its folder says so.
fn incomplete(mut log: RobotLog, path: &FilePath) -> RobotLog {
    if let Ok(text) = std::fs::read_to_string(path.join(INCOMPLETE)) {
        log.notes.insert(0, format!("{INCOMPLETE}: {}", shortened(text.trim())));
    }
    log
}

/// The log with what the user should know of the options.
fn noted(mut log: RobotLog, options: &ReadOptions) -> RobotLog {
    if options.form.reciprocal {
        log.notes.insert(0, reciprocal::NOTE.to_owned());
    }
    log
}
