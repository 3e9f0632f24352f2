//! The message of batteries.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// The battery of a node at the end.
#[derive(Clone, PartialEq, prost::Message)]
pub struct BatteryMessage {
    /// Index of the node.
    #[prost(uint32, tag = "1")]
    pub node: u32,
    /// Capacity (J).
    #[prost(double, tag = "2")]
    pub capacity_j: f64,
    /// What is left (J).
    #[prost(double, tag = "3")]
    pub left_j: f64,
    /// Mean power of radios and load since the warm-up, as long as the node lived (W).
    #[prost(double, tag = "4")]
    pub mean_power_w: f64,
    /// How long it lasts from full with this power, or how long it lasted (d); absent without a load.
    #[prost(double, optional, tag = "5")]
    pub lifetime_d: Option<f64>,
    /// When it was empty (ns); absent if it was not.
    #[prost(uint64, optional, tag = "6")]
    pub depleted_ns: Option<u64>,
}

recorded! {
    "sextant_battery.proto";
    BatteryMessage = "Battery": [
        "node" = 1 Uint32, "capacity_j" = 2 Double, "left_j" = 3 Double, "mean_power_w" = 4 Double,
        "lifetime_d" = 5 OptionalDouble, "depleted_ns" = 6 OptionalUint64,
    ];
}
