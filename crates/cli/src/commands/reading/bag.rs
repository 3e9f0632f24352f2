//! Flags: what the user says of a bag.

use clap::{Args, ValueEnum};
use sextant_logs::{BagClock, BagOptions};

/// Which topics of a ROS bag to read, and how.
#[derive(Clone, Debug, Default, PartialEq, Args)]
#[command(next_help_heading = "Options for ROS bags")]
pub(crate) struct BagFlags {
    /// Take the path of the robot from this topic: nav_msgs/Odometry, geometry_msgs/PoseStamped or
    /// PoseWithCovarianceStamped, transforms (tf2_msgs/TFMessage, /tf for example) or satellite fixes (sensor_msgs/NavSatFix).
    /// The default is the only topic with such poses; without any, the only one with transforms or fixes
    #[arg(long, value_name = "TOPIC")]
    pub(crate) pose_topic: Option<String>,
    /// With transforms: the frame of the robot or of its antenna. The default is base_link or base_footprint
    #[arg(long, value_name = "FRAME")]
    pub(crate) child_frame: Option<String>,
    /// With transforms: the frame of the map. The default is the frame above all others, map or odom for example
    #[arg(long, value_name = "FRAME")]
    pub(crate) fixed_frame: Option<String>,
    /// Take the received packets from this topic, one in each message or in each value of a list in it. The default is the
    /// only topic whose messages have an obvious node and RSSI (node and rssi, or address and rssi for example)
    #[arg(long, value_name = "TOPIC")]
    pub(crate) packet_topic: Option<String>,
    /// Take measured ranges from this topic. The default is the only one with the fields that --range-fields names
    #[arg(long, value_name = "TOPIC")]
    pub(crate) range_topic: Option<String>,
    /// The clock of poses and packets: the stamps in the messages, or the times of recording. The default is the stamps if
    /// both have them
    #[arg(long, value_enum, value_name = "CLOCK")]
    pub(crate) bag_clock: Option<Clock>,
}

impl From<BagFlags> for BagOptions {
    fn from(flags: BagFlags) -> Self {
        let BagFlags { pose_topic, child_frame, fixed_frame, packet_topic, range_topic, bag_clock } = flags;
        Self {
            pose_topic,
            child_frame,
            fixed_frame,
            packet_topic,
            range_topic,
            bag_clock: bag_clock.map(BagClock::from),
        }
    }
}

/// The clock of poses and packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Clock {
    /// The stamps in the headers of the messages.
    Stamp,
    /// When the messages were recorded.
    Log,
}

impl From<Clock> for BagClock {
    fn from(clock: Clock) -> Self {
        match clock {
            Clock::Stamp => Self::Stamp,
            Clock::Log => Self::Log,
        }
    }
}
