//! What the user says of the form of a log.

use std::path::PathBuf;

use super::field_names::FieldNames;
use super::file_template::FileTemplate;
use super::missing::{ColumnPattern, Missing};
use super::noise_floor::NoiseFloor;
use crate::time::time_zone::TimeZone;

/// Where the parts of a log are, and how they are written.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FormOptions {
    /// Take the path of the robot from this file, with times of the clock of the packets: CSV (t_s,x_m,y_m or x_m,y_m,z_m or
    /// t_s,lat,lon), TUM (time x y z and a quaternion a line), GPX, NMEA 0183, or a ROS 2 bag
    pub path: Option<PathBuf>,
    /// Take the packets from this file, with times of the clock of the path: CSV (t_s,node,rssi_dbm or t_s,node), the capture of a
    /// sniffer (pcap, pcapng; or a folder of captures), or a ROS 2 bag
    pub packets: Option<PathBuf>,
    /// How packets are written: KEY=NAME,.. where NAME is the column of a CSV file, or the field of a bag's messages
    /// (`radio.src`, or `beacons[].address` for each value of a list). KEY is node, rssi_dbm, snr_db, sector, range_m, receiver, t_s
    /// (or t_ms, t_us, t_ns), in CSV files also robot, stop, received and sent
    pub packet_fields: Option<FieldNames>,
    /// How ranges are written: KEY=NAME,.. where NAME is the column of `ranges.csv`, or the field of a bag's messages. KEY is node,
    /// range_m (or range_cm, range_mm, range_ft, range_ns), t_s (or t_ms, t_us, t_ns), in `ranges.csv` also stop and robot
    pub range_fields: Option<FieldNames>,
    /// The columns of a CSV file with a path or stops, if they have other names: KEY=NAME,.. where KEY is t_s (or t_ms, t_us,
    /// t_ns), x_m, y_m, z_m, lat, lon, alt_m, robot, stop or sent. In a file without a header NAME is the number of the
    /// column: x_m=#1
    pub path_fields: Option<FieldNames>,
    /// One file a stop, with the place of the stop in its name: {x}_{y}.csv for example
    pub stop_files: Option<FileTemplate>,
    /// The zone of dates in CSV files that do not say theirs: UTC, or the offset from it as +02:00
    pub time_zone: Option<TimeZone>,
    /// In a table with a row a stop and a column a node: what a cell holds if the node was not heard, 100 or -100,-200 for
    /// example. Then empty cells mean that nothing is known; the default is `empty`
    pub missing: Vec<Missing>,
    /// In such a table: the columns that are nodes, by name or as AP*. The default is all that are not places or times, and that have
    /// no name of something else (floor, battery, temperature_c)
    pub node_columns: Vec<ColumnPattern>,
    /// Map fixed receivers that heard a moving transmitter: the path or the stops are those of the transmitter, and the nodes
    /// are the receivers, because the loss of a link is the same both ways. In packets the column `receiver` names them, in
    /// receptions.csv `stop`, and in captures the name of each file
    pub reciprocal: bool,
    /// Use the packets of this transmitter only
    pub transmitter: Option<String>,
    /// Signal strengths up to this one are those of noise, and count as not heard: for receivers that always report a power.
    /// -100+6 is 6 dB above a noise of -100 dBm
    pub noise_floor: Option<NoiseFloor>,
    /// The RSSI is that of LoRa, which holds the noise too: the strength of the signal is computed from RSSI and SNR
    pub lora: bool,
}
