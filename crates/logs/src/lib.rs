//! Logs of real robots, and maps of them as files.
//!
//! Input: a folder with `stops.csv` and `receptions.csv`, or with `path.csv` and `packets.csv`; a table with a column a node; a
//! ROS 2 bag; captures of a sniffer and a path; or a path and packets of any two of these; or the same tables in memory
//! ([`read_tables`]). Output: the reception log for a mapper, the plane of its places if they are given by latitude and
//! longitude, and notes; or an error with file, line and column. The formats are described in `docs/robot-logs.md`.
//!
//! ```
//! use sextant_logs::ReadOptions;
//!
//! let folder = std::env::temp_dir().join(format!("sextant-log-{}", std::process::id()));
//! std::fs::create_dir_all(&folder)?;
//! std::fs::write(folder.join("stops.csv"), "stop,t_s,x_m,y_m\nA,0,0,0\nB,1.5,1,0\n")?;
//! std::fs::write(folder.join("receptions.csv"), "node,stop,received,sent\nlamp,B,3,5\ndoor,A,0,5\n")?;
//! let log = sextant_logs::read(&folder, &ReadOptions::default())?.log;
//! assert_eq!(log.names(), ["lamp", "door"]);
//! assert_eq!(log.stops().len(), 2);
//! # std::fs::remove_dir_all(&folder)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![cfg_attr(test, allow(clippy::disallowed_methods, reason = "oracles may be those of the C library"))]

mod bag;
mod csv;
pub mod doctor;
mod error;
mod log;
mod median;
mod options;
mod packets;
mod path;
mod place;
mod ranges;
mod robot_log;
mod sniffer;
mod stops;
#[cfg(test)]
mod test_kit;
mod time;

pub use crate::csv::memory_table::{MemoryColumn, MemoryTable};
pub use error::bag_error::BagError;
pub use error::log_part::{LogPart, RowAddress};
pub use error::path_error::PathError;
pub use error::robot_log_error::RobotLogError;
pub use error::sniffer_error::SnifferError;
pub use log::file_names::INCOMPLETE;
pub use log::memory_log::MemoryLog;
pub use log::names::Names;
pub use log::part_name::is_part_of_log;
pub use log::row_log::{RowLog, TakeRow, UNUSED_RANGES};
pub use log::source::{Source, examine, gather_tables, inspect_capture, read, read_tables, refuse_options};
pub use log::tags::readings::{
    TagReadings, TagTables, has_tag_readings, read_tag_readings, read_tag_tables, read_true_path,
    read_true_path_table,
};
pub use log::writing::write;
pub use options::bag_options::{BagClock, BagOptions};
pub use options::field_names::FieldNames;
pub use options::file_template::FileTemplate;
pub use options::form_options::FormOptions;
pub use options::missing::{ColumnPattern, Missing};
pub use options::noise_floor::NoiseFloor;
pub use options::packet_delay::PacketDelay;
pub use options::read_options::{ReadOptions, StopRule};
pub use options::repair_options::RepairOptions;
pub use options::robot_frames::RobotFrames;
pub use options::sniffer_options::{FcsField, SnifferOptions};
pub use packets::gatherer::Gatherer;
pub use packets::packet::Packet;
pub use path::estimated::{write_path, write_tracks};
pub use path::robot_path::{Path, Pose};
pub use place::area::read_area;
pub use place::local_plane::{Geodetic, LocalPlane};
pub use place::map::{COVARIANCE, read_map, write_map};
pub use place::truth::{TrueNodes, read_truth, read_truth_table};
pub use robot_log::RobotLog;
pub use sniffer::{CaptureContents, CapturedLink, CapturedSender};
pub use time::time_zone::TimeZone;
