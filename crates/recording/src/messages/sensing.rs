//! The messages of sensors.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// The sensors that all nodes have. What is absent they do not have.
#[derive(Clone, PartialEq, prost::Message)]
pub struct SensorsMessage {
    /// Radius within which targets are detected (m).
    #[prost(double, optional, tag = "1")]
    pub target_radius_m: Option<f64>,
    /// Time between two samples of the fields (s).
    #[prost(double, optional, tag = "2")]
    pub field_interval_s: Option<f64>,
    /// Ratio of signal to the constant offsets of the sensors (dB).
    #[prost(double, optional, tag = "3")]
    pub field_offset_snr_db: Option<f64>,
    /// Ratio of signal to the noise of each sample (dB).
    #[prost(double, optional, tag = "4")]
    pub field_noise_snr_db: Option<f64>,
}

/// What a sensor of a node said.
#[derive(Clone, PartialEq, prost::Message)]
pub(crate) struct SensedMessage {
    /// When (ns of simulated time).
    #[prost(uint64, tag = "1")]
    pub(crate) time_ns: u64,
    /// Index of the node.
    #[prost(uint32, tag = "2")]
    pub(crate) node: u32,
    /// `entered` or `left` of a target, `sampled` of a field.
    #[prost(string, tag = "3")]
    pub(crate) what: String,
    /// Name of the target or of the field.
    #[prost(string, tag = "4")]
    pub(crate) name: String,
    /// The sample, in the unit of the field.
    #[prost(double, optional, tag = "5")]
    pub(crate) value: Option<f64>,
}

recorded! {
    "sextant_sensing.proto";
    SensorsMessage = "Sensors": [
        "target_radius_m" = 1 OptionalDouble, "field_interval_s" = 2 OptionalDouble,
        "field_offset_snr_db" = 3 OptionalDouble, "field_noise_snr_db" = 4 OptionalDouble,
    ];
    SensedMessage = "Sensed": [
        "time_ns" = 1 Uint64, "node" = 2 Uint32, "what" = 3 String, "name" = 4 String, "value" = 5 OptionalDouble,
    ];
}
