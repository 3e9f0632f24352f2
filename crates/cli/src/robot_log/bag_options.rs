//! What the user says of a bag.

use std::fmt;
use std::str::FromStr;

use clap::{Args, ValueEnum};

use super::field_path::FieldPath;

/// Which topics of a ROS bag to read, and how.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Options for ROS bags")]
pub struct BagOptions {
    /// Take the path of the robot from this topic: nav_msgs/Odometry, geometry_msgs/PoseStamped or
    /// PoseWithCovarianceStamped, transforms (tf2_msgs/TFMessage, /tf for example) or satellite fixes (sensor_msgs/NavSatFix).
    /// The default is the only topic with such poses; without any, the only one with transforms or fixes
    #[arg(long, value_name = "TOPIC")]
    pub pose_topic: Option<String>,
    /// With transforms: the frame of the robot or of its antenna. The default is base_link or base_footprint
    #[arg(long, value_name = "FRAME")]
    pub child_frame: Option<String>,
    /// With transforms: the frame of the map. The default is the frame above all others, map or odom for example
    #[arg(long, value_name = "FRAME")]
    pub fixed_frame: Option<String>,
    /// Take the received packets from this topic, one in each message or in each value of a list in it. The default is the
    /// only topic whose messages have an obvious node and RSSI (node and rssi, or address and rssi for example)
    #[arg(long, value_name = "TOPIC")]
    pub packet_topic: Option<String>,
    /// The fields of the packets' messages: node=PATH,rssi_dbm=PATH,sector=PATH,t_s=PATH, of which only node is needed. PATH
    /// is a name or names joined by points, `radio.src` for example, or `beacons[].address` for each value of a list
    #[arg(long, value_name = "FIELDS")]
    pub packet_fields: Option<PacketFields>,
    /// The clock of poses and packets: the stamps in the messages, or the times of recording. The default is the stamps if
    /// both have them
    #[arg(long, value_enum, value_name = "CLOCK")]
    pub bag_clock: Option<BagClock>,
}

impl BagOptions {
    /// The flags that are given.
    #[must_use]
    pub fn given(&self) -> Vec<&'static str> {
        let Self { pose_topic, child_frame, fixed_frame, packet_topic, packet_fields, bag_clock } = self;
        let flags = [
            ("--pose-topic", pose_topic.is_some()),
            ("--child-frame", child_frame.is_some()),
            ("--fixed-frame", fixed_frame.is_some()),
            ("--packet-topic", packet_topic.is_some()),
            ("--packet-fields", packet_fields.is_some()),
            ("--bag-clock", bag_clock.is_some()),
        ];
        flags.into_iter().filter_map(|(flag, is_given)| is_given.then_some(flag)).collect()
    }
}

/// The clock of poses and packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BagClock {
    /// The stamps in the headers of the messages.
    Stamp,
    /// When the messages were recorded.
    Log,
}

/// The fields of the messages of packets.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PacketFields {
    pub(super) node: FieldPath,
    pub(super) rssi_dbm: Option<FieldPath>,
    pub(super) sector: Option<FieldPath>,
    pub(super) time: Option<FieldPath>,
}

impl FromStr for PacketFields {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let [mut node, mut rssi_dbm, mut sector, mut time] = [None, None, None, None];
        for part in text.split(',') {
            let (key, path) = part.split_once('=').ok_or_else(|| {
                format!("found `{part}`; allowed: node=PATH[,rssi_dbm=PATH][,sector=PATH][,t_s=PATH]")
            })?;
            let place = match key.trim() {
                "node" => &mut node,
                "rssi_dbm" => &mut rssi_dbm,
                "sector" => &mut sector,
                "t_s" => &mut time,
                other => return Err(format!("unknown key `{other}`; allowed: node, rssi_dbm, sector, t_s")),
            };
            if place.replace(FieldPath::parse(path.trim())?).is_some() {
                return Err(format!("`{key}` is given twice"));
            }
        }
        let node = node.ok_or("`node` is missing; it is required")?;
        Ok(Self { node, rssi_dbm, sector, time })
    }
}

impl fmt::Display for PacketFields {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "node={}", self.node)?;
        for (key, path) in [("rssi_dbm", &self.rssi_dbm), ("sector", &self.sector), ("t_s", &self.time)] {
            if let Some(path) = path {
                write!(f, ",{key}={path}")?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fields_of_packets_are_written_as_they_are_read() {
        let text = "node=beacons[].id,rssi_dbm=beacons[].rssi,sector=antenna,t_s=header.stamp";
        assert_eq!(text.parse::<PacketFields>().unwrap().to_string(), text);
        for (text, problem) in [
            ("rssi_dbm=rssi", "`node` is missing"),
            ("node=a,node=b", "`node` is given twice"),
            ("node=a,rssi=b", "unknown key `rssi`"),
            ("src", "found `src`; allowed: node=PATH"),
            ("node=a..b", "`a..b` is not the path of a field"),
        ] {
            let found = text.parse::<PacketFields>().unwrap_err();
            assert!(found.starts_with(problem), "{found}");
        }
    }
}
