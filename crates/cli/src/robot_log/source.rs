//! The kinds of logs of robots: CSV files, ROS bags, captures of sniffers.

use std::path::Path as FilePath;

use super::error::RobotLogError;
use super::form::{self, Form};
use super::layout::{self, Layout};
use super::log::RobotLog;
use super::options::ReadOptions;
use super::{bag, drive, folder, reciprocal, sniffer};

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
        (path.is_dir() || layout::is_part(path)).then_some(Self::Tables)
    }
}

/// Refuses the flags of `options` for a recording of `run`: they are for logs of robots.
///
/// # Errors
/// If there is such a flag.
pub fn refuse_flags(path: &FilePath, options: &ReadOptions) -> Result<(), RobotLogError> {
    form::refuse(path, Form::Recording, options)
}

/// Reads the log of a robot: a folder of CSV files, a ROS bag, captures of a sniffer, or parts of these.
///
/// # Errors
/// If it cannot be read, a part is missing or there more than once, or `options` are for another form of log.
pub fn read(path: &FilePath, options: &ReadOptions) -> Result<RobotLog, RobotLogError> {
    if Source::of(path).is_none() {
        return Err(match std::fs::metadata(path) {
            Err(why) => RobotLogError::read(path, why),
            Ok(_) => RobotLogError::Unknown { path: path.to_owned() },
        });
    }
    let layout = Layout::of(path, &options.form)?;
    form::refuse(path, layout.form(), options)?;
    let mut log = match &layout {
        Layout::Stops(folder) => folder::read(folder, &options.form),
        Layout::Wide { table, folder } => folder::read_wide(table, folder.as_deref(), &options.form),
        Layout::Drive(parts) => drive::read(parts, options),
    }?;
    if options.form.reciprocal {
        log.notes.insert(0, reciprocal::NOTE.to_owned());
    }
    Ok(log)
}
