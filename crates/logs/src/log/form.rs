//! The forms of logs, and the flags that each has.

use std::fmt;

use crate::error::log_part::LogPart;
use crate::error::robot_log_error::RobotLogError;
use crate::options::packet_delay::PacketDelay;
use crate::options::read_options::{ReadOptions, StopRule};

/// What gives the path of a robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PathKind {
    Csv,
    Tum,
    Gpx,
    Nmea,
    Bag,
}

/// What gives the packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum PacketKind {
    Csv,
    Captures,
    Bag,
    /// There are none, but ranges that were measured.
    Ranges,
}

/// The form of a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Form {
    /// A recording of `run`.
    Recording,
    /// An MCAP file of another program, which is no ROS bag.
    Mcap,
    /// A folder with a file a stop.
    StopFiles,
    /// Stops and receptions.
    Stops,
    /// A row a stop, a column a node.
    Wide,
    /// A path and packets.
    Drive(PathKind, PacketKind),
    /// What was measured between tags and receivers at known places.
    Tags,
}

impl Form {
    /// What a log of this form is, of which `part` is known.
    fn found(self, part: &LogPart) -> String {
        match (part, self) {
            (LogPart::Table(_), Self::Stops) => "a table of stops in memory".to_owned(),
            (LogPart::Table(_), Self::Drive(..)) => "a path in memory".to_owned(),
            (_, form) => form.to_string(),
        }
    }
}

impl fmt::Display for Form {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (path, packets) = match self {
            Self::Recording => return f.write_str("a recording of `run`"),
            Self::Mcap => return f.write_str("an MCAP file that is no ROS bag"),
            Self::StopFiles => return f.write_str("a folder with a file a stop"),
            Self::Stops => return f.write_str("a folder with stops"),
            Self::Wide => return f.write_str("a table with a column a node"),
            Self::Tags => return f.write_str("a log of tags"),
            Self::Drive(PathKind::Bag, PacketKind::Bag) => return f.write_str("a ROS bag"),
            Self::Drive(path, packets) => (path, packets),
        };
        let path = match path {
            PathKind::Csv => "a CSV file",
            PathKind::Tum => "a TUM file",
            PathKind::Gpx => "a GPX file",
            PathKind::Nmea => "an NMEA file",
            PathKind::Bag => "a ROS bag",
        };
        let packets = match packets {
            PacketKind::Csv => "a CSV file",
            PacketKind::Captures => "the capture of a sniffer",
            PacketKind::Bag => "a ROS bag",
            PacketKind::Ranges => return write!(f, "a log with its path from {path} and ranges"),
        };
        write!(f, "a log with its path from {path} and its packets from {packets}")
    }
}

/// What flags are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Use {
    RobotLog,
    Drive,
    Parts,
    Wide,
    BagPath,
    BagPackets,
    Bag,
    Captures,
    CsvPlaces,
    CsvTimes,
    Folder,
    PacketFields,
    Lora,
    Ranges,
}

impl Use {
    fn is_for(self, form: Form) -> bool {
        match (self, form) {
            (Self::RobotLog, form) => !matches!(form, Form::Recording | Form::Mcap),
            (Self::Parts | Self::Ranges | Self::CsvTimes | Self::CsvPlaces, Form::Tags) => true,
            (Self::PacketFields | Self::Lora, Form::Tags) => true,
            (Self::Drive | Self::Parts, Form::Drive(..)) | (Self::Wide, Form::Wide | Form::StopFiles) => true,
            (Self::BagPath, Form::Drive(path, _)) => path == PathKind::Bag,
            (Self::BagPackets, Form::Drive(_, packets)) => packets == PacketKind::Bag,
            (Self::Bag, Form::Drive(path, packets)) => path == PathKind::Bag || packets == PacketKind::Bag,
            (Self::Captures, Form::Drive(_, packets)) => packets == PacketKind::Captures,
            (Self::CsvPlaces | Self::CsvTimes, Form::Stops | Form::Wide | Form::StopFiles) => true,
            (Self::CsvTimes, Form::Drive(path, packets)) => {
                path == PathKind::Csv || matches!(packets, PacketKind::Csv | PacketKind::Ranges)
            }
            (Self::Folder, Form::StopFiles) => true,
            (Self::CsvPlaces, Form::Drive(path, _)) => path == PathKind::Csv,
            (Self::Ranges, Form::Stops | Form::Drive(..)) => true,
            (Self::PacketFields | Self::Lora, Form::Stops | Form::StopFiles) => true,
            (Self::PacketFields | Self::Lora, Form::Drive(_, packets)) => {
                !matches!(packets, PacketKind::Captures | PacketKind::Ranges)
            }
            _ => false,
        }
    }

