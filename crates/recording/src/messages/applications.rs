//! The messages of applications.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// An application, where its phase begins.
#[derive(Clone, PartialEq, prost::Message)]
pub struct ApplicationMessage {
    /// Its name.
    #[prost(string, tag = "1")]
    pub name: String,
    /// Its algorithm: `detarsk`, `p-g`, `level-set` or `gradient`.
    #[prost(string, tag = "2")]
    pub algorithm: String,
    /// Name of its map.
    #[prost(string, tag = "3")]
    pub map: String,
    /// Names of its robots.
    #[prost(string, repeated, tag = "4")]
    pub robots: Vec<String>,
    /// Name of the field whose source it seeks; empty if it searches targets.
    #[prost(string, tag = "5")]
    pub field: String,
    /// The level of the field that it seeks, in the unit of the field.
    #[prost(double, optional, tag = "6")]
    pub level: Option<f64>,
}

/// What an application worked out about the world.
#[derive(Clone, PartialEq, prost::Message)]
pub struct EstimateMessage {
    /// When (ns of simulated time).
    #[prost(uint64, tag = "1")]
    pub time_ns: u64,
    /// Name of the robot, node or sink that worked it out.
    #[prost(string, tag = "2")]
    pub station: String,
    /// `own_place`, `target_place` or `field_value`.
    #[prost(string, tag = "3")]
    pub what: String,
    /// Name of the target or of the field; empty for the own place.
    #[prost(string, tag = "4")]
    pub name: String,
    /// A place in the frame of the map, x (m).
    #[prost(double, optional, tag = "5")]
    pub x_m: Option<f64>,
    /// A place in the frame of the map, y (m).
    #[prost(double, optional, tag = "6")]
    pub y_m: Option<f64>,
    /// A place in the frame of the map, z (m).
    #[prost(double, optional, tag = "7")]
    pub z_m: Option<f64>,
    /// The value of a field, in its unit.
    #[prost(double, optional, tag = "8")]
    pub value: Option<f64>,
    /// The difference from the truth: the distance of a place in the world from the true one (m), or the value less the
    /// true value.
    #[prost(double, optional, tag = "9")]
    pub error: Option<f64>,
    /// The place in the world that the place on the map stands for, east (m).
    #[prost(double, optional, tag = "10")]
    pub world_x_m: Option<f64>,
    /// The place in the world that the place on the map stands for, north (m).
    #[prost(double, optional, tag = "11")]
    pub world_y_m: Option<f64>,
    /// The place in the world that the place on the map stands for, up (m).
    #[prost(double, optional, tag = "12")]
    pub world_z_m: Option<f64>,
}

/// A robot captured a target.
#[derive(Clone, PartialEq, prost::Message)]
pub struct CaptureMessage {
    /// When (ns of simulated time).
    #[prost(uint64, tag = "1")]
    pub time_ns: u64,
    /// Name of the robot.
    #[prost(string, tag = "2")]
    pub robot: String,
    /// Name of the target.
    #[prost(string, tag = "3")]
    pub target: String,
    /// Where the target was, east (m).
    #[prost(double, tag = "4")]
    pub x_m: f64,
    /// Where the target was, north (m).
    #[prost(double, tag = "5")]
    pub y_m: f64,
    /// Where the target was, up (m).
    #[prost(double, tag = "6")]
    pub z_m: f64,
}

recorded! {
    "sextant_applications.proto";
    ApplicationMessage = "Application": [
        "name" = 1 String, "algorithm" = 2 String, "map" = 3 String, "robots" = 4 Strings, "field" = 5 String,
        "level" = 6 OptionalDouble,
    ];
    EstimateMessage = "Estimate": [
        "time_ns" = 1 Uint64, "station" = 2 String, "what" = 3 String, "name" = 4 String, "x_m" = 5 OptionalDouble,
        "y_m" = 6 OptionalDouble, "z_m" = 7 OptionalDouble, "value" = 8 OptionalDouble, "error" = 9 OptionalDouble,
        "world_x_m" = 10 OptionalDouble, "world_y_m" = 11 OptionalDouble, "world_z_m" = 12 OptionalDouble,
    ];
    CaptureMessage = "Capture": [
        "time_ns" = 1 Uint64, "robot" = 2 String, "target" = 3 String, "x_m" = 4 Double, "y_m" = 5 Double,
        "z_m" = 6 Double,
    ];
}
