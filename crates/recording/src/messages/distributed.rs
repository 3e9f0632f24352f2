//! The messages of maps that are computed in the nodes.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// What a node has found when it computed its own place, and what that took.
#[derive(Clone, PartialEq, prost::Message)]
pub struct MappedNodeMessage {
    /// Index of the node.
    #[prost(uint32, tag = "1")]
    pub node: u32,
    /// `initial_anchor`, `new_anchor`, `node`, or `former_anchor` for one that gave up its place.
    #[prost(string, tag = "2")]
    pub role: String,
    /// The iteration in which it became an anchor.
    #[prost(uint32, optional, tag = "3")]
    pub anchor_since: Option<u32>,
    /// `new_anchor`, `good` or `bad`; empty for an initial anchor.
    #[prost(string, tag = "4")]
    pub category: String,
    /// Where it believes to be: east (m). Absent if it could not be placed.
    #[prost(double, optional, tag = "5")]
    pub x_m: Option<f64>,
    /// North (m).
    #[prost(double, optional, tag = "6")]
    pub y_m: Option<f64>,
    /// Up (m).
    #[prost(double, optional, tag = "7")]
    pub z_m: Option<f64>,
    /// Covariance of the place (m²), if it has one.
    #[prost(double, optional, tag = "8")]
    pub cov_xx_m2: Option<f64>,
    /// Covariance of x and y (m²).
    #[prost(double, optional, tag = "9")]
    pub cov_xy_m2: Option<f64>,
    /// Covariance of x and z (m²).
    #[prost(double, optional, tag = "10")]
    pub cov_xz_m2: Option<f64>,
    /// Variance of y (m²).
    #[prost(double, optional, tag = "11")]
    pub cov_yy_m2: Option<f64>,
    /// Covariance of y and z (m²).
    #[prost(double, optional, tag = "12")]
    pub cov_yz_m2: Option<f64>,
    /// Variance of z (m²).
    #[prost(double, optional, tag = "13")]
    pub cov_zz_m2: Option<f64>,
    /// Natural logarithm of the highest likelihood on its grid.
    #[prost(double, optional, tag = "14")]
    pub log_likelihood: Option<f64>,
    /// Number of vertices with that likelihood; 0 if it computed no place.
    #[prost(uint32, tag = "15")]
    pub ties: u32,
    /// Conditions that its place breaks: ranges and sectors of anchors that it heard.
    #[prost(uint32, tag = "16")]
    pub violations: u32,
    /// Neighbours with coordinates.
    #[prost(uint32, tag = "17")]
    pub neighbours: u32,
    /// Those beyond the radius of communication, by the coordinates.
    #[prost(uint32, tag = "18")]
    pub scattered: u32,
    /// Anchors heard that stand still.
    #[prost(uint32, tag = "19")]
    pub anchors_heard: u32,
    /// Stops at which a mobile anchor was heard.
    #[prost(uint32, tag = "20")]
    pub mobile_stops_heard: u32,
    /// The last iteration in which its place or its role changed.
    #[prost(uint32, tag = "21")]
    pub last_change: u32,
    /// PLACE messages that it sent at least once.
    #[prost(uint64, tag = "22")]
    pub place_messages: u64,
    /// REPORT messages.
    #[prost(uint64, tag = "23")]
    pub report_messages: u64,
    /// BEACON messages.
    #[prost(uint64, tag = "24")]
    pub beacon_messages: u64,
    /// COORDINATES messages.
    #[prost(uint64, tag = "25")]
    pub coordinates_messages: u64,
    /// Octets of all of them.
    #[prost(uint64, tag = "26")]
    pub octets: u64,
    /// Frames with messages that were sent, repeats included.
    #[prost(uint64, tag = "27")]
    pub sent: u64,
    /// Those that the link did not take, or gave up because the channel was busy.
    #[prost(uint64, tag = "28")]
    pub unsent: u64,
    /// Frames received, one for each sector heard.
    #[prost(uint64, tag = "29")]
    pub frames_received: u64,
    /// Frames received that are no such message.
    #[prost(uint64, tag = "30")]
    pub frames_unread: u64,
    /// Grid vertices whose likelihood was computed.
    #[prost(uint64, tag = "31")]
    pub vertices: u64,
    /// Memory of the largest grid (octets).
    #[prost(uint64, tag = "32")]
    pub grid_octets: u64,
    /// Memory of the tables of neighbours at the end (octets).
    #[prost(uint64, tag = "33")]
    pub table_octets: u64,
    /// Energy of its radio in the network of the map (J).
    #[prost(double, tag = "34")]
    pub energy_j: f64,
    /// Azimuth of its sector 0, as the anchor worked it out (rad).
    #[prost(double, optional, tag = "35")]
    pub azimuth_rad: Option<f64>,
    /// How far that may be off (rad).
    #[prost(double, optional, tag = "36")]
    pub azimuth_half_width_rad: Option<f64>,
    /// Elevation of all its sectors (rad).
    #[prost(double, optional, tag = "37")]
    pub elevation_rad: Option<f64>,
    /// Anchors from whose reports it worked them out.
    #[prost(uint32, optional, tag = "38")]
    pub bearings: Option<u32>,
}

recorded! {
    "sextant_distributed.proto";
    MappedNodeMessage = "MappedNode": [
        "node" = 1 Uint32, "role" = 2 String, "anchor_since" = 3 OptionalUint32, "category" = 4 String,
        "x_m" = 5 OptionalDouble, "y_m" = 6 OptionalDouble, "z_m" = 7 OptionalDouble,
        "cov_xx_m2" = 8 OptionalDouble, "cov_xy_m2" = 9 OptionalDouble, "cov_xz_m2" = 10 OptionalDouble,
        "cov_yy_m2" = 11 OptionalDouble, "cov_yz_m2" = 12 OptionalDouble, "cov_zz_m2" = 13 OptionalDouble,
        "log_likelihood" = 14 OptionalDouble, "ties" = 15 Uint32, "violations" = 16 Uint32,
        "neighbours" = 17 Uint32, "scattered" = 18 Uint32, "anchors_heard" = 19 Uint32,
        "mobile_stops_heard" = 20 Uint32, "last_change" = 21 Uint32, "place_messages" = 22 Uint64,
        "report_messages" = 23 Uint64, "beacon_messages" = 24 Uint64, "coordinates_messages" = 25 Uint64,
        "octets" = 26 Uint64, "sent" = 27 Uint64, "unsent" = 28 Uint64, "frames_received" = 29 Uint64,
        "frames_unread" = 30 Uint64, "vertices" = 31 Uint64, "grid_octets" = 32 Uint64, "table_octets" = 33 Uint64,
        "energy_j" = 34 Double, "azimuth_rad" = 35 OptionalDouble, "azimuth_half_width_rad" = 36 OptionalDouble,
        "elevation_rad" = 37 OptionalDouble, "bearings" = 38 OptionalUint32,
    ];
}