    const fn meant(self) -> &'static str {
        match self {
            Self::RobotLog => "logs of robots",
            Self::Drive | Self::Parts => "logs of packets and a path",
            Self::Wide => "tables with a row a stop and a column a node",
            Self::BagPath | Self::BagPackets | Self::Bag => "ROS bags",
            Self::Captures => "captures of sniffers",
            Self::CsvPlaces => "paths and stops in CSV files",
            Self::CsvTimes => "times in CSV files",
            Self::Folder => "folders with a file a stop",
            Self::PacketFields => "packets in CSV files and ROS bags",
            Self::Ranges => "ranges beside stops or a path, and in ROS bags",
            Self::Lora => "packets with RSSI and SNR, in CSV files and ROS bags",
        }
    }
}

/// Refuses what `options` say that are for another form of log.
pub(crate) fn refuse(part: &LogPart, form: Form, options: &ReadOptions) -> Result<(), RobotLogError> {
    // Robots may have frames of their own in every form.
    let ReadOptions { stop_every, packet_interval_s, form: of_form, repair, bag, sniffer, frames: _ } = options;
    let flags = [
        ("stop_every", *stop_every != StopRule::Automatic, Use::Drive),
        ("packet_interval", packet_interval_s.is_some(), Use::Drive),
        ("packet_delay", repair.packet_delay != PacketDelay::default(), Use::Drive),
        ("skip_no_fix", repair.skip_no_fix, Use::RobotLog),
        ("rssi_missing", !repair.rssi_missing.is_empty(), Use::RobotLog),
        ("path", of_form.path.is_some(), Use::Parts),
        ("packets", of_form.packets.is_some(), Use::Parts),
        ("pose_topic", bag.pose_topic.is_some(), Use::BagPath),
        ("child_frame", bag.child_frame.is_some(), Use::BagPath),
        ("fixed_frame", bag.fixed_frame.is_some(), Use::BagPath),
        ("packet_topic", bag.packet_topic.is_some(), Use::BagPackets),
        ("range_topic", bag.range_topic.is_some(), Use::BagPackets),
        ("bag_clock", bag.bag_clock.is_some(), Use::Bag),
        ("pan", sniffer.pan.is_some(), Use::Captures),
        ("fcs", sniffer.fcs.is_some(), Use::Captures),
        ("packet_fields", of_form.packet_fields.is_some(), Use::PacketFields),
        ("stop_files", of_form.stop_files.is_some(), Use::Folder),
        ("time_zone", of_form.time_zone.is_some(), Use::CsvTimes),
        ("path_fields", of_form.path_fields.is_some(), Use::CsvPlaces),
        ("missing", !of_form.missing.is_empty(), Use::Wide),
        ("node_columns", !of_form.node_columns.is_empty(), Use::Wide),
        ("reciprocal", of_form.reciprocal, Use::RobotLog),
        ("transmitter", of_form.transmitter.is_some(), Use::Parts),
        ("noise_floor", of_form.noise_floor.is_some(), Use::RobotLog),
        ("lora", of_form.lora, Use::Lora),
        ("range_fields", of_form.range_fields.is_some(), Use::Ranges),
    ];
    match flags.into_iter().find(|(_, is_given, meant)| *is_given && !meant.is_for(form)) {
        Some((flag, _, meant)) => {
            Err(RobotLogError::Unsuited { part: part.clone(), flag, meant: meant.meant(), found: form.found(part) })
        }
        None => Ok(()),
    }
}
