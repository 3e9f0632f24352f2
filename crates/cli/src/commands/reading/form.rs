//! Flags: what the user says of the form of a log.

use std::path::PathBuf;

use clap::Args;
use sextant_logs::{ColumnPattern, FieldNames, FileTemplate, FormOptions, Missing, NoiseFloor, TimeZone};

/// Where the parts of a log are, and how they are written.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Options for the forms of logs")]
pub(crate) struct FormFlags {
    /// Take the path of the robot from this file, with times of the clock of the packets. It is CSV (t_s,x_m,y_m or
    /// x_m,y_m,z_m or t_s,lat,lon), TUM (time x y z and a quaternion a line), GPX, NMEA 0183, or a ROS 2 bag
    #[arg(long, value_name = "FILE")]
    pub(crate) path: Option<PathBuf>,
    /// Take the packets from this file, with times of the clock of the path. It is CSV (t_s,node,rssi_dbm or
    /// t_s,node), the capture of a sniffer (pcap, pcapng; or a folder of captures), or a ROS 2 bag
    #[arg(long, value_name = "FILE")]
    pub(crate) packets: Option<PathBuf>,
    /// How packets are written: KEY=NAME,.. where NAME is the column of a CSV file, or the field of a bag's messages
    /// (`radio.src`, or `beacons[].address` for each value of a list). KEY is node, rssi_dbm, snr_db, sector, range_m, receiver, t_s
    /// (or t_ms, t_us, t_ns), in CSV files also robot, stop, received and sent. In a file without a header NAME is the
    /// number of the column: node=#1,rssi_dbm=#2
    #[arg(long, value_name = "FIELDS", value_parser = FieldNames::parse_packets)]
    pub(crate) packet_fields: Option<FieldNames>,
    /// The columns of a CSV file with a path or stops, if they have other names: KEY=NAME,.. where KEY is t_s (or t_ms, t_us,
    /// t_ns), x_m, y_m, z_m, lat, lon, alt_m, robot, stop or sent. In a file without a header NAME is the number of the column:
    /// x_m=#1,y_m=#2
    #[arg(long, value_name = "FIELDS", value_parser = FieldNames::parse_places)]
    pub(crate) path_fields: Option<FieldNames>,
    /// How ranges are written: KEY=NAME,.. where NAME is the column of `ranges.csv`, or the field of a bag's messages. KEY is
    /// node, range_m (or range_cm, range_mm, range_ft, range_ns), t_s (or t_ms, t_us, t_ns), in `ranges.csv` also stop and robot
    #[arg(long, value_name = "FIELDS", value_parser = FieldNames::parse_ranges)]
    pub(crate) range_fields: Option<FieldNames>,
    /// LOG is a folder with a file for each stop, and the names of the files say where it is: {x}_{y}.csv. Fields are x, y, z
    /// (metres), lat, lon (degrees), stop and robot, {x:2} has two characters, and * is any text. With {stop} alone, places
    /// are in stops.csv. A file has rows of packets (node,rssi_dbm) or scans with a column a node
    #[arg(long, value_name = "NAMES")]
    pub(crate) stop_files: Option<FileTemplate>,
    /// The zone of dates in CSV files that do not say theirs: UTC, or how far it is ahead, as +02:00 or -05:00. Names of zones
    /// are not known, because most change their offset twice a year
    #[arg(long, value_name = "UTC|+HH:MM", allow_hyphen_values = true)]
    pub(crate) time_zone: Option<TimeZone>,
    /// In a table with a row a stop and a column a node: what a cell holds if the node was not heard, 100 or -100,-200 for
    /// example. Then empty cells mean that nothing is known; the default is `empty`
    #[arg(long, value_name = "VALUES", value_delimiter = ',', allow_hyphen_values = true)]
    pub(crate) missing: Vec<Missing>,
    /// In such a table: the columns that are nodes, by name or as AP*. The default is all that are not places or
    /// times, and that have no name of something else (floor, battery, temperature_c)
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    pub(crate) node_columns: Vec<ColumnPattern>,
    /// Map fixed receivers that heard a moving transmitter. The path or the stops are those of the transmitter, and
    /// the nodes are the receivers, because the loss of a link is the same both ways. In packets the column
    /// `receiver` names them, in
    /// receptions.csv `stop`, and in captures the name of each file
    #[arg(long)]
    pub(crate) reciprocal: bool,
    /// Use the packets of this transmitter only
    #[arg(long, value_name = "NAME", requires = "reciprocal")]
    pub(crate) transmitter: Option<String>,
    /// Signal strengths up to this one are those of noise, and count as not heard: for receivers that always report a power.
    /// -100+6 is 6 dB above a noise of -100 dBm
    #[arg(long, value_name = "DBM[+DB]", allow_hyphen_values = true)]
    pub(crate) noise_floor: Option<NoiseFloor>,
    /// The RSSI is that of LoRa, which holds the noise too: the strength of the signal is computed from RSSI and SNR
    #[arg(long)]
    pub(crate) lora: bool,
}

impl From<FormFlags> for FormOptions {
    fn from(flags: FormFlags) -> Self {
        Self {
            path: flags.path,
            packets: flags.packets,
            packet_fields: flags.packet_fields,
            path_fields: flags.path_fields,
            range_fields: flags.range_fields,
            stop_files: flags.stop_files,
            time_zone: flags.time_zone,
            missing: flags.missing,
            node_columns: flags.node_columns,
            reciprocal: flags.reciprocal,
            transmitter: flags.transmitter,
            noise_floor: flags.noise_floor,
            lora: flags.lora,
        }
    }
}
