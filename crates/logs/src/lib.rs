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

mod antenna_file;
mod area;
mod bag;
mod bag_error;
mod bag_options;
mod blanks;
mod cell;
mod companions;
mod cover;
mod csv_file;
pub mod doctor;
mod drive;
mod error;
mod field_names;
mod field_path;
mod file_names;
mod file_template;
mod fix;
mod folder;
mod form;
mod form_options;
mod gathered;
mod gatherer;
mod geojson;
mod gpx;
mod header;
mod heading;
mod heard;
mod instant;
mod interval;
mod layout;
mod lines;
mod local_plane;
mod log;
mod log_part;
mod lookup;
mod map;
mod memory_log;
mod memory_table;
mod missing;
mod names;
mod nmea;
mod noise_floor;
mod options;
mod output;
mod packet;
mod packet_delay;
mod packets;
mod pair_notes;
mod pairs;
mod part_name;
mod path;
mod path_file;
mod paths;
mod place;
mod receptions;
mod reciprocal;
mod recognition;
mod repair_options;
mod row_log;
mod rssi_check;
mod sector_snrs;
mod sectors;
mod sending;
mod signal;
mod slot;
mod sniffer;
mod sniffer_error;
mod sniffer_options;
mod source;
mod stated;
mod stop_files;
mod stops;
mod strengths;
mod table;
mod table_file;
mod table_head;
mod table_source;
mod time_zone;
mod times;
mod truth;
mod tum;
mod wide;
mod writing;
mod written;

pub use area::read_area;
pub use bag_error::BagError;
pub use bag_options::{BagClock, BagOptions};
pub use error::RobotLogError;
pub use field_names::FieldNames;
pub use file_template::FileTemplate;
pub use form_options::FormOptions;
pub use gatherer::Gatherer;
pub use local_plane::{Geodetic, LocalPlane};
pub use log::RobotLog;
pub use log_part::{LogPart, RowAddress};
pub use map::{COVARIANCE, read_map, write_map};
pub use memory_log::MemoryLog;
pub use memory_table::{MemoryColumn, MemoryTable};
pub use missing::{ColumnPattern, Missing};
pub use names::Names;
pub use noise_floor::NoiseFloor;
pub use options::{ReadOptions, StopRule};
pub use packet::Packet;
pub use packet_delay::PacketDelay;
pub use part_name::is_part_of_log;
pub use path::{Path, PathError, Pose};
pub use repair_options::RepairOptions;
pub use row_log::{RowLog, TakeRow};
pub use sniffer::{CaptureContents, CapturedLink, CapturedSender};
pub use sniffer_error::SnifferError;
pub use sniffer_options::{FcsField, SnifferOptions};
pub use source::{Source, examine, gather_tables, inspect_capture, read, read_tables, refuse_options};
pub use time_zone::TimeZone;
pub use truth::{TrueNodes, read_truth, read_truth_table};
pub use writing::write;
