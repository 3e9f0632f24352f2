//! The message of the parents that a node chose one after the other.

use foxglove::{Encode, Schema};
use prost::bytes::BufMut;

use super::descriptor::{self, Declaration};

/// A node has its first parent in the tree, or another one.
#[derive(Clone, PartialEq, prost::Message)]
pub struct ParentChangeMessage {
    /// When (ns of simulated time).
    #[prost(uint64, tag = "1")]
    pub time_ns: u64,
    /// Index of the node.
    #[prost(uint32, tag = "2")]
    pub node: u32,
    /// Name of the parent before, a node or a sink; empty if it had none.
    #[prost(string, tag = "3")]
    pub old_parent: String,
    /// Name of the parent from now on; empty if it has lost its way.
    #[prost(string, tag = "4")]
    pub new_parent: String,
    /// Expected transmissions of a packet to the new parent; absent if they are not known.
    #[prost(double, optional, tag = "5")]
    pub etx: Option<f64>,
    /// Index of the new parent among the stations, nodes first and then sinks; absent without one.
    #[prost(uint32, optional, tag = "6")]
    pub parent_station: Option<u32>,
}

recorded! {
    "sextant_parents.proto";
    ParentChangeMessage = "ParentChange": [
        "time_ns" = 1 Uint64, "node" = 2 Uint32, "old_parent" = 3 String, "new_parent" = 4 String,
        "etx" = 5 OptionalDouble, "parent_station" = 6 OptionalUint32,
    ];
}
