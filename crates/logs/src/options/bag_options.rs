//! What the user says of a bag.

/// Which topics of a ROS bag to read, and how.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BagOptions {
    /// Take the path of the robot from this topic: nav_msgs/Odometry, geometry_msgs/PoseStamped or
    /// PoseWithCovarianceStamped, transforms (tf2_msgs/TFMessage, /tf for example) or satellite fixes (sensor_msgs/NavSatFix).
    /// The default is the only topic with such poses; without any, the only one with transforms or fixes
    pub pose_topic: Option<String>,
    /// With transforms: the frame of the robot or of its antenna. The default is base_link or base_footprint
    pub child_frame: Option<String>,
    /// With transforms: the frame of the map. The default is the frame above all others, map or odom for example
    pub fixed_frame: Option<String>,
    /// Take the received packets from this topic, one in each message or in each value of a list in it. The default is the
    /// only topic whose messages have an obvious node and RSSI (node and rssi, or address and rssi for example)
    pub packet_topic: Option<String>,
    /// Take measured ranges from this topic. The default is the only one with the fields that `range_fields` names
    pub range_topic: Option<String>,
    /// The clock of poses and packets: the stamps in the messages, or the times of recording. The default is the stamps if
    /// both have them
    pub bag_clock: Option<BagClock>,
}

/// The clock of poses and packets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BagClock {
    /// The stamps in the headers of the messages.
    Stamp,
    /// When the messages were recorded.
    Log,
}
